//! The model in coordinates z' about the centre, exactly, and bounds of the rounding of computed positions.
//!
//! Let `q - center = T z'` with a matrix T of short numbers that is nearly the inverse of the factor S: `S T = I + D`, with
//! `|D| <= delta` in the Frobenius norm. Then `z = S (q - center) = (I + D) z'`, and `|z| < R` implies `|z'| < R / (1 - delta)`.
//! All rates are per unit of z', with the modes `A = U T`. So the change of coordinates rounds only R, upwards.
//!
//! The positions at the centre are the computed ones, from which witnesses are found. Their distance from the exact ones is part of
//! the rounding.

use crate::dyadic::{Dyadic, Vector, squared_norm, vector};
use crate::model::Model;
use crate::refusal::{IsCancelled, Refusal, check_cancelled, input};
use crate::scope::Scope;

/// Binary digits of T for a diagonal and for a dense factor, which needs more, because products cancel.
const DIGITS: [usize; 2] = [64, 192];

/// A radius for `|z'|`.
#[derive(Clone, Debug)]
pub(crate) enum Radius {
    Finite(Dyadic),
    Infinite,
}

/// Computed positions at the centre, modes A, and the rounding of computed positions.
pub(crate) struct ScaledModel {
    pub(crate) rank: usize,
    pub(crate) positions: Vec<Vector>,
    /// The modes A: three rows for each vertex.
    modes: Vec<Dyadic>,
    /// For each axis, the sum of this and of `rate_errors |z'|` bounds the difference of a computed coordinate from `positions + A z'`.
    rest_errors: Vector,
    /// See `rest_errors`.
    rate_errors: Vector,
    delta: Dyadic,
}

impl ScaledModel {
    pub(crate) fn new(model: &Model, scope: &Scope, is_cancelled: &IsCancelled<'_>) -> Result<Self, Refusal> {
        let rank = model.rank;
        let (columns, delta) = inverse(scope, rank, is_cancelled)?;
        let mut used = vec![false; model.positions.len()];
        model.faces.as_flattened().iter().for_each(|i| used[*i as usize] = true);
        let center: Vec<Dyadic> = scope.center.iter().map(|x| Dyadic::of(*x)).collect();
        let mut this = Self {
            rank,
            positions: vec![Vector::default(); used.len()],
            modes: vec![Dyadic::default(); 3 * rank * used.len()],
            rest_errors: Vector::default(),
            rate_errors: Vector::default(),
            delta,
        };
        let mut center_errors = Vector::default();
        for i in (0..used.len()).filter(|i| used[*i]) {
            check_cancelled(is_cancelled)?;
            let rest = vector(model.positions[i]);
            this.positions[i] = vector(model.computed_position(i, &scope.center));
            for c in 0..3 {
                let row = &model.modes_of(i)[c * rank..][..rank];
                let row: Vec<Dyadic> = row.iter().map(|u| Dyadic::of(*u)).collect();
                let moved = || row.iter().zip(&center).map(|(u, x)| u * x);
                let exact = &rest[c] + &moved().sum();
                center_errors[c].raise((&exact - &this.positions[i][c]).abs());
                let magnitude = &rest[c].abs() + &moved().map(|x| x.abs()).sum();
                let product = |column: &Column, is_abs: bool| -> Dyadic {
                    let terms = column.iter().map(|(k, t)| &row[*k] * t);
                    terms.map(|x| if is_abs { x.abs() } else { x }).sum()
                };
                let out = &mut this.modes[(3 * i + c) * rank..][..rank];
                out.iter_mut().zip(&columns).for_each(|(a, column)| *a = product(column, false));
                let magnitudes: Vec<Dyadic> = columns.iter().map(|column| product(column, true)).collect();
                this.rest_errors[c].raise(magnitude);
                this.rate_errors[c].raise(squared_norm(&magnitudes).root_up());
            }
        }
        // Each product and each of r sums is rounded to nearest once. So the error is at most gamma_(r+1) <= (r + 2) 2^-53 times the
        // magnitudes, and 2^-1075 for each product that underflows.
        let (gamma, least) = (Dyadic::new(rank as i64 + 2, -53), Dyadic::new(rank as i64 + 2, -1074));
        let error = |c: usize| &(&this.rest_errors[c] * &gamma) + &center_errors[c];
        this.rest_errors = std::array::from_fn(|c| &error(c).round_up(64) + &least);
        this.rate_errors = this.rate_errors.map(|x| (&x * &gamma).round_up(64));
        Ok(this)
    }

    /// Returns the row of the modes for a vertex and a component.
    pub(crate) fn row(&self, vertex: u32, component: usize) -> &[Dyadic] {
        &self.modes[(3 * vertex as usize + component) * self.rank..][..self.rank]
    }

    /// Converts a radius of z to one of z', rounded up.
    pub(crate) fn radius(&self, radius: f64) -> Radius {
        if radius.is_infinite() {
            return Radius::Infinite;
        }
        let radius = Dyadic::of(radius);
        // 1 / (1 - delta) <= 1 + 2 delta for delta <= 1/2.
        Radius::Finite((&radius + &(&radius * &self.delta.times_power(1))).round_up(128))
    }

    /// Returns two bounds e0 and e1: the gap of two computed points along a direction is smaller than the exact one by at most
    /// `e0 + e1 |z'|`.
    pub(crate) fn errors(&self, dir: &Vector) -> [Dyadic; 2] {
        [&self.rest_errors, &self.rate_errors].map(|errors| {
            let sum: Dyadic = dir.iter().zip(errors).map(|(d, e)| &d.abs() * e).sum();
            sum.times_power(1)
        })
    }
}

/// A column of T: its nonzero entries, with their rows.
type Column = Vec<(usize, Dyadic)>;

/// Returns the columns of T, and delta.
fn inverse(
    scope: &Scope,
    rank: usize,
    is_cancelled: &IsCancelled<'_>,
) -> Result<(Vec<Column>, Dyadic), Refusal> {
    let digits = DIGITS[usize::from(scope.is_dense)];
    let entry = |i: usize, j: usize| match scope.is_dense {
        true => Dyadic::of(scope.factor[i * rank + j]),
        false if i == j => Dyadic::of(scope.factor[i]),
        false => Dyadic::default(),
    };
    let first = |l: usize| if scope.is_dense { 0 } else { l };
    let (mut columns, mut error) = (Vec::new(), Dyadic::default());
    for l in 0..rank {
        check_cancelled(is_cancelled)?;
        // Solves S t = e_l by back substitution. The column has entries from its first row to its l-th.
        let first = first(l);
        let mut t = vec![Dyadic::default(); l + 1 - first];
        for i in (first..=l).rev() {
            let known: Dyadic = (i + 1..=l).map(|j| &entry(i, j) * &t[j - first]).sum();
            let wanted = &Dyadic::new(i64::from(i == l), 0) - &known;
            t[i - first] = wanted.divided_by(&entry(i, i), digits);
        }
        for i in first..=l {
            let product: Dyadic = (i..=l).map(|j| &entry(i, j) * &t[j - first]).sum();
            error = &error + &(&product - &Dyadic::new(i64::from(i == l), 0)).square();
        }
        let column = (first..).zip(t).filter(|(_, t)| !t.is_zero());
        columns.push(column.collect());
    }
    let delta = error.root_up();
    if delta > Dyadic::new(1, -20) { input("metric: it is nearly singular") } else { Ok((columns, delta)) }
}
