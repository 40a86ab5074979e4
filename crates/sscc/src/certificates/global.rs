//! `R_global`, the largest radius of interest (paper, section 5.2).

use crate::hierarchy::bounding_box;
use crate::{Metric, ReducedModel};

/// `|z|` along the first mode that moves anything at which some vertex has moved half the diagonal of the
/// box at the centre; infinite when no mode moves anything. Only vertices of faces count.
pub(super) fn global_radius(model: &ReducedModel, metric: &Metric, center: &[f64]) -> f64 {
    let used = model.mesh().used_vertices();
    let (lower, upper) = bounding_box(used.iter().map(|&v| model.position(v, center)));
    let half_diagonal = (upper - lower).length() / 2.0;
    for k in 0..metric.rank() {
        let scale = metric.mode_length(k);
        let lengths = used.iter().map(|&v| (model.modes().of_vertex(v)[k] / scale).length());
        let largest = lengths.fold(0.0, f64::max);
        if largest > 0.0 && half_diagonal > 0.0 {
            return half_diagonal / largest;
        }
    }
    f64::INFINITY
}
