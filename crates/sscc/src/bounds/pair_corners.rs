//! The corners of a triangle pair and their scaled modes: the input of all its bounds.

use glam::DVec3;

use crate::geometry::TwoTriangles;
use crate::model::ScaledModel;

/// Two triangles at rest and the scaled modes of their six corners, three rows each.
#[derive(Clone, Copy)]
pub(crate) struct PairCorners<'m> {
    pub(crate) corners: TwoTriangles,
    pub(crate) modes_a: [&'m [f64]; 3],
    pub(crate) modes_b: [&'m [f64]; 3],
}

impl<'m> PairCorners<'m> {
    /// Looks up two triangles of a model (or simplices), given by their vertices.
    pub(super) fn of(model: &'m ScaledModel, a: [u32; 3], b: [u32; 3]) -> Self {
        let positions = |face: [u32; 3]| face.map(|i| model.positions[i as usize]);
        let modes = |face: [u32; 3]| face.map(|i| model.modes(i));
        Self {
            corners: TwoTriangles { a: positions(a), b: positions(b) },
            modes_a: modes(a),
            modes_b: modes(b),
        }
    }

    /// Returns the nine differences `b_j - a_i` of corners, at index `3 i + j`.
    pub(crate) fn differences(&self) -> [DVec3; 9] {
        self.corners.differences()
    }
}
