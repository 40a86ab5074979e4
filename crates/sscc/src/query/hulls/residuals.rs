//! A bound of how far any vertex of a node is from its affine map: `max_v |E_v f|` for the factors f of the modes.
//!
//! Two bounds hold, and the smaller one is used. With `e_k >= max_v |E_v,k|`, first, the sum `sum_k t_k` of
//! `t_k = e_k |f_k|`. Second, `E_v = H_v diag(e)`, and for any stored vectors w_j and `h_vj` with remainder
//! `L_v = H_v - sum_j h_vj w_j'`:
//!
//! ```text
//! |E_v f| <= sum_j g_j |w_j . (e f)| + rho |t|,    g_j >= max_v |h_vj|,    rho >= max_v |L_v|
//! ```
//!
//! Within a small part the residuals of all vertices are nearly multiples of a few vectors, so that three w_j leave a
//! small rho. The remainder is that of the vectors as they are stored, so these need be neither orthogonal nor of
//! length 1.

use glam::DVec3;

use crate::model::rounding::larger_or_nan;

/// The number of vectors w_j.
pub(super) const VECTORS: usize = 3;

/// Steps of the power iteration for each vector.
const STEPS: usize = 3;

/// Rounding of remainders in double precision, for each mode. Entries of H_v are at most 1, so the norm of a row of H_v or L_v
/// is at most about `sqrt(r)`. h_vj is used as computed, so only its product with w_j and the difference round, by at most
/// `eps sqrt(r)` for each vector; the entries themselves add as much. The rounding of [`spectral_bound`] is less than the increase
/// by [`up`], for ranks below 1e7.
const ROUNDING: f64 = 1e-11;

/// The bound of a node's residuals.
pub(super) struct Residuals {
    /// `e_k`, and `w_jk e_k`: for each mode.
    pub(super) rates: Vec<[f32; 1 + VECTORS]>,
    /// `g_j`
    pub(super) along: [f32; VECTORS],
    /// `rho`
    pub(super) remainder: f32,
}

impl Residuals {
    /// Computes the bound. `residuals`: for each vertex the residual of each mode. `error`: for each mode an upper bound of
    /// the error of its residuals.
    pub(super) fn new(residuals: &mut [DVec3], error: &[f64]) -> Self {
        let rank = error.len();
        let mut rates = vec![[0.0_f32; 1 + VECTORS]; rank];
        for of_vertex in residuals.chunks_exact(rank) {
            rates
                .iter_mut()
                .zip(of_vertex)
                .for_each(|(rate, e)| rate[0] = larger_or_nan(rate[0], e.length() as f32));
        }
        // The errors are covered elsewhere, too. With the terms T_k of the map, the error of a residual is less than
        // 16 eps (e_k + 2 T_k). 16 eps e_k is less than the increase by `up`, here and of the remainder, whose constant is
        // larger than 16 eps; 32 eps T_k is less than 2^-24 T_k, of which the error of single precision has 14 in
        // reserve (`HullMotion::begin`).
        for (rate, error) in rates.iter_mut().zip(error) {
            rate[0] = up(f64::from(rate[0]) + with_mutant!(*error, HullResidualErrorForgotten, 0.0));
        }
        // H_v, from here on.
        for of_vertex in residuals.chunks_exact_mut(rank) {
            for (h, rate) in of_vertex.iter_mut().zip(&rates) {
                *h = if rate[0] > 0.0 { *h / f64::from(rate[0]) } else { DVec3::ZERO };
            }
        }
        let mut along = [0.0; VECTORS];
        let mut vector = vec![0.0; rank];
        for j in 0..VECTORS.min(rank) {
            principal_vector(residuals, &mut vector);
            for (rate, w) in rates.iter_mut().zip(&mut vector) {
                rate[1 + j] = (*w as f32) * rate[0];
                // The stored number is used, so that its rounding needs no bound. (Its two roundings, `2^-23 |w_jk| t_k`, would
                // also be within the relative error of sums, of which `HullMotion::relative` has 21 such units in reserve; and
                // underflow is far below the constant of `HullMotion::error`, since factors are below 1e13.)
                let stored = if rate[0] > 0.0 { f64::from(rate[1 + j]) / f64::from(rate[0]) } else { 0.0 };
                *w = with_mutant!(stored, HullVectorsUnrounded, *w);
            }
            let mut most = 0.0_f64;
            for of_vertex in residuals.chunks_exact_mut(rank) {
                let h = of_vertex.iter().zip(&vector).map(|(h, w)| *h * *w).sum::<DVec3>();
                most = larger_or_nan(most, h.length());
                of_vertex.iter_mut().zip(&vector).for_each(|(l, w)| *l -= h * *w);
            }
            along[j] = up(most);
        }
        let largest = residuals.chunks_exact(rank).map(spectral_bound).fold(0.0, larger_or_nan);
        // The error of the residual of mode k is at most error_k, so that of its H_v is at most error_k / e_k, and that of the
        // remainder at most the norm of all these quotients: the computed h_vj are used.
        let errors = error.iter().zip(&rates).filter(|(_, rate)| rate[0] > 0.0);
        let error = errors.map(|(error, rate)| (error / f64::from(rate[0])).powi(2)).sum::<f64>().sqrt();
        let own = with_mutant!(error, HullResidualErrorForgotten, 0.0);
        let remainder = with_mutant!(up(largest + own + ROUNDING * rank as f64), HullRemainderForgotten, 0.0);
        Self { rates, along, remainder }
    }
}

/// Computes approximately the unit vector over the modes along which the rows of all vertices are largest.
fn principal_vector(rows: &[DVec3], vector: &mut [f64]) {
    let rank = vector.len();
    // The largest row.
    let norm = |h: &[DVec3]| h.iter().map(|h| h.length_squared()).sum::<f64>();
    let rows_of = || rows.chunks_exact(rank);
    let first =
        rows_of().map(norm).enumerate().fold((0, -1.0), |best, x| if x.1 > best.1 { x } else { best }).0;
    let row = &rows[first * rank..][..rank];
    let sum = row.iter().map(|h| *h * *h).sum::<DVec3>();
    let axis = sum.max_position();
    vector.iter_mut().zip(row).for_each(|(w, h)| *w = h[axis]);
    normalize(vector);
    let mut next = vec![0.0; rank];
    for _ in 0..STEPS {
        next.fill(0.0);
        for of_vertex in rows_of() {
            let h = of_vertex.iter().zip(&*vector).map(|(h, w)| *h * *w).sum::<DVec3>();
            next.iter_mut().zip(of_vertex).for_each(|(next, row)| *next += row.dot(h));
        }
        vector.copy_from_slice(&next);
        normalize(vector);
    }
}

fn normalize(vector: &mut [f64]) {
    let norm = vector.iter().map(|w| w * w).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|w| *w = if norm > 0.0 { *w / norm } else { 0.0 });
}

/// Returns an upper bound of the largest singular value of the three rows: the root of the largest absolute row sum of
/// their Gram matrix.
fn spectral_bound(rows: &[DVec3]) -> f64 {
    let mut gram = [DVec3::ZERO; 3];
    for l in rows {
        (0..3).for_each(|axis| gram[axis] += *l * l[axis]);
    }
    gram.map(|row| row.abs().element_sum()).into_iter().fold(0.0, larger_or_nan).sqrt()
}

/// Rounds up to single precision. NaN stays NaN.
pub(super) fn up(x: f64) -> f32 {
    if x <= 0.0 { 0.0 } else { ((x * (1.0 + 1e-12)) as f32).next_up() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// A mode that moves no vertex is no obstacle to the bound by vectors.
    #[test]
    fn still_modes_leave_all_numbers_finite() {
        let mut residuals = [DVec3::X, DVec3::ZERO, DVec3::NEG_X, DVec3::ZERO];
        let Residuals { rates, along, remainder } = Residuals::new(&mut residuals, &[0.0; 2]);
        assert_eq!(rates[1], [0.0; 1 + VECTORS]);
        assert!(rates.iter().flatten().chain(&along).all(|x| x.is_finite()), "{rates:?} {along:?}");
        assert!(along[0] >= 0.999 && remainder < 1e-9, "{along:?} {remainder}");
    }

    /// The residuals of all vertices are within the bound, also if they are wrong by their errors, for random factors and
    /// for those that follow a row of a remainder; for these, the bound is nearly reached.
    #[test]
    fn residuals_are_within_the_bound_and_reach_it() {
        let random = &mut Random(61);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        for case in 0..30 {
            let (rank, count) = ([1, 2, 3, 5, 9][case % 5], 12);
            let sizes: Vec<f64> = (0..rank).map(|_| random.power(-2.0, 2.0)).collect();
            let rows: Vec<DVec3> = (0..count * rank).map(|i| random.vector() * sizes[i % rank]).collect();
            let error: Vec<f64> = sizes.iter().map(|size| size * [0.0, 0.1][case / 5 % 2]).collect();
            let Residuals { rates, along, remainder } = Residuals::new(&mut rows.clone(), &error);
            let (along, remainder) = (along.map(f64::from), f64::from(remainder));

            let largest: Vec<f64> = rates.iter().map(|rate| f64::from(rate[0])).collect();
            for k in 0..rank {
                let of_mode = rows.iter().skip(k).step_by(rank).map(|e| e.length());
                let most = of_mode.fold(0.0, f64::max) + error[k];
                assert!((1.0..1.0 + 1e-6).contains(&(largest[k] / most)), "case {case}, mode {k}");
            }
            // Three vectors describe up to three modes.
            let own = error.iter().zip(&largest).map(|(error, e)| (error / e).powi(2)).sum::<f64>().sqrt();
            assert!(
                remainder >= own && (rank > VECTORS || remainder < own + 1e-5),
                "case {case}: {remainder}"
            );

            let vectors: [Vec<f64>; VECTORS] = std::array::from_fn(|j| {
                rates.iter().map(|r| f64::from(r[1 + j]) / f64::from(r[0])).collect()
            });
            // Factors are in units in which the largest residual of each mode is 1.
            let bound = |t: &[f64]| {
                let split = along.iter().zip(&vectors).map(|(g, w)| g * dot(w, t).abs()).sum::<f64>();
                split + remainder * dot(t, t).sqrt()
            };
            let residual = |v: usize, t: &[f64]| {
                let factors: Vec<f64> = t.iter().zip(&largest).map(|(t, e)| t / e).collect();
                let of_vertex = rows[v * rank..][..rank].iter().zip(&factors);
                let errors = error.iter().zip(&factors).map(|(error, f)| error * f.abs());
                of_vertex.map(|(e, f)| *e * *f).sum::<DVec3>().length() + errors.sum::<f64>()
            };
            let mut share = 0.0_f64;
            for i in 0..4 * count {
                let t: Vec<f64> = if i < count {
                    (0..rank).map(|_| random.signed()).collect()
                } else {
                    let (v, axis) = (i % count, i / count - 1);
                    let mut t: Vec<f64> = (0..rank).map(|k| rows[v * rank + k][axis] / largest[k]).collect();
                    for w in vectors.iter().chain(&vectors).filter(|w| dot(w, w) > 0.5) {
                        let part = dot(w, &t) / dot(w, w);
                        t.iter_mut().zip(w).for_each(|(t, w)| *t -= part * w);
                    }
                    t
                };
                let most = (0..count).map(|v| residual(v, &t)).fold(0.0, f64::max);
                assert!(most <= bound(&t) * (1.0 + 1e-12), "case {case}, {i}: {most} {}", bound(&t));
                if i >= count {
                    share = share.max(most / bound(&t).max(1e-3));
                }
            }
            assert!(rank <= VECTORS || share > 0.7, "case {case}: {share}");
        }
    }

    /// The search for vectors begins at the largest row, here that of the only vertex that has residuals.
    #[test]
    fn one_vector_describes_the_only_vertex_with_residuals() {
        let mut residuals = [DVec3::ZERO; 12];
        residuals[10..].copy_from_slice(&[DVec3::X, DVec3::X * 2.0]);
        let Residuals { along, remainder, .. } = Residuals::new(&mut residuals, &[0.0; 2]);
        assert!(along[0] > 1.0 && remainder < 1e-5, "{along:?} {remainder}");
    }

    /// Where the Gram matrix is diagonal or has rank 1, the bound is the largest singular value itself.
    #[test]
    fn spectral_bounds_of_perpendicular_and_of_parallel_rows_are_exact() {
        assert_eq!(spectral_bound(&[DVec3::X * 3.0, DVec3::Y * -4.0]), 4.0);
        assert_eq!(spectral_bound(&[DVec3::new(1.0, -1.0, 0.0), DVec3::new(-1.0, 1.0, 0.0)]), 2.0);
    }
}
