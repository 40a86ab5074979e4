//! A metric in a container: `metric_scales` (r) for a diagonal factor, `metric_factor` (r x r) for a triangular one.

use sscc::{Metric, MetricKind};

use super::{Container, ContainerWriter};
use crate::error::quoted;
use crate::{FormatError, Place};

pub(super) const SCALES: &str = "metric_scales";
pub(super) const FACTOR: &str = "metric_factor";

/// Adds a metric, with the name of its kind as the text `metric`.
pub(super) fn write(writer: &mut ContainerWriter, metric: &Metric) {
    let rank = metric.rank();
    writer.text("metric", metric.kind().into());
    match metric.dense_factor() {
        Some(factor) => writer.f64(FACTOR, &[rank, rank], factor),
        None => writer.f64(SCALES, &[rank], &metric.scales()),
    };
}

/// Reads a metric for `rank` modes; [`ANY`](super::ANY) matches any number.
pub(super) fn read(file: &Container<'_>, rank: usize) -> Result<Metric, FormatError> {
    let name = file.text("metric")?;
    let kind = name.parse::<MetricKind>().map_err(|_| {
        FormatError::new(Place::Key("metric".into()), format!("unknown metric {}", quoted(name)))
    })?;
    if !file.names().iter().any(|name| name == FACTOR) {
        return Ok(Metric::from_scales(kind, file.f64(SCALES)?.shaped(&[rank])?.values)?);
    }
    let factor = file.f64(FACTOR)?.shaped(&[rank, rank])?;
    if file.names().iter().any(|name| name == SCALES) {
        return Err(factor.refused(format!("the file also has the tensor '{SCALES}'")));
    }
    Ok(Metric::from_factor(kind, factor.shape[0], factor.values)?)
}

#[cfg(test)]
mod tests {
    use super::super::{ANY, MODEL};
    use super::*;

    fn message(writer: ContainerWriter) -> String {
        let bytes = writer.finish().unwrap();
        read(&Container::parse(&bytes, MODEL).unwrap(), ANY).unwrap_err().to_string()
    }

    #[test]
    fn diagonal_and_dense_factors_round_trip() {
        let dense = Metric::from_factor(MetricKind::Energy, 2, vec![1.0, 0.5, 0.0, 3.0]).unwrap();
        for metric in [Metric::identity(3), dense] {
            let mut writer = ContainerWriter::new(MODEL);
            write(&mut writer, &metric);
            let bytes = writer.finish().unwrap();
            let file = Container::parse(&bytes, MODEL).unwrap();
            assert_eq!(read(&file, ANY).unwrap(), metric);
            assert_eq!(read(&file, metric.rank()).unwrap(), metric);
            assert!(read(&file, 7).is_err());
        }
    }

    #[test]
    fn invalid_factors_are_rejected() {
        let with = |shape: &[usize], values: &[f64]| {
            let mut writer = ContainerWriter::new(MODEL);
            writer.text("metric", "given").f64(FACTOR, shape, values);
            writer
        };
        assert!(message(with(&[2, 2], &[1.0, 0.0, 0.5, 1.0])).contains("not upper triangular"));
        assert!(message(with(&[2, 2], &[1.0, 0.0, 0.0, -1.0])).contains("not positive"));
        assert!(message(with(&[2, 2], &[1.0, f64::NAN, 0.0, 1.0])).contains("not finite"));
        assert!(message(with(&[0, 0], &[])).contains("no modes"));
        assert!(message(with(&[2, 3], &[1.0; 6])).contains("not square"));
        assert!(message(with(&[4], &[1.0; 4])).contains("was expected"));
        let mut both = with(&[1, 1], &[1.0]);
        both.f64(SCALES, &[1], &[1.0]);
        assert!(message(both).contains("also has the tensor 'metric_scales'"));
    }
}
