//! The check that modes divided by a metric's factor stay in the range of numbers in which the proofs hold.

use glam::DVec3;

use super::metric::Metric;
use crate::{Error, Modes, TriMesh, limits};

/// Checks that the rounding bounds hold for modes in a metric.
///
/// # Errors
/// When the modes are for another number of vertices, the metric is of another rank, or the modes divided by its factor
/// leave the range in which the proofs hold.
pub fn check_metric(metric: &Metric, mesh: &TriMesh, modes: &Modes) -> Result<(), Error> {
    check_scaled_modes(mesh, modes, metric).map(|_| ())
}

/// Returns the largest magnitude of an entry of `A = U S^-1` over the used vertices. It is 0 (if no mode moves a used vertex)
/// or between [`limits::SMALLEST`] and [`limits::LARGEST`].
///
/// # Errors
/// When the modes are for another number of vertices, the metric has another rank, or the scaled modes are out of
/// range.
pub(crate) fn check_scaled_modes(mesh: &TriMesh, modes: &Modes, metric: &Metric) -> Result<f64, Error> {
    modes.check_mesh(mesh)?;
    if metric.rank() != modes.rank() {
        return Err(Error::MetricLength { found: metric.rank(), rank: modes.rank() });
    }
    let mut largest = 0.0_f64;
    let mut moves = false;
    let mut scaled = vec![DVec3::ZERO; modes.rank()];
    for i in mesh.used_vertices() {
        let of_vertex = modes.of_vertex(i);
        metric.scaled_modes(of_vertex, &mut scaled);
        for (u, a) in of_vertex.iter().zip(&scaled) {
            // Sums that overflow may be NaN.
            let reach = if a.is_nan() { f64::INFINITY } else { a.abs().max_element() };
            largest = largest.max(reach);
            moves |= *u != DVec3::ZERO;
        }
    }
    // Nonzero modes must not underflow when they are scaled: a radius would become infinite.
    if !moves || (limits::SMALLEST..=limits::LARGEST).contains(&largest) {
        Ok(largest)
    } else {
        Err(Error::MetricRange { largest })
    }
}
