//! The range of input numbers in which the proofs hold.
//!
//! Determinants of positions are cubic in the input and norms are quadratic. Beyond these limits they could overflow or
//! underflow inside a proof, so [`TriMesh`](crate::TriMesh), [`Modes`](crate::Modes) and
//! [`ReducedModel`](crate::ReducedModel) refuse such input.

use glam::DVec3;

/// Largest magnitude of a rest coordinate, a mode entry or a deformed coordinate: 2^200 (about 1.6e60).
pub const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);

/// Smallest magnitude of the largest entry of the scaled modes `U S^-1` of a metric: 2^-200. The largest is
/// [`LARGEST`].
pub(crate) const SMALLEST: f64 = f64::from_bits((1023 - 200) << 52);

/// Maximum number of modes. Sums of so many terms round by less than 2^-32 of their magnitudes, which margins of 1e-9 cover.
pub(crate) const MAX_MODES: usize = 1 << 20;

/// Whether all three coordinates are finite and at most [`LARGEST`] in magnitude.
pub fn contains(x: DVec3) -> bool {
    x.abs().cmple(DVec3::splat(LARGEST)).all()
}
