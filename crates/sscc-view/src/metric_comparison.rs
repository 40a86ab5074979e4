//! A plot of the root's certificate over the number of modes, for the energy and the displacement metric (paper, Figure
//! 9).

use sscc::{Certificates, CertifyOptions, Error, Metric, MetricKind, Modes, Progress, ReducedModel};

use crate::{Axis, Plot, Series};

/// Numbers of modes to compare, below the model's rank. The rank itself is added.
const RANKS: [usize; 6] = [1, 5, 10, 20, 40, 80];

/// Returns for each number of modes, and for both metrics, the largest deformation along the first mode that the root proves
/// free. A deformation is measured by the displacement of the vertex that moves farthest. `unit` is its unit on the axis; if
/// empty, the axis has no unit. The model's own metric must be the diagonal energy metric. Computes certificates of each of
/// these models.
///
/// # Errors
/// If `progress` cancels.
pub fn metric_comparison(model: &ReducedModel, unit: &str, progress: &dyn Progress) -> Result<Plot, Error> {
    let energy = model.metric();
    let rank = model.rank();
    let mut ranks: Vec<usize> = RANKS.into_iter().filter(|r| *r < rank).chain([rank]).collect();
    ranks.dedup();
    let all = model.modes().displacements();
    let farthest = all.iter().step_by(rank).map(|u| u.length()).fold(0.0, f64::max);
    let (mut by_energy, mut by_displacement) = (Vec::new(), Vec::new());
    for count in ranks {
        let modes = all.chunks_exact(rank).flat_map(|of_vertex| &of_vertex[..count]).copied().collect();
        let first = ReducedModel::new(model.mesh().clone(), Modes::new(count, modes)?)?;
        let root = |metric: Metric| -> Result<[f64; 2], Error> {
            let scale = metric.scales()[0];
            let options = CertifyOptions::default().metric(metric).budget(0).local_budget(0);
            let certificates = Certificates::compute(&first, &options, progress)?;
            Ok([count as f64, farthest * certificates.root_radius() / scale])
        };
        by_displacement.push(root(first.metric().clone())?);
        let scales = energy.scales()[..count].to_vec();
        by_energy.push(root(Metric::from_scales(MetricKind::Energy, scales)?)?);
    }
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    Ok(Plot {
        title: "Proven free along the first mode".into(),
        x: Axis::logarithmic("modes"),
        y: Axis::linear(format!("largest displacement{unit}")),
        series: vec![
            Series::new("energy metric", by_energy),
            Series::new("displacement metric", by_displacement),
        ],
    })
}
