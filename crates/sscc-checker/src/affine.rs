//! Affine witnesses of two triangles that are near each other and move almost together.
//!
//! For any affine map G of the modes, `A_j - A_i = G d_ij + E_ij` at the corners, and so for all points of the two triangles,
//! with convex combinations of E. Let d be the difference of two points at the centre and `u = d / |d|`. The component along u
//! of their difference at z is at least
//!
//! ```text
//! |d| - (g |d| + e) |z|,    g >= |u'G(.)u| for all u in the cone of the d,   e >= |E_ij|
//! ```
//!
//! and `|d|` is at least delta, the smallest gap of the corners along a direction n divided by `|n|`. So the two triangles are
//! separate if `delta - e0 - (g delta + e + e1) |z|` is positive, with the rounding e0 and e1 of computed positions along u.
//!
//! The cone is given by four directions: a pyramid that contains all differences of corners, and so of points. On the cone of
//! three directions `|u'G u| / |u|^2` is at most the largest quotient `|c_ij| / u_i.u_j`, with `c_ij` the symmetric
//! part of `u_i'G u_j`. If that is more than g, the cone is halved.

use crate::dyadic::{Dyadic, Vector, cross, dot, minus, squared_norm};
use crate::points::{Radius, Triangle, differences, position, squared_residual, stays_open, sum};
use crate::scaled::ScaledModel;

/// The number of cones of a witness from which on no cone is halved.
const MAX_CONES: usize = 1024;
/// The largest number of times that a cone is halved, because each halving makes numbers longer.
const MAX_DEPTH: usize = 64;

/// The six symmetric parts of a matrix: the entries of its diagonal, and the sums of two entries beside it.
const PARTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)];

/// An affine map: nine rows, with `G_cj` at `3 c + j`, and for each of its symmetric parts the products with itself and, twice, with those
/// that follow.
pub(crate) struct AffineMap {
    gradient: Vec<Dyadic>,
    products: [Vec<Dyadic>; 6],
}

impl AffineMap {
    pub(crate) fn new(gradient: Vec<Dyadic>) -> Self {
        let rows: Vec<&[Dyadic]> = gradient.chunks(gradient.len() / 9).collect();
        let parts = PARTS.map(|(c, j)| match c == j {
            true => rows[4 * c].to_vec(),
            false => sum(rows[3 * c + j], rows[3 * j + c]),
        });
        let product = |i: usize, j: usize| dot(&parts[i], &parts[j]).times_power(i64::from(j > i));
        let products = std::array::from_fn(|i| (i..6).map(|j| product(i, j)).collect());
        Self { gradient, products }
    }

    /// Whether the map, a direction, a rate and a pyramid prove that two triangles are separate below a radius.
    pub(crate) fn separates(
        &self,
        model: &ScaledModel,
        [x, y]: [Triangle<'_>; 2],
        dir: &Vector,
        rate: &Dyadic,
        pyramid: &[Vector; 4],
        radius: &Radius,
    ) -> bool {
        let differences = differences(x, y);
        let offsets: Vec<Vector> = differences.iter().map(|d| position(d)).collect();
        if *rate < Dyadic::default() || !is_inside(pyramid, &offsets) {
            return false;
        }
        let [u0, u1, u2, u3] = pyramid;
        let mut cones = 0;
        let mut holds = |cone| self.holds(cone, &rate.square(), &mut cones, 0);
        if !holds([u0, u1, u2]) || !holds([u0, u2, u3]) {
            return false;
        }
        let smaller = |a: Dyadic, b: Dyadic| if b < a { b } else { a };
        let gap = offsets.iter().map(|d| dot(dir, d)).reduce(smaller).unwrap_or_default();
        // The largest squared residual of the nine pairs of corners.
        let rows: Vec<&[Dyadic]> = self.gradient.chunks(model.rank).collect();
        let mut residual = Dyadic::default();
        for d in &differences {
            let of_axis = |c: usize| squared_residual(d, c, [rows[3 * c], rows[3 * c + 1], rows[3 * c + 2]]);
            residual.raise((0..3).map(of_axis).sum());
        }
        // The inequality for a unit direction, times the length of `dir`. Rounding errors along a unit direction are
        // bounded by those along a vector of ones, because its components are at most 1.
        let length = squared_norm(dir).root_up();
        let [rest_error, rate_error] = model.errors(&std::array::from_fn(|_| Dyadic::new(1, 0)));
        let closing = &(&gap * rate) + &(&length * &(&residual.root_up() + &rate_error));
        stays_open(&(&gap - &(&length * &rest_error)), &closing, &Dyadic::default(), radius)
    }

    /// Whether the rate holds on the cone of three directions, which is halved as often as necessary, within the
    /// limits.
    fn holds(&self, cone: [&Vector; 3], squared_rate: &Dyadic, cones: &mut usize, depth: usize) -> bool {
        *cones += 1;
        let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
        let is_slow = |&(i, j): &(usize, usize)| {
            let cosine = dot(cone[i], cone[j]);
            cosine.is_positive() && squared_rate * &cosine.square() >= self.squared_form(cone[i], cone[j])
        };
        // If the rate does not hold for one of the three directions, halving would not help: one of the halves contains it.
        if !pairs[..3].iter().all(is_slow) {
            return false;
        }
        let are_slow = pairs[3..].iter().all(is_slow);
        if are_slow || *cones >= MAX_CONES || depth >= MAX_DEPTH {
            return are_slow;
        }
        let length = |(i, j): (usize, usize)| squared_norm(&minus(cone[i], cone[j]));
        let longest = |l, e: &(usize, usize)| if length(*e) > length(l) { *e } else { l };
        let (u, v) = pairs[4..].iter().fold(pairs[3], longest);
        let [u, v, w] = [u, v, 3 - u - v].map(|i| cone[i]);
        let middle: Vector = std::array::from_fn(|c| (&u[c] + &v[c]).times_power(-1));
        let halves = [[u, &middle, w], [&middle, v, w]];
        halves.into_iter().all(|half| self.holds(half, squared_rate, cones, depth + 1))
    }

    /// Returns `|c|^2` with `c` the symmetric part of `u'G v`, one number for each mode.
    fn squared_form(&self, u: &Vector, v: &Vector) -> Dyadic {
        let part = |(c, j): (usize, usize)| (&(&u[c] * &v[j]) + &(&u[j] * &v[c])).times_power(-1);
        let parts = PARTS.map(part);
        (0..6).map(|i| &parts[i] * &dot(&self.products[i], &parts[i..])).sum()
    }
}

/// Whether the cones of the directions 0, 1, 2 and 0, 2, 3 of a pyramid contain all these vectors: both cones have the same
/// orientation, and each vector is on the inner side of the four planes. Its side of the plane through 0 and 2 then determines
/// which of the two cones contains it.
fn is_inside(pyramid: &[Vector; 4], vectors: &[Vector]) -> bool {
    let [u0, u1, u2, u3] = pyramid;
    let turns = |u: &Vector, v: &Vector, w: &Vector| dot(&cross(u, v), w).is_positive();
    let planes = [cross(u0, u1), cross(u1, u2), cross(u2, u3), cross(u3, u0)];
    let is_inner = |v: &Vector| planes.iter().all(|plane| dot(plane, v) >= Dyadic::default());
    turns(u0, u1, u2) && turns(u0, u2, u3) && vectors.iter().all(is_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns whole numbers from -4 to 4.
    fn numbers<const N: usize>(state: &mut u64) -> [Dyadic; N] {
        std::array::from_fn(|_| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            Dyadic::new((*state >> 40) as i64 % 9 - 4, 0)
        })
    }

    /// The form is the squared norm, over the modes, of the symmetric parts of `u'G v`.
    #[test]
    fn forms_are_those_of_the_nine_rows() {
        let state = &mut 5;
        for rank in [1, 2, 7] {
            for _ in 0..50 {
                let gradient: Vec<Dyadic> = (0..9 * rank).flat_map(|_| numbers::<1>(state)).collect();
                let [u, v]: [Vector; 2] = [numbers(state), numbers(state)];
                let twice = |k: usize| -> Dyadic {
                    let entry = |c: usize, j: usize| &gradient[(3 * c + j) * rank + k];
                    let of = |c: usize, j: usize| entry(c, j) * &(&(&u[c] * &v[j]) + &(&v[c] * &u[j]));
                    (0..9).map(|e| of(e / 3, e % 3)).sum()
                };
                let expected: Dyadic = (0..rank).map(|k| twice(k).square()).sum();
                let found = AffineMap::new(gradient.clone()).squared_form(&u, &v);
                assert_eq!(found.times_power(2), expected);
            }
        }
    }
}
