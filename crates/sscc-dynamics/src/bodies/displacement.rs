//! Displacement of a point by the modes.

use glam::DVec3;

/// Returns `sum_k U_k q_k`.
pub(crate) fn displacement(modes: &[DVec3], q: &[f64]) -> DVec3 {
    modes.iter().zip(q).fold(DVec3::ZERO, |sum, (u, q)| sum + *u * *q)
}
