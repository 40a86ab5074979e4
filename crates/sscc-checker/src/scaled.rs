//! The model in coordinates z about the centre, exactly, and bounds of the rounding of computed positions.
//!
//! `q - center = T z'` with a matrix T of short numbers that is nearly the inverse of the factor S: `S T = I + D`, `|D| <=
//! delta` in the Frobenius norm. Then `z = S (q - center) = (I + D) z'`, and `|z| < R` implies `|z'| < R / (1 - delta)`. All
//! rates are over z', with the modes `A = U T`; so nothing else is rounded but R, upwards.
//!
//! The positions at the centre are the computed ones, from which witnesses are found. How far they are from the exact ones is
//! part of the rounding.

use crate::dyadic::{Dyadic, Vector, squared_norm, vector};
use crate::model::Model;
use crate::refusal::{Refusal, input};
use crate::scope::Scope;

/// Digits of T: of a dense factor more, for those that cancel.
const DIGITS: [usize; 2] = [64, 192];

/// A radius, over z'.
#[derive(Clone, Debug)]
pub(crate) enum Radius {
    Finite(Dyadic),
    Infinite,
}

/// Computed positions at the centre, modes A, and the rounding of computed positions.
pub(crate) struct ScaledModel {
    pub(crate) rank: usize,
    pub(crate) positions: Vec<Vector>,
    /// Three rows for each vertex.
    modes: Vec<Dyadic>,
    /// For each axis a bound of the difference of each computed coordinate to `positions + A z'`: this, and `rate_errors |z'|`.
    rest_errors: Vector,
    rate_errors: Vector,
    delta: Dyadic,
}

impl ScaledModel {
    pub(crate) fn new(model: &Model, scope: &Scope) -> Result<Self, Refusal> {
        let rank = model.rank;
        let (columns, delta) = inverse(scope, rank)?;
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
        // Rounding to nearest: each product once, each of r sums once, so at most gamma_(r+1) <= (r + 2) 2^-53 of the
        // magnitudes, and 2^-1075 for each product that underflows.
        let (gamma, least) = (Dyadic::new(rank as i64 + 2, -53), Dyadic::new(rank as i64 + 2, -1074));
        let error = |c: usize| &(&this.rest_errors[c] * &gamma) + &center_errors[c];
        this.rest_errors = std::array::from_fn(|c| &error(c).round_up(64) + &least);
        this.rate_errors = this.rate_errors.map(|x| (&x * &gamma).round_up(64));
        Ok(this)
    }

    /// The row of a vertex and a component.
    pub(crate) fn row(&self, vertex: u32, component: usize) -> &[Dyadic] {
        &self.modes[(3 * vertex as usize + component) * self.rank..][..self.rank]
    }

    /// A radius over z'.
    pub(crate) fn radius(&self, radius: f64) -> Radius {
        if radius.is_infinite() {
            return Radius::Infinite;
        }
        let radius = Dyadic::of(radius);
        // 1 / (1 - delta) <= 1 + 2 delta for delta <= 1/2.
        Radius::Finite((&radius + &(&radius * &self.delta.times_power(1))).round_up(128))
    }

    /// By how much the gap of two computed points along a direction may be smaller than the exact one: the first number, and
    /// the second times `|z'|`.
    pub(crate) fn errors(&self, dir: &Vector) -> [Dyadic; 2] {
        [&self.rest_errors, &self.rate_errors].map(|errors| {
            let sum: Dyadic = dir.iter().zip(errors).map(|(d, e)| &d.abs() * e).sum();
            sum.times_power(1)
        })
    }
}

/// A column of T: its entries that are not 0, with their rows.
type Column = Vec<(usize, Dyadic)>;

/// The columns of T, and delta.
fn inverse(scope: &Scope, rank: usize) -> Result<(Vec<Column>, Dyadic), Refusal> {
    let digits = DIGITS[usize::from(scope.is_dense)];
    let entry = |i: usize, j: usize| match scope.is_dense {
        true => Dyadic::of(scope.factor[i * rank + j]),
        false if i == j => Dyadic::of(scope.factor[i]),
        false => Dyadic::default(),
    };
    let first = |l: usize| if scope.is_dense { 0 } else { l };
    let (mut columns, mut error) = (Vec::new(), Dyadic::default());
    for l in 0..rank {
        // Back substitution: S t = e_l.
        let mut t = vec![Dyadic::default(); rank];
        for i in (first(l)..=l).rev() {
            let known: Dyadic = (i + 1..=l).map(|j| &entry(i, j) * &t[j]).sum();
            let wanted = &Dyadic::new(i64::from(i == l), 0) - &known;
            t[i] = wanted.divided_by(&entry(i, i), digits);
        }
        for i in first(l)..=l {
            let product: Dyadic = (i..=l).map(|j| &entry(i, j) * &t[j]).sum();
            error = &error + &(&product - &Dyadic::new(i64::from(i == l), 0)).square();
        }
        let column = t.into_iter().enumerate().filter(|(_, t)| !t.is_zero());
        columns.push(column.collect());
    }
    let delta = error.root_up();
    if delta > Dyadic::new(1, -20) { input("metric: it is nearly singular") } else { Ok((columns, delta)) }
}
