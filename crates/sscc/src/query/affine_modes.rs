//! Combinations of modes that move the whole shape by one affine map, above all its rotations within q.
//!
//! The ellipsoid of a local certificate bounds residuals by `|W f|`. A rotation of a shape with handles, corners of a cage or bones needs
//! all modes at once; each of them has residuals, which cancel in the sum. W has few digits and a floor, so `|W f|` stays large. So f is
//! split: take any vectors `n_j`, any numbers `a_j`, as computed, and `f' = f - sum_j a_j n_j`. For each j let `A_j` and `t_j` be any
//! matrix and any vector, and `e_jv = U_v n_j - A_j p_v - t_j`. With the map `F' = I + G f' + sum_j a_j A_j` of the patch in place of
//! `I + G f`, two of its points differ by
//!
//! ```text
//! x_i - x_h = F' (p_i - p_h) + (E_i - E_h) f' + sum_j a_j (e_ji - e_jh)
//! ```
//!
//! exactly. The second term is at most `s (kappa |W f'| + rho T')`, with `T' = sum_k |f'_k|`, as for f itself. The last one
//! is at most `L = 2 sum_j |a_j| max |e_j|`: small where the `n_j` move the shape by affine maps, and right for any `n_j`. The comparison
//! of the certificate, whose gaps are at least s, becomes
//!
//! ```text
//! kappa |W f'| + rho T' + (L + eta) / s  <  sigma_min(F')
//! ```
//!
//! In a region around a configuration or a motion the `a_j` stay those of the configuration, so that f' changes as f does.

use glam::{DMat3, DVec3};

use crate::certificates::{MOST_MODES, PatchModel};
use crate::model::rounding::larger_or_nan;

/// The largest number of combinations: the dimension of the affine maps. Further ones consist of modes that move nothing.
const MOST: usize = 12;

/// A combination counts as affine if the sum of its squared residuals is at most this share of the largest one of a mode.
const TOLERANCE: f64 = 1e-13;

/// Combinations whose residuals are larger, in units of half the shape's size, are not used: they would gain nothing.
const MOST_RESIDUAL: f64 = 1e-6;

/// The largest number of vertices by which combinations are fitted. Residuals are then computed for all vertices.
const MOST_FITTED: usize = 1024;

/// Rounds a sum of numbers that are not negative up.
const ROUND_UP: f64 = 1.0 + 1e-10;

/// Combinations of modes.
#[derive(Clone)]
pub(super) struct AffineModes {
    combinations: Vec<Combination>,
}

/// One combination `n` of modes.
#[derive(Clone)]
struct Combination {
    /// A unit vector, up to rounding.
    factors: Vec<f64>,
    /// `A`
    map: DMat3,
    /// An upper bound of the length of `e_v`, for each vertex v.
    residual: f64,
}

/// A configuration without its affine part; where nothing is subtracted, every `a_j` is 0.
#[derive(Clone, Default)]
pub(super) struct AffineFree {
    /// `f'`, as computed.
    pub(super) factors: Vec<f64>,
    /// An upper bound of `sum_k |f'_k - computed f'_k|` where an affine part is subtracted, also for factors with errors of two units in the
    /// last place. Elsewhere the error of the conversion to single precision is larger than that of the factors.
    pub(super) error: f64,
    /// `sum_j a_j A_j`, as computed.
    pub(super) map: DMat3,
    /// An upper bound of the error of `map` in the Frobenius norm.
    pub(super) map_error: f64,
    /// An upper bound of `L`.
    pub(super) length: f64,
}

impl AffineFree {
    /// Sets all factors, with nothing subtracted.
    pub(super) fn set(&mut self, factors: impl Iterator<Item = f64>) {
        self.factors.clear();
        self.factors.extend(factors);
        (self.error, self.map, self.map_error, self.length) = (0.0, DMat3::ZERO, 0.0, 0.0);
    }

    /// Returns the sum of the magnitudes of the computed factors.
    pub(super) fn sum(&self) -> f64 {
        self.factors.iter().map(|f| f.abs()).sum()
    }
}

impl AffineModes {
    /// Returns the combinations of a model's modes that move it by affine maps. `None` if there are no such
    /// combinations, the model has more than [`MOST_MODES`] modes, or all positions are nearly in one plane.
    pub(super) fn new(model: &PatchModel<'_>) -> Option<Self> {
        let fits = (model.rank() <= MOST_MODES).then(|| Fits::new(model, MOST_FITTED))??;
        let mut units: Vec<Vec<f64>> = Vec::new();
        for mut factors in fits.null_vectors() {
            // Twice, so that the vectors are orthogonal up to rounding.
            for unit in units.iter().chain(&units) {
                let along = dot(&factors, unit);
                factors.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            }
            let length = dot(&factors, &factors).sqrt();
            if length > 1e-6 && units.len() < MOST {
                units.push(factors.iter().map(|x| x / length).collect());
            }
        }
        let all = Self::with_directions(model, &fits, units);
        let is_affine = |one: &Combination| one.residual <= MOST_RESIDUAL;
        let combinations: Vec<Combination> = all.combinations.into_iter().filter(is_affine).collect();
        (!combinations.is_empty()).then_some(Self { combinations })
    }

    /// Returns the given combinations, each with its map and a bound of its residuals. Nothing is checked.
    #[cfg(test)]
    pub(super) fn of_parts(parts: Vec<(Vec<f64>, DMat3, f64)>) -> Self {
        let combination = |(factors, map, residual)| Combination { factors, map, residual };
        Self { combinations: parts.into_iter().map(combination).collect() }
    }

    /// Returns combinations of these factors with their fitted maps and residuals, also if they are not affine.
    fn with_directions(model: &PatchModel<'_>, fits: &Fits, directions: Vec<Vec<f64>>) -> Self {
        let combination = |factors: Vec<f64>| {
            let fit = fits.of(&factors);
            let residual = residual(model, &factors, fit);
            Combination { factors, map: fit.0, residual }
        };
        Self { combinations: directions.into_iter().map(combination).collect() }
    }

    /// Subtracts the affine part from a configuration that has all of its factors.
    pub(super) fn take_from(&self, free: &mut AffineFree) {
        let (mut terms, mut map_terms) = (free.sum(), 0.0);
        for Combination { factors, map, residual } in &self.combinations {
            let a = dot(&free.factors, factors);
            free.factors.iter_mut().zip(factors).for_each(|(f, n)| *f -= a * n);
            terms += a.abs() * factors.iter().map(|n| n.abs()).sum::<f64>();
            free.map += *map * a;
            map_terms += norm(map) * a.abs();
            free.length += with_mutant!(2.0, LocalAffineResidualOnce, 1.0) * residual * a.abs();
        }
        // Each difference is rounded by a unit of its result or of its product; the sum contains both.
        let rounding = (2 * self.combinations.len() + 4) as f64 * f64::EPSILON;
        free.error = with_mutant!(rounding * terms * ROUND_UP, LocalAffineRounding, 0.0);
        free.map_error = rounding * map_terms * ROUND_UP;
        free.length *= with_mutant!(ROUND_UP, LocalAffineResidual, 0.0);
    }
}

/// Returns an upper bound of the length of `U_v n - A p_v - t` for every used vertex.
fn residual(model: &PatchModel<'_>, factors: &[f64], (map, shift): (DMat3, DVec3)) -> f64 {
    let mut most = 0.0_f64;
    for v in model.used_vertices() {
        let mut moved = DVec3::ZERO;
        model.for_each_mode(v, |k, u| moved += u * factors[k]);
        let left = (moved - map * model.position(v) - shift).length();
        most = larger_or_nan(most, left);
    }
    // Displacements in units of the largest one are at most 1 along each axis, and have errors of two units in the last place, as have
    // their products and sums: r + 3 roundings, by the root of three for the length.
    let terms: f64 = factors.iter().map(|f| f.abs()).sum::<f64>() + norm(&map) + shift.length();
    let rounding = 8.0 * f64::EPSILON * (factors.len() + 16) as f64 * terms;
    (most + with_mutant!(rounding, LocalAffineFitExact, 0.0)) * ROUND_UP
}

/// The best affine map of each mode, and the Gram matrix of the residuals of all modes.
struct Fits {
    rank: usize,
    gram: Vec<f64>,
    /// For each mode the map and the translation.
    maps: Vec<(DMat3, DVec3)>,
}

impl Fits {
    /// Fits maps by at most `most` vertices. `None` if all positions are nearly in one plane.
    fn new(model: &PatchModel<'_>, most: usize) -> Option<Self> {
        let rank = model.rank();
        let mut gram = vec![0.0; rank * rank];
        // Sums of products of the functions x, y, z and 1 of a position: with each other, and with displacements.
        let (mut products, mut with) = ([[0.0; 4]; 4], vec![[DVec3::ZERO; 4]; rank]);
        let mut own: Vec<(usize, DVec3)> = Vec::new();
        let vertices = model.used_vertices();
        for v in vertices.iter().copied().step_by(vertices.len().div_ceil(most).max(1)) {
            let p = model.position(v);
            let functions = [p.x, p.y, p.z, 1.0];
            for (a, row) in functions.iter().zip(&mut products) {
                row.iter_mut().zip(functions).for_each(|(sum, b)| *sum += a * b);
            }
            own.clear();
            model.for_each_mode(v, |k, u| own.push((k, u)));
            for (i, (k, u)) in own.iter().enumerate() {
                with[*k].iter_mut().zip(functions).for_each(|(sum, a)| *sum += *u * a);
                own[i..].iter().for_each(|(l, w)| gram[k * rank + l] += u.dot(*w));
            }
        }
        let inverse = glam::DMat4::from_cols_array_2d(&products);
        let determinant = inverse.determinant();
        let volume: f64 = (0..4).map(|i| products[i][i]).product();
        let is_regular = determinant > 1e-9 * volume; // false for not a number
        if !is_regular {
            return None;
        }
        let inverse = inverse.inverse().to_cols_array_2d();
        let solved: Vec<[DVec3; 4]> = with
            .iter()
            .map(|with| std::array::from_fn(|i| (0..4).map(|j| with[j] * inverse[j][i]).sum()))
            .collect();
        for k in 0..rank {
            for l in k..rank {
                let fitted: f64 = (0..4).map(|i| solved[k][i].dot(with[l][i])).sum();
                gram[k * rank + l] -= fitted;
                gram[l * rank + k] = gram[k * rank + l];
            }
        }
        let maps = solved.into_iter().map(|[x, y, z, one]| (DMat3::from_cols(x, y, z), one)).collect();
        Some(Self { rank, gram, maps })
    }

    /// Returns the map of a combination.
    fn of(&self, factors: &[f64]) -> (DMat3, DVec3) {
        let add = |(map, shift): (DMat3, DVec3), (f, own): (&f64, &(DMat3, DVec3))| {
            (map + own.0 * *f, shift + own.1 * *f)
        };
        factors.iter().zip(&self.maps).fold((DMat3::ZERO, DVec3::ZERO), add)
    }

    /// Returns combinations without residuals, by a Cholesky factorisation with pivots: the residuals of each mode that is not a pivot are
    /// a combination of those of the pivots.
    fn null_vectors(&self) -> Vec<Vec<f64>> {
        let Self { rank, gram, .. } = self;
        let rank = *rank;
        let mut left: Vec<f64> = (0..rank).map(|k| gram[k * rank + k]).collect();
        let least = left.iter().fold(0.0, |most: f64, x| most.max(*x)) * TOLERANCE;
        // Rows of the factor: for each mode its products with the pivots so far.
        let (mut pivots, mut rows) = (Vec::<usize>::new(), vec![Vec::<f64>::new(); rank]);
        loop {
            let next = (0..rank).filter(|k| !pivots.contains(k)).max_by(|a, b| left[*a].total_cmp(&left[*b]));
            let Some(pivot) = next.filter(|k| left[*k] > least) else { break };
            let length = left[pivot].sqrt();
            let of_pivot = rows[pivot].clone();
            for k in 0..rank {
                let entry = if k == pivot {
                    length
                } else if pivots.contains(&k) {
                    0.0
                } else {
                    (gram[pivot * rank + k] - dot(&of_pivot, &rows[k])) / length
                };
                rows[k].push(entry);
                left[k] -= entry * entry;
            }
            pivots.push(pivot);
        }
        let others = (0..rank).filter(|k| !pivots.contains(k));
        others
            .map(|other| {
                let mut vector = vec![0.0; rank];
                vector[other] = 1.0;
                // Backwards, because each pivot has products only with the pivots before it.
                for (i, pivot) in pivots.iter().enumerate().rev() {
                    let later = pivots[i + 1..].iter();
                    let sum: f64 = later.map(|later| vector[*later] * rows[*later][i]).sum();
                    vector[*pivot] = -(rows[other][i] + sum) / rows[*pivot][i];
                }
                vector
            })
            .collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the Frobenius norm.
fn norm(matrix: &DMat3) -> f64 {
    dot(&matrix.to_cols_array(), &matrix.to_cols_array()).sqrt()
}

#[cfg(test)]
mod tests;
