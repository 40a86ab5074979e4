//! Point on the ground: a vertex of a body that the corrections of a step keep above it.

use glam::DVec3;

use super::contact_laws::ContactLaws;
use crate::bodies::displacement::displacement;
use crate::{Body, Ground, Shape};

/// Vertex that the ground supports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GroundPoint {
    pub vertex: u32,
    /// Vector from the centre of mass at the beginning of the step (axes of the world).
    pub arm: DVec3,
    /// Gap at the beginning of the step.
    pub gap: f64,
    /// Minimum gap at the end of the step.
    pub min_gap: f64,
    pub normal_impulse: f64,
    pub friction_impulse: DVec3,
}

/// Returns the position of a vertex from the centre of mass, at rest.
pub(crate) fn rest_position(shape: &Shape, vertex: u32) -> DVec3 {
    shape.model().mesh().rest_positions()[vertex as usize] - shape.mass().center
}

impl GroundPoint {
    /// Returns the point of a vertex at the beginning of the step.
    pub fn at(vertex: u32, body: &Body, ground: &Ground, laws: &ContactLaws) -> Self {
        let modes = body.shape().model().modes().of_vertex(vertex);
        let point = rest_position(body.shape(), vertex) + displacement(modes, &body.start.q);
        let start = &body.start.rigid;
        let arm = start.orientation * point;
        let gap = ground.normal.dot(start.position + arm) - ground.height;
        Self { vertex, arm, gap, min_gap: laws.kept_gap(gap), ..Self::default() }
    }
}
