//! The largest weights of interest of the modes.

use glam::DVec3;

use crate::ReducedModel;

impl ReducedModel {
    /// Returns for each mode the weight at which the vertex that it moves farthest has moved by half the diagonal of
    /// the AABB at rest (paper, section 5.2); 1 for a mode that moves no vertex, or if the AABB is a point. Only
    /// vertices of faces count.
    pub fn weight_limits(&self) -> Vec<f64> {
        let used = self.mesh().used_vertices();
        let rest = || used.iter().map(|&v| self.mesh().rest_positions()[v as usize]);
        let (lower, upper) = (rest().reduce(DVec3::min), rest().reduce(DVec3::max));
        let diagonal = upper.unwrap_or_default() - lower.unwrap_or_default();
        let limit = |mode: usize| {
            let farthest = used.iter().map(|&v| self.modes().of_vertex(v)[mode].length()).fold(0.0, f64::max);
            let limit = 0.5 * diagonal.length() / farthest;
            if limit.is_finite() && limit > 0.0 { limit } else { 1.0 }
        };
        (0..self.rank()).map(limit).collect()
    }
}
