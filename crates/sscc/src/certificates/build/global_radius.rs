//! `R_global`, the largest radius of interest, at which all radii are capped (paper, section 5.2).

use crate::geometry::Aabb;
use crate::model::rounding::to_f32_down;
use crate::{Metric, ReducedModel};

/// `|z|` along the first mode that moves anything at which some vertex has moved half the diagonal of the box at the
/// centre; infinite if no mode moves anything. Only vertices of faces count.
///
/// Rounded down to single precision, if it is in its range, so that the pair tree can store every radius up to it.
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
            let is_in_range = (f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX)).contains(&radius);
            return if is_in_range { f64::from(to_f32_down(radius)) } else { radius };
        }
    }
    f64::INFINITY
}

/// `reach` times the global radius, as far as the pair tree can store it: rounded down to single precision. A global radius
/// out of that range is the farthest radius itself: then there is no pair tree.
pub(super) fn farthest_radius(global_radius: f64, reach: f64) -> f64 {
    let farthest = global_radius * reach;
    if global_radius > f64::from(f32::MAX) {
        global_radius
    } else {
        f64::from(to_f32_down(farthest)).max(global_radius)
    }
}
