//! Integration points of elements.

use glam::{DMat3, DVec3};

/// Integration point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IntegrationPoint {
    /// Gradient of each vertex's shape function at the point (1 / length).
    pub gradients: [DVec3; 10],
    /// Value of each vertex's shape function.
    pub shape: [f64; 10],
    /// Weight of the point: its volume.
    pub volume: f64,
}

impl IntegrationPoint {
    /// Creates the point of an isoparametric element from values and gradients of its shape functions in the reference
    /// element, and a weight there.
    pub(crate) fn isoparametric(nodes: &[DVec3], shape: &[f64], local: &[DVec3], weight: f64) -> Self {
        let jacobian = jacobian(nodes, local);
        let to_rest = jacobian.inverse().transpose();
        let mut point = Self { volume: jacobian.determinant() * weight, ..Self::default() };
        point.shape[..shape.len()].copy_from_slice(shape);
        point.gradients.iter_mut().zip(local).for_each(|(gradient, local)| *gradient = to_rest * *local);
        point
    }
}

/// Derivative of the position with respect to coordinates of the reference element.
pub(crate) fn jacobian(nodes: &[DVec3], gradients: &[DVec3]) -> DMat3 {
    let column = |axis: usize| nodes.iter().zip(gradients).map(|(p, g)| *p * g[axis]).sum();
    DMat3::from_cols(column(0), column(1), column(2))
}
