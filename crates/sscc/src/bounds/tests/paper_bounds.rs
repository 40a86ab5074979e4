//! The paper's own bounds of section 5, for comparison: each in its conservative form and, where that differs, as printed.

use glam::{DMat3, DVec3};

use super::true_minimum::{OraclePair, difference, gram, length, singular_values, trace};

impl OraclePair {
    /// Returns the mean modes `U^c` of one triangle (Eq. 7).
    fn mean(&self, side: usize) -> Vec<DVec3> {
        let [a, b, c] = [&self.a[3 * side], &self.a[3 * side + 1], &self.a[3 * side + 2]];
        (0..self.rank()).map(|k| (a[k] + b[k] + c[k]) / 3.0).collect()
    }

    /// Returns the differences "point of Y minus point of X" at which vertex-face and edge-edge contacts can take
    /// place, as triangles.
    fn contact_facets(&self) -> Vec<[DVec3; 3]> {
        let [x, y] = [self.triangle(0), self.triangle(1)];
        let mut facets = Vec::new();
        for i in 0..3 {
            facets.push(y.map(|y| y - x[i]));
            facets.push(x.map(|x| y[i] - x));
            for j in 0..3 {
                let (x0, x1, y0, y1) = (x[i], x[(i + 1) % 3], y[j], y[(j + 1) % 3]);
                facets.push([y0 - x0, y1 - x0, y0 - x1]);
                facets.push([y1 - x1, y1 - x0, y0 - x1]);
            }
        }
        facets
    }

    /// Returns the minimum `r_c` of the constant-mode problem, a norm (the paper's `R_c` is its square): the least of
    /// `Q` over all vertex-face and edge-edge pairs (Eqs. 7 to 9).
    ///
    /// A small multiple of the identity is added to the Gram matrix of Eq. 9: modes that do not reach all
    /// directions give a very large value, never more than the true one. The result is **not** always 0 for triangles
    /// that pierce each other at rest: contacts of features alone do not show this.
    pub(super) fn constant_mode_minimum(&self) -> f64 {
        let g = gram(&difference(&self.mean(1), &self.mean(0)));
        let trace = trace(&g);
        if trace == 0.0 {
            return f64::INFINITY;
        }
        let metric = (g + DMat3::from_diagonal(DVec3::splat(1e-14 * trace))).inverse();
        let squares = self.contact_facets().into_iter().map(|f| least_square(&metric, &f));
        squares.fold(f64::INFINITY, f64::min).max(0.0).sqrt()
    }

    /// Returns the bound of Eq. 11 for one triangle: the distance of its modes from their mean, as a 2-norm.
    fn stray(&self, side: usize) -> f64 {
        let mean = self.mean(side);
        let k: [f64; 3] =
            std::array::from_fn(|j| singular_values(&difference(&mean, &self.a[3 * side + j]))[0]);
        (k.iter().copied().fold(0.0, f64::max) + k.iter().sum::<f64>()) / 3.0
    }

    /// Returns the quotient x of Eq. 10, for a given singular value.
    fn perturbation(&self, sigma: f64) -> f64 {
        (self.stray(0) + self.stray(1)) / sigma
    }

    fn mean_singular_values(&self) -> [f64; 3] {
        singular_values(&difference(&self.mean(1), &self.mean(0)))
    }

    /// Returns Eq. 10 as Appendix A proves it: with **norms** and the third singular value, after a test of the rest pose.
    pub(super) fn eq10_safe(&self) -> f64 {
        let sigma = self.mean_singular_values()[2];
        if self.rank() < 3 || sigma <= 0.0 || self.collides(&vec![0.0; self.rank()]) {
            return 0.0;
        }
        self.constant_mode_minimum() / (1.0 + self.perturbation(sigma))
    }

    /// Returns Eq. 10 as printed, with the squared `R_c` of the paper's section 5; the result is its root.
    pub(super) fn eq10_printed(&self) -> f64 {
        let r_c = self.constant_mode_minimum();
        (r_c * r_c / (1.0 + self.perturbation(self.mean_singular_values()[2]))).sqrt()
    }

    /// Returns Eq. 10 with norms but without the test of the rest pose.
    pub(super) fn eq10_without_rest_test(&self) -> f64 {
        self.constant_mode_minimum() / (1.0 + self.perturbation(self.mean_singular_values()[2]))
    }

    /// Returns Eq. 10 with norms and the last of the `min(3, r)` singular values that a usual decomposition returns.
    pub(super) fn eq10_last_singular_value(&self) -> f64 {
        let sigma = self.mean_singular_values()[self.rank().min(3) - 1];
        self.constant_mode_minimum() / (1.0 + self.perturbation(sigma))
    }

    /// Returns the gap of the 1D estimate of section 5.2 (balls on the line between their centres) and the largest
    /// relative motion of each mode along that line.
    fn line_estimate(&self) -> (f64, Vec<f64>) {
        let [(cx, rx), (cy, ry)] = [enclosing_ball(self.triangle(0)), enclosing_ball(self.triangle(1))];
        let n = (cy - cx).normalize_or_zero();
        let rate = |k: usize| {
            let corners = (0..9).map(|i| n.dot(self.a[3 + i % 3][k] - self.a[i / 3][k]).abs());
            corners.fold(0.0, f64::max)
        };
        ((cy - cx).length() - rx - ry, (0..self.rank()).map(rate).collect())
    }

    /// Returns the 1D triangle estimate of section 5.2, in which the largest rates of all modes are combined.
    pub(super) fn line_estimate_safe(&self) -> f64 {
        let (gap, rates) = self.line_estimate();
        if gap > 0.0 { gap / length(&rates) } else { 0.0 }
    }

    /// Returns the 1D triangle estimate as printed, which uses the largest of all rates alone.
    pub(super) fn line_estimate_printed(&self) -> f64 {
        let (gap, rates) = self.line_estimate();
        if gap > 0.0 { gap / rates.into_iter().fold(0.0, f64::max) } else { 0.0 }
    }
}

/// Returns the least of `d' metric d` over a triangle of differences d.
fn least_square(metric: &DMat3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let form = |x: DVec3, y: DVec3| x.dot(*metric * y);
    let mut least = f64::INFINITY;
    for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
        let edge = q - p;
        let t = (-form(p, edge) / form(edge, edge)).clamp(0.0, 1.0);
        let x = if t.is_finite() { p + edge * t } else { p };
        least = least.min(form(x, x));
    }
    let (u, v) = (*b - *a, *c - *a);
    let (uu, uv, vv) = (form(u, u), form(u, v), form(v, v));
    let (au, av) = (form(*a, u), form(*a, v));
    let det = uu * vv - uv * uv;
    let (s, t) = ((uv * av - vv * au) / det, (uv * au - uu * av) / det);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        let x = *a + u * s + v * t;
        least = least.min(form(x, x));
    }
    least
}

/// Returns the smallest ball around a triangle, as centre and radius.
fn enclosing_ball(p: [DVec3; 3]) -> (DVec3, f64) {
    let radius = |c: DVec3| p.iter().map(|p| p.distance(c)).fold(0.0, f64::max);
    let mut centers = vec![(p[0] + p[1]) / 2.0, (p[1] + p[2]) / 2.0, (p[2] + p[0]) / 2.0];
    let (u, v) = (p[1] - p[0], p[2] - p[0]);
    let normal = u.cross(v);
    let round = (normal.cross(u) * v.length_squared() + v.cross(normal) * u.length_squared())
        / (2.0 * normal.length_squared());
    if round.is_finite() {
        centers.push(p[0] + round);
    }
    let best = centers.into_iter().min_by(|a, b| radius(*a).total_cmp(&radius(*b))).unwrap_or(p[0]);
    (best, radius(best) * (1.0 + 1e-14))
}

/// A BD-tree AABB (James and Pai 2004): its rest interval and, for each mode, the rates at which its centre moves and
/// its half extents grow.
struct MovingBox {
    center: DVec3,
    half: DVec3,
    rates: Vec<(DVec3, DVec3)>,
}

fn moving_box(p: &[DVec3], a: &[&[DVec3]]) -> MovingBox {
    let range = |points: &mut dyn Iterator<Item = DVec3>| {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lower, upper) = points.fold(empty, |(l, u), x| (l.min(x), u.max(x)));
        ((lower + upper) / 2.0, (upper - lower) / 2.0)
    };
    let (center, half) = range(&mut p.iter().copied());
    let rates = (0..a[0].len()).map(|k| range(&mut a.iter().map(|a| a[k]))).collect();
    MovingBox { center, half, rates }
}

/// Returns for each axis the gap of two BD-tree AABBs and the rate at which each mode can close it.
fn box_gaps(x: &MovingBox, y: &MovingBox) -> [(f64, Vec<f64>); 3] {
    std::array::from_fn(|c| {
        let gap = (y.center - x.center)[c].abs() - x.half[c] - y.half[c];
        let rate = |(x, y): (&(DVec3, DVec3), &(DVec3, DVec3))| (y.0 - x.0)[c].abs() + x.1[c] + y.1[c];
        (gap, x.rates.iter().zip(&y.rates).map(rate).collect())
    })
}

impl OraclePair {
    fn boxes(&self) -> [(f64, Vec<f64>); 3] {
        let side = |i: usize| {
            let a = [&self.a[3 * i][..], &self.a[3 * i + 1], &self.a[3 * i + 2]];
            moving_box(&self.triangle(i), &a)
        };
        box_gaps(&side(0), &side(1))
    }

    /// Returns the AABB-AABB estimate of section 5.2 with all modes together: the best of the three axes.
    pub(super) fn box_estimate_safe(&self) -> f64 {
        let bound = |(gap, rates): (f64, Vec<f64>)| if gap > 0.0 { gap / length(&rates) } else { 0.0 };
        self.boxes().map(bound).into_iter().fold(0.0, f64::max)
    }

    /// Returns the AABB-AABB estimate as printed, which uses on each axis only the mode that closes the gap soonest.
    pub(super) fn box_estimate_printed(&self) -> f64 {
        let bound = |(gap, rates): (f64, Vec<f64>)| {
            if gap > 0.0 { gap / rates.into_iter().fold(0.0, f64::max) } else { 0.0 }
        };
        self.boxes().map(bound).into_iter().fold(0.0, f64::max)
    }
}
