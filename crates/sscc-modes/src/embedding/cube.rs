//! Points and cubes (trilinear hexahedra): local coordinates from 0 to 1 along each axis.

use glam::{DMat3, DVec3};

use crate::interpolation::OCTANTS;

/// Maximum number of Newton steps. A parallelepiped needs one.
const MAX_STEPS: usize = 20;

/// Newton's method has converged when a step is at most this long, in local coordinates.
const TOLERANCE: f64 = 1e-13;

/// Maximum local coordinate of an iterate, from the middle of the cube: the map may fold far outside.
const MAX_LOCAL: f64 = 2.0;

/// Returns the weights of the corners at local coordinates.
pub fn weights(local: DVec3) -> [f64; 8] {
    OCTANTS.map(|octant| (0..3).map(|axis| factor(octant[axis], local[axis])).product())
}

/// Returns the local coordinates of a point; outside the cube they leave the range from 0 to 1.
pub fn local_coordinates(x: DVec3, corners: &[DVec3; 8]) -> DVec3 {
    let middle = DVec3::splat(0.5);
    let mut local = middle;
    for _ in 0..MAX_STEPS {
        let step = jacobian(local, corners).inverse() * (x - position(local, corners));
        if !step.is_finite() {
            break;
        }
        let next = (local + step).clamp(middle - MAX_LOCAL, middle + MAX_LOCAL);
        let length = (next - local).abs().max_element();
        local = next;
        if length <= TOLERANCE {
            break;
        }
    }
    local
}

/// Returns a point of the cube near x: x itself inside, else the point of the clamped local coordinates. This is the nearest
/// point of a cuboid. In a sheared or distorted cube another point may be nearer, so the distance is an upper bound.
pub fn near_point(x: DVec3, corners: &[DVec3; 8]) -> DVec3 {
    position(local_coordinates(x, corners).clamp(DVec3::ZERO, DVec3::ONE), corners)
}

/// Returns the position at local coordinates.
pub fn position(local: DVec3, corners: &[DVec3; 8]) -> DVec3 {
    corners.iter().zip(weights(local)).map(|(p, w)| *p * w).sum()
}

/// Returns the derivative of the position with respect to the local coordinates.
fn jacobian(local: DVec3, corners: &[DVec3; 8]) -> DMat3 {
    let column = |along: usize| {
        let slope = |octant: &[u32; 3]| -> f64 {
            let of = |axis: usize| match (axis == along, octant[axis]) {
                (true, 1) => 1.0,
                (true, _) => -1.0,
                _ => factor(octant[axis], local[axis]),
            };
            (0..3).map(of).product()
        };
        corners.iter().zip(&OCTANTS).map(|(p, octant)| *p * slope(octant)).sum()
    };
    DMat3::from_cols(column(0), column(1), column(2))
}

fn factor(side: u32, local: f64) -> f64 {
    if side == 1 { local } else { 1.0 - local }
}
