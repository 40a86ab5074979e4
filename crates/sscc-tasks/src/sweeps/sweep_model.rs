//! Sweeps of all modes of a model, and the poses at their hits.

use std::path::{Path, PathBuf};

use sscc::{Certificates, ModeRange, Pair, Progress, Query, ReducedModel};
use sscc_io::gltf::PlacedMesh;
use sscc_io::{IoError, LoadedModel, Setting, write_ply_pose};

use super::interval_row::IntervalRow;
use super::sweep_range::SweepRange;
use super::sweep_row::SweepRow;
use crate::error::{At, Result};
use crate::{make_folder, read_configuration};

/// Options of [`sweep_model`], [`sweep_model_intervals`] and
/// [`sweep_model_combinations`](super::sweep_model_combinations).
#[derive(Clone, Debug, Default)]
pub struct SweepRequest {
    /// The weights at which the sweeps begin (`--q`). None means the centre of the certificates.
    pub q: Option<String>,
    /// The range of all weights (`--range`), two numbers. None means [`SweepRange::of_model`].
    pub range: Option<String>,
    /// The folder for the poses at the hits (`--pose`); only [`sweep_model`] writes them.
    pub pose: Option<PathBuf>,
    /// Number of threads. None means all cores.
    pub threads: Option<usize>,
}

impl SweepRequest {
    /// Returns the range of the weights: that of `--range`, else the default of the model.
    ///
    /// # Errors
    /// When the range is not two numbers with a finite difference, in ascending order.
    pub fn ranges(&self, loaded: &LoadedModel) -> Result<SweepRange> {
        self.range.as_deref().map_or_else(|| Ok(SweepRange::of_model(loaded)), SweepRange::parse)
    }

    /// Returns the weights at the start and the range of each mode, and creates the folder for poses. It reports all errors
    /// that can be found before long work.
    ///
    /// # Errors
    /// When the q or the range does not fit the model, or the folder cannot be written to.
    pub fn prepare(&self, loaded: &LoadedModel, center: &[f64]) -> Result<(Vec<f64>, Vec<[f64; 2]>)> {
        let q = self
            .q
            .as_deref()
            .map_or_else(|| Ok(center.to_vec()), |typed| read_configuration(Setting::Q, typed, loaded))?;
        let ranges = self.ranges(loaded)?.ends(&loaded.model, &q);
        self.pose.as_deref().map_or(Ok(()), make_folder)?;
        Ok((q, ranges))
    }

    /// Returns the result of [`Self::prepare`] with the numbers of the modes.
    pub(super) fn ways(
        &self,
        loaded: &LoadedModel,
        certificates: &Certificates,
    ) -> Result<(Vec<f64>, Vec<ModeRange>)> {
        let (q, ranges) = self.prepare(loaded, certificates.center())?;
        let ranges = ranges.into_iter().enumerate();
        Ok((q, ranges.map(|(mode, [low, high])| ModeRange { mode, low, high }).collect()))
    }
}

/// Sweeps every mode up and down from its weight at the start. If the request has a folder for poses, the shape at each
/// hit is written there with its pairs marked, after the last sweep.
///
/// # Errors
/// The errors of [`SweepRequest::prepare`]; also when the certificates are of another model, `progress` cancels, or a pose
/// cannot be written.
pub fn sweep_model(
    loaded: &LoadedModel,
    certificates: &Certificates,
    request: &SweepRequest,
    progress: &dyn Progress,
) -> Result<Vec<SweepRow>> {
    let (q, ranges) = request.ways(loaded, certificates)?;
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

/// Finds for every mode the intervals of its weight over which the shape collides, with this number of samples of each
/// weight.
///
/// # Errors
/// The errors of [`SweepRequest::prepare`]; also when the certificates are of another model, there are too few or too many
/// samples, or `progress` cancels.
pub fn sweep_model_intervals(
    loaded: &LoadedModel,
    certificates: &Certificates,
    request: &SweepRequest,
    samples: usize,
    progress: &dyn Progress,
) -> Result<Vec<IntervalRow>> {
    let (q, ranges) = request.ways(loaded, certificates)?;
    let query = Query::new(&loaded.model, certificates)?;
    let found = query.sweep_intervals(&q, &ranges, samples, request.threads, progress)?;
    Ok(found.into_iter().map(|found| IntervalRow::new(found, &loaded.mode_names)).collect())
}

/// Writes the shape at q, in the coordinates of the file, with the triangles of these pairs marked.
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
