//! The model in coordinates z' about the centre, exactly, and bounds of the rounding of computed positions.
//!
//! Let `q - center = T z'` with a matrix T of short numbers that is nearly the inverse of the factor S: `S T = I + D`, with
//! `|D| <= delta` in the Frobenius norm. T may be any matrix, because D is computed from it exactly. `delta < 1` makes `S T`, and
//! so T, regular: each q has a z'. Then `z = S (q - center) = (I + D) z'`, so `|z| >= (1 - delta) |z'|`, and `|z| < R` implies
//! `|z'| < R / (1 - delta)`. All rates are per unit of z', with the exact modes `A = U T`. So the change of coordinates rounds
//! only R, upwards.
//!
//! The positions at the centre are the computed ones, from which witnesses are found. Their distance from the exact ones is part of
//! the rounding.

use std::collections::BTreeSet;

use crate::dyadic::{Dyadic, Vector, dot, squared_norm};
use crate::model::Model;
use crate::points::{Point, Radius};
use crate::refusal::{IsCancelled, Result, check_cancelled, input};
use crate::scope::Scope;

/// Binary digits to which each entry of `S T` is right, for a diagonal and for a dense factor. An entry of T is rounded when the rows
/// below it are known, so its own rounding is all that remains in its row of `S T - I`: less than `2^-digits`, whatever the condition of
/// S is. A dense factor needs more digits, because D has r^2 / 2 entries; with fewer, modes need no allocation.
const DIGITS: [i64; 2] = [64, 80];
/// Products of an entry of T and the diagonal entry of its row are smaller than two to this power. Where the library accepts a dense
/// metric, those of the computed inverse are smaller than 2^52 (it refuses a rounding error of S T above 1/2). This and the range of
/// S bound the lengths of all numbers here.
const MAX_GROWTH: i64 = 64;
/// Binary digits of the magnitudes of modes, rounded up.
const MAGNITUDE_DIGITS: usize = 53;

/// Computed positions at the centre, modes A, and the rounding of computed positions.
pub(crate) struct ScaledModel {
    pub(crate) rank: usize,
    /// Three rows for each vertex: a position, then the modes A.
    points: Vec<Dyadic>,
    /// For each axis, the sum of this and of `rate_errors |z'|` bounds the difference of a computed coordinate from that of `points` at z'.
    rest_errors: Vector,
    /// See `rest_errors`.
    rate_errors: Vector,
    delta: Dyadic,
}

impl ScaledModel {
    pub(crate) fn new(model: &Model, scope: &Scope, is_cancelled: &IsCancelled<'_>) -> Result<Self> {
        let rank = model.rank;
        let (columns, delta) = inverse(scope, rank, is_cancelled)?;
        // Entries of |T| that are rounded up make |U| |T| larger, by a relative error of at most 2^-52.
        let magnitude = |(k, t): &(usize, Dyadic)| (*k, t.abs().round_up(MAGNITUDE_DIGITS));
        let magnitudes: Vec<Column> =
            columns.iter().map(|column| column.iter().map(magnitude).collect()).collect();
        let center: Vec<Dyadic> = scope.center.iter().map(|x| Dyadic::of(*x)).collect();
        let mut points = vec![Dyadic::default(); 3 * (1 + rank) * model.positions.len()];
        let [mut rest_errors, mut rate_errors, mut center_errors] = <[Vector; 3]>::default();
        let used: BTreeSet<usize> = model.faces.as_flattened().iter().map(|i| *i as usize).collect();
        for i in used {
            check_cancelled(is_cancelled)?;
            let computed = model.computed_position(i, &scope.center);
            for (c, computed) in computed.map(Dyadic::of).into_iter().enumerate() {
                let rest = Dyadic::of(model.positions[i][c]);
                let row: Vec<Dyadic> = model.row(i, c).iter().map(|u| Dyadic::of(*u)).collect();
                let moved = || row.iter().zip(&center).map(|(u, x)| u * x);
                let exact = &rest + &moved().sum();
                center_errors[c].raise((&exact - &computed).abs());
                rest_errors[c].raise(&rest.abs() + &moved().map(|x| x.abs()).sum());
                let out = &mut points[(3 * i + c) * (1 + rank)..][..1 + rank];
                out[0] = computed;
                out[1..].iter_mut().zip(&columns).for_each(|(a, column)| *a = product(&row, column));
                let row: Vec<Dyadic> = row.iter().map(Dyadic::abs).collect();
                let magnitudes: Vec<Dyadic> = magnitudes.iter().map(|column| product(&row, column)).collect();
                rate_errors[c].raise(squared_norm(&magnitudes).root_up());
            }
        }
        // Each product and each of r sums is rounded to nearest once. So the error is at most gamma_(r+1) <= (r + 2) 2^-53 (as r <=
        // 2^20) times the magnitudes, and 2^-1075 for each product that underflows.
        let (gamma, least) = (Dyadic::new(rank as i64 + 2, -53), Dyadic::new(rank as i64 + 2, -1074));
        let error = |c: usize| &(&rest_errors[c] * &gamma) + &center_errors[c];
        let rest_errors = std::array::from_fn(|c| &error(c).round_up(64) + &least);
        let rate_errors = rate_errors.map(|x| (&x * &gamma).round_up(64));
        Ok(Self { rank, points, rest_errors, rate_errors, delta })
    }

    /// Returns a vertex.
    pub(crate) fn point(&self, vertex: u32) -> &Point {
        let length = 3 * (1 + self.rank);
        &self.points[vertex as usize * length..][..length]
    }

    /// Converts a radius of z to one of z', rounded up.
    pub(crate) fn radius(&self, radius: f64) -> Radius {
        let radius = radius.is_finite().then(|| Dyadic::of(radius))?;
        // 1 / (1 - delta) <= 1 + 2 delta for delta <= 1/2.
        Some((&radius + &(&radius * &self.delta.times_power(1))).round_up(128))
    }

    /// Returns two bounds e0 and e1: the gap of two computed points along a direction is smaller than the exact one by at most
    /// `e0 + e1 |z'|`.
    pub(crate) fn errors(&self, dir: &Vector) -> [Dyadic; 2] {
        let magnitudes = dir.each_ref().map(Dyadic::abs);
        [&self.rest_errors, &self.rate_errors].map(|errors| dot(&magnitudes, errors).times_power(1))
    }
}

/// The nonzero entries of a column of T, with their rows.
type Column = Vec<(usize, Dyadic)>;

/// Returns the product of a row and a column.
fn product(row: &[Dyadic], column: &Column) -> Dyadic {
    column.iter().map(|(k, t)| &row[*k] * t).sum()
}

/// Returns the columns of T, and delta.
fn inverse(scope: &Scope, rank: usize, is_cancelled: &IsCancelled<'_>) -> Result<(Vec<Column>, Dyadic)> {
    let digits = DIGITS[usize::from(scope.is_dense)];
    // Of a diagonal factor only entries of the diagonal are needed.
    let entry = |i: usize, j: usize| Dyadic::of(scope.factor[if scope.is_dense { i * rank + j } else { i }]);
    let (mut columns, mut error) = (Vec::new(), Dyadic::default());
    for l in 0..rank {
        check_cancelled(is_cancelled)?;
        // Solves S t = e_l by back substitution. The column has entries from its first row to its l-th.
        let first = if scope.is_dense { 0 } else { l };
        let mut column = Column::new();
        for i in (first..=l).rev() {
            let known = column.iter().map(|(j, t)| &entry(i, *j) * t).sum();
            let wanted = &Dyadic::new(i64::from(i == l), 0) - &known;
            if wanted.magnitude() > MAX_GROWTH {
                return input("metric: it is nearly singular");
            }
            let pivot = entry(i, i);
            let t = wanted.divided_by(&pivot, -digits - pivot.magnitude());
            // The entry of D: the products of the row with the known entries, and with this one, without the entry of I.
            error = &error + &(&(&pivot * &t) - &wanted).square();
            if !t.is_zero() {
                column.push((i, t));
            }
        }
        columns.push(column);
    }
    let delta = error.root_up();
    // This never happens: D has at most 2^20 entries.
    if delta > Dyadic::new(1, -20) { input("metric: it is nearly singular") } else { Ok((columns, delta)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns an upper triangular factor of random numbers, whose columns have units up to `2^units` apart.
    fn factor(rank: usize, units: i32) -> Vec<f64> {
        let mut state = rank as u64;
        let mut signed = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / 2_f64.powi(52) - 1.0
        };
        let unit = |i: usize| 2_f64.powi(units * (i as i32 * 7 % 11 - 5) / 10);
        let entry = |e: usize| match (e / rank, e % rank) {
            (i, j) if j < i => 0.0,
            (i, j) if j == i => (1.5 + 0.5 * signed()) * unit(i),
            (_, j) => 0.3 * signed() * unit(j),
        };
        (0..rank * rank).map(entry).collect()
    }

    /// The error that back substitution sums up is that of the whole product.
    #[test]
    fn the_error_of_an_inverse_is_that_of_the_product() {
        for (rank, units) in [(1, 0), (2, 300), (12, 0), (30, 60), (30, 390)] {
            let scope = Scope::of_factor(factor(rank, units), rank);
            let (columns, delta) = inverse(&scope, rank, &|| false).unwrap();
            let digits = DIGITS[usize::from(scope.is_dense)];
            let mut square = Dyadic::default();
            for i in 0..rank {
                let row: Vec<Dyadic> =
                    scope.factor[i * rank..][..rank].iter().map(|s| Dyadic::of(*s)).collect();
                for (l, column) in columns.iter().enumerate() {
                    let one = Dyadic::new(i64::from(i == l), 0);
                    square = &square + &(&product(&row, column) - &one).square();
                }
            }
            assert!(square <= delta.square() && delta < Dyadic::new(rank as i64, -digits), "{rank} {units}");
            assert!(rank == 1 || delta > Dyadic::new(1, -digits - 10), "{rank} {units}");
            // Numbers stay short.
            let longest = columns.iter().flatten().map(|(_, t)| t.size()).max();
            assert!(longest.unwrap() <= size_of::<Dyadic>() + (DIGITS[1] + MAX_GROWTH) as usize / 8 + 1);
        }
    }

    #[test]
    fn nearly_singular_factors_are_refused() {
        // The inverse of this factor has entries up to `growth^(rank - 1)`.
        let factor = |rank: usize, growth: f64| -> Vec<f64> {
            let entry = |e: usize| match (e % rank).checked_sub(e / rank) {
                Some(0) => 1.0,
                Some(1) => -growth,
                _ => 0.0,
            };
            (0..rank * rank).map(entry).collect()
        };
        let is_refused = |rank: usize, growth: f64| {
            let scope = Scope::of_factor(factor(rank, growth), rank);
            inverse(&scope, rank, &|| false).is_err()
        };
        assert!(!is_refused(8, 512.0) && is_refused(9, 512.0));
        assert!(is_refused(2, 2_f64.powi(200)) && !is_refused(100, 1.5) && is_refused(120, 1.5));
    }
}
