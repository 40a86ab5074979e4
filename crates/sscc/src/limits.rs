//! The range of numbers in which the proofs hold.
//!
//! Determinants of positions are cubic and norms are quadratic in the input, so numbers beyond
//! these limits could overflow or vanish inside a proof. They are refused where they enter.

use glam::DVec3;

/// Largest magnitude of a rest coordinate, a mode entry or a deformed coordinate: 2^200 (about 1.6e60).
pub const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);

/// The scaled modes `U S^-1` of a metric must be largest somewhere between this (2^-200) and [`LARGEST`].
pub const SMALLEST: f64 = f64::from_bits((1023 - 200) << 52);

/// Whether all three coordinates are finite and at most [`LARGEST`] in magnitude.
pub fn contains(x: DVec3) -> bool {
    x.abs().cmple(DVec3::splat(LARGEST)).all()
}
