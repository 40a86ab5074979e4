//! `R_global`, the largest radius of interest (paper, section 5.2).

use crate::hierarchy::bounding_box;
use crate::{Metric, ReducedModel};

/// `|z|` along the first mode that moves anything at which some vertex has moved half the diagonal of the
/// rest box; infinite when no mode moves anything. Only vertices of faces count.
pub(super) fn global_radius(model: &ReducedModel, metric: &Metric) -> f64 {
    let used = model.mesh().used_vertices();
    let (lower, upper) = bounding_box(used.iter().map(|&v| model.mesh().rest_positions()[v as usize]));
    let half_diagonal = (upper - lower).length() / 2.0;
    for (k, scale) in metric.scales().iter().enumerate() {
        let lengths = used.iter().map(|&v| (model.modes().of_vertex(v)[k] / *scale).length());
        let largest = lengths.fold(0.0, f64::max);
        if largest > 0.0 && half_diagonal > 0.0 {
            return half_diagonal / largest;
        }
    }
    f64::INFINITY
}
