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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::tests::random::Random;

    /// The form of a direction's Mandel components is the squared norm, over the modes, of `u'G u`.
    #[test]
    fn forms_of_the_gram_matrix_are_those_of_the_gradient() {
        let root = std::f64::consts::SQRT_2;
        for case in 0..300 {
            let random = &mut Random::new(case);
            let row_len = 4 * (1 + random.below(5));
            let gradient: Vec<f64> = (0..9 * row_len).map(|_| random.uniform() - 0.5).collect();
            let gram = strain_gram(&gradient, row_len);
            let size: f64 = gradient.iter().map(|g| g * g).sum();
            for _ in 0..30 {
                let u = random.vector().normalize();
                let m =
                    [u.x * u.x, u.y * u.y, u.z * u.z, u.y * u.z * root, u.x * u.z * root, u.x * u.y * root];
                let form: f64 = (0..36).map(|ij| m[ij / 6] * gram[ij / 6][ij % 6] * m[ij % 6]).sum();
                let of_mode = |k: usize| -> f64 {
                    (0..9).map(|cj| u[cj / 3] * gradient[cj * row_len + k] * u[cj % 3]).sum()
                };
                let square: f64 = (0..row_len).map(|k| of_mode(k).powi(2)).sum();
                assert!((form - square).abs() <= 1e-13 * size, "case {case}: {form} {square}");
            }
        }
    }

    /// The rate is at least the root of the largest eigenvalue, and not much larger.
    #[test]
    fn no_direction_is_faster_than_the_rate() {
        for case in 0..300 {
            let random = &mut Random::new(case);
            let speed = random.power(-60.0, 60.0);
            let strains: Vec<[f64; 6]> = (0..1 + random.below(8))
                .map(|_| std::array::from_fn(|_| (random.uniform() - 0.5) * speed))
                .collect();
            let gram: StrainGram =
                std::array::from_fn(|i| std::array::from_fn(|j| strains.iter().map(|s| s[i] * s[j]).sum()));
            // Quotients of the power method are at most the largest eigenvalue.
            let mut v = [1.0 / 6.0_f64.sqrt(); 6];
            let mut largest = 0.0_f64;
            for _ in 0..300 {
                let image: [f64; 6] = gram.map(|row| row.iter().zip(v).map(|(g, x)| g * x).sum());
                largest = largest.max(image.iter().zip(v).map(|(y, x)| y * x).sum());
                let length = image.iter().map(|y| (y / speed / speed).powi(2)).sum::<f64>().sqrt();
                v = image.map(|y| y / speed / speed / length);
            }
            let rate = bound_rate(&gram, 4);
            assert!(rate >= largest.sqrt() && rate <= 1.13 * largest.sqrt(), "case {case}: {rate:e}");
        }
    }

    /// Along the only strain of one mode nothing is left but the margin for rounding.
    #[test]
    fn rates_have_their_margins() {
        for case in 0..200 {
            let random = &mut Random::new(case);
            let row_len = [4, 64, 1000][case as usize % 3];
            let strain: [f64; 6] = std::array::from_fn(|_| random.uniform() - 0.5);
            let gram = strain.map(|x| strain.map(|y| x * y));
            let trace: f64 = strain.iter().map(|x| x * x).sum();
            let margin = bound_rate(&gram, row_len) / trace.sqrt() - 1.0;
            let units = margin / (512.0 * f64::EPSILON * (row_len as f64 + 64.0));
            assert!((units - 1.0).abs() < 0.01, "case {case}: {units}");
        }
        // Squares of entries below 1e-162 are 0.
        let still: StrainGram = [[0.0; 6]; 6];
        let mut slow = still;
        slow[2][2] = 1e-304;
        let (still, slow) = (bound_rate(&still, 4), bound_rate(&slow, 4));
        assert!(
            (1e-150..2e-150).contains(&still) && (1.005e-150..2e-150).contains(&slow),
            "{still:e} {slow:e}"
        );
        let mut unknown = [[0.0; 6]; 6];
        unknown[0][1] = f64::NAN;
        unknown[4][4] = f64::NAN;
        assert!(bound_rate(&unknown, 4).is_nan());
    }
}
