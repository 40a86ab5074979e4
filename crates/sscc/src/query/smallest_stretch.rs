//! Lower bounds of the smallest singular value of a 3 x 3 matrix, which is the smallest stretch of any direction by the map.

use glam::DMat3;

use crate::model::rounding::larger_or_nan;

/// Error of a Gram matrix relative to the sum of the magnitudes of its entries, in units u = 2^-53: its products and sums, 3 of the
/// trace in the Frobenius norm; the factorisation, at most 4 (size + 3 |shift|); the shift, 3; the sum that made the map, 4.
/// Less than 30 of 900.
const GRAM_ERROR: f64 = 1e-13;

/// The same for the symmetric part of a matrix.
const SYMMETRIC_ERROR: f64 = 1e-12;

/// Error of a turned map over its Frobenius norm: the product with a rotation (5.2 u), its symmetric part (1 u), and a rotation whose
/// columns have the length 1 up to 3 u and are orthogonal up to [`ORTHOGONAL`] (12 u). Less than 20 u of 90.
const TURN_ERROR: f64 = 1e-14;

/// Returns a lower bound of the smallest singular value of a matrix; 0 for a matrix with NaN.
pub(super) fn smallest_stretch(map: &DMat3) -> f64 {
    let gram = map.transpose() * *map;
    smallest_eigenvalue_of(&gram, GRAM_ERROR).max(0.0).sqrt() * (1.0 - 1e-12)
}

/// Returns a lower bound of the smallest eigenvalue of the symmetric part of a matrix. This eigenvalue is at most the
/// smallest singular value of the matrix. The eigenvalue is concave in the matrix, so a lower bound at two matrices
/// holds between them. Callers have multiplied the matrix by a rotation that is orthogonal up to rounding; the share of
/// the norm covers this rounding.
pub(super) fn smallest_eigenvalue(map: &DMat3) -> f64 {
    let least = smallest_eigenvalue_of(&((*map + map.transpose()) * 0.5), SYMMETRIC_ERROR);
    let lost = TURN_ERROR * norm(map);
    if lost.is_finite() { least - lost } else { f64::NEG_INFINITY }
}

/// Returns a lower bound of the smallest eigenvalue of a symmetric matrix; minus infinity if none was found. `error`: the error of
/// the entries, relative to the sum of their magnitudes.
fn smallest_eigenvalue_of(matrix: &DMat3, error: f64) -> f64 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let size = [x, y, z].iter().map(|x| x.abs().element_sum()).sum::<f64>();
    // The candidate comes from the closed form. Any candidate would be valid, since it is verified below.
    let mean = (x.x + y.y + z.z) / 3.0;
    let [a, b, c] = [x.x - mean, y.y - mean, z.z - mean];
    let spread = ((a * a + b * b + c * c + 2.0 * (x.y * x.y + x.z * x.z + y.z * y.z)) / 6.0).sqrt();
    let candidate = if spread > 1e-12 * size {
        let one = 1.0 / spread;
        let [a, b, c, d, e, f] = [a, b, c, x.y, x.z, y.z].map(|x| x * one);
        let half = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e));
        mean - spread * (1.0 + least_root_below_one(half.clamp(-1.0, 1.0)))
    } else {
        mean
    };
    // The relative error of the closed form may be as large as the square root of the relative rounding error of its input.
    for slack in [2e-7, 2e-6] {
        let shift = candidate - slack * size;
        if with_mutant!(has_cholesky_factor(matrix, shift + error * size), LocalEigenvalueUnproven, true) {
            return shift;
        }
    }
    f64::NEG_INFINITY
}

/// The coefficients of `u / v` in [`least_root_below_one`], fitted at Chebyshev's points.
const ROOT: [f64; 8] = [
    0.999_999_921_1,
    -0.166_661_520_9,
    0.069_361_579_8,
    -0.036_464_460_9,
    0.020_176_493_3,
    -0.009_808_234_7,
    0.003_326_470_8,
    -0.000_545_020_9,
];

/// Returns the u in [0, 1] for which `x = -1 - u` is the least root of `x^3 - 3 x = 2 h`, up to 1e-7. It solves
/// `u^2 (3 + u) = 2 (1 - h) = 3 v^2`.
fn least_root_below_one(h: f64) -> f64 {
    let v = (2.0 / 3.0 * (1.0 - h)).sqrt();
    v * ROOT.iter().rev().fold(0.0, |sum, c| sum * v + c)
}

/// Whether the Cholesky factorisation of a symmetric matrix minus `shift` times the identity succeeds. (Rump, *Verification of
/// positive definiteness*, 2006: its rounding is relative to the trace.) NaN fails.
fn has_cholesky_factor(matrix: &DMat3, shift: f64) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let first = x.x - shift;
    let (b, c) = (x.y / first, x.z / first);
    let second = (y.y - shift) - b * x.y;
    let e = y.z - b * x.z;
    // The quotient comes first, because the square of e may underflow.
    let third = (z.z - shift) - c * x.z - e * (e / second);
    first > 0.0 && second > 0.0 && third > 0.0
}

/// Error of the mean of maps over its Frobenius norm, beside their distances from it: a sum and a product, less than 4 u of 90.
const MEAN_ERROR: f64 = 1e-14;

/// A motion is short if its maps are at most this far from their mean, in the Frobenius norm.
const SHORT: f64 = 1.0 / 16.0;

/// Returns for each of some maps a lower bound of its smallest singular value; 0 if none was found. For any weights, the weighted mean
/// of the bounds is a lower bound for the weighted mean of the maps.
///
/// If the maps are near their mean, the stretch of each is that of the mean, less at most the distance from it. Otherwise all maps
/// are multiplied by one rotation, and the bounds are the smallest eigenvalues of their symmetric parts.
pub(super) fn stretches_between<const E: usize>(maps: &[DMat3; E]) -> [f64; E] {
    let mean = maps.iter().fold(DMat3::ZERO, |sum, map| sum + *map) * (1.0 / E as f64);
    let distance = maps.iter().map(|map| norm(&(*map - mean))).fold(0.0, larger_or_nan);
    if distance <= SHORT {
        let rounding = MEAN_ERROR * norm(&mean);
        let lost = with_mutant!(distance * (1.0 + 1e-12) + rounding, LocalMotionForgotten, rounding);
        return [(smallest_stretch(&mean) - lost).max(0.0); E];
    }
    let Some(turn) = nearest_rotation(&mean) else { return [0.0; E] };
    let turn = turn.transpose();
    // Any rotation is valid, if it is the same one for all maps.
    let bounds = maps.map(|map| {
        with_mutant!(smallest_eigenvalue(&(turn * map)), LocalTurnAtEachEnd, smallest_stretch(&map))
    });
    if bounds.iter().all(|bound| *bound > 0.0) { bounds } else { [0.0; E] }
}

/// Returns the Frobenius norm.
fn norm(map: &DMat3) -> f64 {
    map.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Steps of the iteration towards the rotation.
const STEPS: usize = 8;

/// The largest cosine between two columns of a rotation: more than the rounding of two orthogonal vectors, and far less than
/// [`smallest_eigenvalue`] covers.
const ORTHOGONAL: f64 = 1e-15;

/// Returns the rotation of the polar decomposition, by Newton's iteration (Higham 1986), as an orthogonal matrix; `None` if the
/// map is nearly singular.
pub(super) fn nearest_rotation(map: &DMat3) -> Option<DMat3> {
    let mut next = *map;
    for _ in 0..STEPS {
        let inverse = next.inverse().transpose();
        // The factor brings the singular values close to 1.
        let size = |m: &DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>();
        let factor = (size(&inverse) / size(&next)).sqrt().sqrt();
        next = (next * factor + inverse * (1.0 / factor)) * 0.5;
    }
    // The columns are made orthogonal up to rounding, also if the iteration did not converge.
    let x = next.x_axis.try_normalize()?;
    let y = (next.y_axis - x * x.dot(next.y_axis)).try_normalize()?;
    let y = (y - x * x.dot(y)).try_normalize()?;
    // If the map is nearly singular, two columns may be parallel after the iteration.
    let cosine = x.dot(y).abs();
    if cosine.is_nan() || cosine > ORTHOGONAL {
        return None;
    }
    let z = x.cross(y);
    let z = if z.dot(next.z_axis) < 0.0 { -z } else { z };
    Some(DMat3::from_cols(x, y, z))
}

#[cfg(test)]
mod tests;
