//! Sweeps of all modes of a model, and the poses at their hits.

use std::path::{Path, PathBuf};

use sscc::{Certificates, Pair, Progress, Query, ReducedModel};
use sscc_io::gltf::PlacedMesh;
use sscc_io::{IoError, LoadedModel, write_ply_pose};

use super::sweep_row::SweepRow;
use crate::error::{At, Result};
use crate::{SimError, make_folder, read_configuration};

/// Options of [`sweep_model`].
#[derive(Clone, Debug, Default)]
pub struct SweepRequest {
    /// The weights at which the sweeps begin (`--q`); none: the centre of the certificates.
    pub q: Option<String>,
    /// The range of all weights (`--range`), two numbers; none: [`default_ranges`].
    pub range: Option<String>,
    /// The folder for the poses at the hits (`--pose`).
    pub pose: Option<PathBuf>,
    /// Number of threads; none: all cores.
    pub threads: Option<usize>,
}

impl SweepRequest {
    /// Returns the weights at the start and the range of each mode, and makes the folder for poses: all that can be
    /// refused before long work.
    ///
    /// # Errors
    /// When the q or the range is not one of the model, or the folder cannot be written to.
    pub fn prepare(&self, loaded: &LoadedModel, center: &[f64]) -> Result<(Vec<f64>, Vec<[f64; 2]>)> {
        let q = self
            .q
            .as_deref()
            .map_or_else(|| Ok(center.to_vec()), |typed| read_configuration("--q", typed, loaded))?;
        let ranges = match &self.range {
            Some(typed) => vec![range(typed)?; loaded.model.rank()],
            None => default_ranges(&loaded.model, &loaded.mode_names, &q),
        };
        self.pose.as_deref().map_or(Ok(()), make_folder)?;
        Ok((q, ranges))
    }
}

/// Returns the range of `--range`.
fn range(typed: &str) -> Result<[f64; 2]> {
    let refused = |cause: &str| Err(SimError::refused(format!("--range {typed}"), cause));
    let numbers: std::result::Result<Vec<f64>, _> =
        typed.split(',').map(|text| text.trim().parse()).collect();
    match numbers.as_deref() {
        Ok([low, high]) if !(high - low).is_finite() => refused("both ends must be finite"),
        Ok([low, high]) if low >= high => {
            refused("the range is empty: the first number must be the smaller one")
        }
        Ok([low, high]) => Ok([*low, *high]),
        _ => refused("two numbers were expected, as in --range=-1,1"),
    }
}

/// Returns the default range of each weight: 0 to 1 for morph targets, whose modes have names; else as far below and above
/// the weight in q as moves some vertex by half the diagonal of the AABB.
pub fn default_ranges(model: &ReducedModel, mode_names: &[String], q: &[f64]) -> Vec<[f64; 2]> {
    let range = |(k, q): (usize, &f64)| {
        let limit = model.weight_limit(k);
        if mode_names.is_empty() { [q - limit, q + limit] } else { [0.0, 1.0] }
    };
    q.iter().enumerate().map(range).collect()
}

/// Sweeps every mode up and down from its weight at the start, and writes the shape at each hit with its pairs marked. All
/// files are written after the last sweep.
///
/// # Errors
/// As [`SweepRequest::prepare`]; when the certificates are of another model, `progress` cancels, or a pose cannot be
/// written.
pub fn sweep_model(
    loaded: &LoadedModel,
    certificates: &Certificates,
    request: &SweepRequest,
    progress: &dyn Progress,
) -> Result<Vec<SweepRow>> {
    let (q, ranges) = request.prepare(loaded, certificates.center())?;
    let ranges: Vec<_> = ranges.into_iter().enumerate().collect();
    let query = Query::new(&loaded.model, certificates)?;
    let sweeps = query.sweep_modes(&q, &ranges, request.threads, progress)?;
    let rows: Vec<SweepRow> =
        sweeps.into_iter().map(|sweep| SweepRow::new(sweep, &loaded.mode_names)).collect();
    let Some(folder) = &request.pose else { return Ok(rows) };
    let placement = loaded.placement()?;
    for row in &rows {
        if let Some(hit) = row.first_hit {
            let mut q = q.clone();
            q[row.mode] = hit;
            let path = folder.join(row.file_name());
            write_pose(&path, &loaded.model, placement.as_ref(), &q, &row.pairs)?;
        }
    }
    Ok(rows)
}

/// Writes the shape at q, where the file puts it, with the triangles of these pairs marked.
fn write_pose(
    path: &Path,
    model: &ReducedModel,
    placement: Option<&PlacedMesh>,
    q: &[f64],
    pairs: &[Pair],
) -> Result<()> {
    let mut colliding = vec![false; model.mesh().faces().len()];
    pairs.iter().flat_map(|(i, j)| [*i, *j]).for_each(|t| colliding[t as usize] = true);
    let mut positions = model.positions(q).in_file(path)?;
    if let Some(placement) = placement {
        placement
            .place(0, &mut positions)
            .map_err(|error| IoError::Format { path: path.to_owned(), error })?;
    }
    Ok(write_ply_pose(path, model.mesh(), &positions, &colliding)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_two_numbers_in_order() {
        assert_eq!(range("-1, 2.5").unwrap(), [-1.0, 2.5]);
        let message = |typed: &str| range(typed).unwrap_err().to_string();
        let empty = "--range 1,1: the range is empty: the first number must be the smaller one";
        assert_eq!(message("1,1"), empty);
        assert!(message("1,0").contains("is empty"));
        for typed in ["", "1", "1,2,3", "a,b"] {
            assert!(message(typed).ends_with("two numbers were expected, as in --range=-1,1"), "{typed}");
        }
        for typed in ["nan,1", "0,inf", "-1e308,1e308"] {
            assert!(message(typed).ends_with("both ends must be finite"), "{typed}");
        }
    }
}
