//! The strains of an affine map of the modes, and an upper bound of the rate at which the map changes distances.

use crate::model::mode_rows::LANES;

/// Gram matrix of the 6 x r matrix whose column k holds the Mandel components of the symmetric part of mode
/// k's gradient (scaled so that those of `u u'` have norm 1 for a unit vector u).
pub(super) type StrainGram = [[f64; 6]; 6];

/// Returns the Gram matrix of a gradient of nine rows: `G_cj` at `3 c + j`.
pub(super) fn strain_gram(gradient: &[f64], row_len: usize) -> StrainGram {
    let g = |c: usize, j: usize| &gradient[(3 * c + j) * row_len..][..row_len];
    let half_root = std::f64::consts::FRAC_1_SQRT_2;
    let mut gram = [[0.0; 6]; 6];
    let (xx, yy, zz) = (g(0, 0), g(1, 1), g(2, 2));
    let shears = [(g(1, 2), g(2, 1)), (g(0, 2), g(2, 0)), (g(0, 1), g(1, 0))];
    for start in (0..row_len).step_by(LANES) {
        let mut m = [[0.0; LANES]; 6];
        for lane in 0..LANES {
            let k = start + lane;
            (m[0][lane], m[1][lane], m[2][lane]) = (xx[k], yy[k], zz[k]);
            for (slot, (a, b)) in m[3..].iter_mut().zip(shears) {
                slot[lane] = (a[k] + b[k]) * half_root;
            }
        }
        for i in 0..6 {
            for j in i..6 {
                gram[i][j] += (0..LANES).map(|lane| m[i][lane] * m[j][lane]).sum::<f64>();
            }
        }
    }
    for i in 0..6 {
        for j in 0..i {
            gram[i][j] = gram[j][i];
        }
    }
    gram
}

/// Returns an upper bound of `max over unit u of |G(u)'u|`: the root of the largest eigenvalue, bounded from above by
/// `(sum of eigenvalues^8)^(1/8)` through two squarings; power iteration would approach from below.
pub(super) fn bound_rate(gram: &StrainGram, row_len: usize) -> f64 {
    let trace: f64 = (0..6).map(|i| gram[i][i]).sum();
    if trace == 0.0 {
        return UNDERFLOW; // infinite and NaN traces continue: the bound that uses them becomes 0
    }
    // In units of the trace, all eigenvalues are at most 1, and the largest is at least 1/6.
    let unit = gram.map(|r| r.map(|x| x / trace));
    let square = |m: &[[f64; 6]; 6]| -> [[f64; 6]; 6] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| m[i][k] * m[k][j]).sum()))
    };
    let fourth = square(&square(&unit));
    let eighth: f64 = fourth.iter().flatten().map(|x| x * x).sum();
    // Entries err by at most (row + 8) eps of the trace, those of the two squares by 8 eps more. On an
    // eigenvalue of at least 1/6 of the trace, its fourth power at least 6^-4, this adds up to less than
    // (row + 64) 512 eps of the result.
    let largest = eighth.sqrt().sqrt().sqrt() * trace;
    largest.sqrt() * (1.0 + (row_len as f64 + 64.0) * 512.0 * f64::EPSILON) + UNDERFLOW
}

/// Covers gradient entries whose squares underflow.
const UNDERFLOW: f64 = 1e-150;
