//! `R_global`, the paper's largest radius of interest (section 5.2), and the farthest radius beyond it.
//!
//! The paper caps all radii at `R_global`. Bodies move farther than that, and radii beyond it are proofs like the others: their
//! bounds hold at any `|z|`. So the pair tree is built up to [`CertifyOptions::reach`](crate::CertifyOptions::reach) times
//! `R_global` while its budget lasts (docs/notes/pair-tree.md#reach).

use crate::geometry::Aabb;
use crate::model::rounding::to_f32_down;
use crate::{Certificates, Metric, ReducedModel};

/// Whether no radius is farther than [`CertifyOptions::reach`](crate::CertifyOptions::reach) allows. The model must be that
/// of the certificates.
pub fn is_within_reach(certificates: &Certificates, model: &ReducedModel, reach: f64) -> bool {
    let global_radius = global_radius(model, certificates.metric(), certificates.center());
    certificates.global_radius() <= farthest_radius(global_radius, reach)
}

/// Returns the `|z|` at which the first mode that moves any vertex has moved some vertex by half the diagonal of the
/// AABB at the centre; infinite if no mode moves a vertex, or the diagonal is 0. Only vertices of faces count.
///
/// It is rounded down to single precision, if it is in that range, so that the pair tree can store every radius up to it.
pub(super) fn global_radius(model: &ReducedModel, metric: &Metric, center: &[f64]) -> f64 {
    let used = model.mesh().used_vertices();
    let Aabb { lower, upper } = Aabb::of_points(used.iter().map(|&v| model.position(v, center)));
    let half_diagonal = (upper - lower).length() / 2.0;
    for k in 0..metric.rank() {
        let scale = metric.mode_length(k);
        let lengths = used.iter().map(|&v| (model.modes().of_vertex(v)[k] / scale).length());
        let largest = lengths.fold(0.0, f64::max);
        if largest > 0.0 && half_diagonal > 0.0 {
            let radius = half_diagonal / largest;
            return if is_in_range(radius) { f64::from(to_f32_down(radius)) } else { radius };
        }
    }
    f64::INFINITY
}

/// Returns `reach` times the global radius, rounded down to single precision, so that the pair tree can store it; or the global
/// radius if that is out of the range of single precision.
pub(super) fn farthest_radius(global_radius: f64, reach: f64) -> f64 {
    if is_in_range(global_radius) {
        f64::from(to_f32_down(global_radius * reach)).max(global_radius)
    } else {
        global_radius
    }
}

/// Whether a radius is in the range of single precision.
fn is_in_range(radius: f64) -> bool {
    (f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX)).contains(&radius)
}
