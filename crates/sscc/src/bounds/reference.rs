//! The paper's own bounds, kept to compare with: each in its safe form and, where that differs, as printed. And a
//! slow search for the true minimum. None of it is used outside tests.

use glam::{DMat3, DVec3};

use crate::intersect_triangle_triangle;

/// Small pseudo-random numbers (SplitMix64).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        let mut this = Self(seed.wrapping_mul(0xd1b5_4a32_d192_ed03));
        this.bits();
        this
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// In [0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In 0 .. n.
    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Each component in [-1, 1).
    pub(super) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.uniform(), self.uniform(), self.uniform()) * 2.0 - 1.0
    }

    /// `10^x` for x between the two exponents.
    pub(super) fn power(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * self.uniform())
    }

    fn weights(&mut self) -> DVec3 {
        normalised(DVec3::new(self.uniform(), self.uniform(), self.uniform()))
    }
}

/// Barycentric weights from any vector: negative ones become 0.
fn normalised(w: DVec3) -> DVec3 {
    let w = w.max(DVec3::ZERO);
    let sum = w.x + w.y + w.z;
    if sum > 0.0 { w / sum } else { DVec3::X }
}

/// Two triangles: corners 0 to 2 and 3 to 5, with their scaled modes.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub(super) p: [DVec3; 6],
    pub(super) a: [Vec<DVec3>; 6],
}

/// The Gram matrix `B B'` of modes given by columns.
fn gram(b: &[DVec3]) -> DMat3 {
    b.iter().fold(DMat3::ZERO, |g, b| g + DMat3::from_cols(*b * b.x, *b * b.y, *b * b.z))
}

fn trace(m: &DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}

fn length(z: &[f64]) -> f64 {
    z.iter().map(|z| z * z).sum::<f64>().sqrt()
}

fn difference(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| *a - *b).collect()
}

/// The singular values of a 3 x r matrix given by columns, greatest first: always three (Jacobi rotations of
/// its rows, which keep small values exact to their own size).
pub(super) fn singular_values(b: &[DVec3]) -> [f64; 3] {
    let mut rows: [Vec<f64>; 3] = std::array::from_fn(|c| b.iter().map(|b| b[c]).collect());
    for _ in 0..30 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            let (ii, jj, ij) = (dot(&rows[i], &rows[i]), dot(&rows[j], &rows[j]), dot(&rows[i], &rows[j]));
            if ij == 0.0 {
                continue;
            }
            let zeta = (jj - ii) / (2.0 * ij);
            let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let cos = 1.0 / (1.0 + t * t).sqrt();
            let sin = cos * t;
            for k in 0..b.len() {
                let (x, y) = (rows[i][k], rows[j][k]);
                rows[i][k] = cos * x - sin * y;
                rows[j][k] = sin * x + cos * y;
            }
        }
    }
    let mut values = rows.map(|r| length(&r));
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

impl Pair {
    pub(super) fn rank(&self) -> usize {
        self.a[0].len()
    }

    fn triangle(&self, side: usize) -> [DVec3; 3] {
        [self.p[3 * side], self.p[3 * side + 1], self.p[3 * side + 2]]
    }

    /// The mean modes `U^c` of one triangle (Eq. 7).
    fn mean(&self, side: usize) -> Vec<DVec3> {
        let [a, b, c] = [&self.a[3 * side], &self.a[3 * side + 1], &self.a[3 * side + 2]];
        (0..self.rank()).map(|k| (a[k] + b[k] + c[k]) / 3.0).collect()
    }

    /// `d` and the columns of `B` for two points given by barycentric weights.
    fn relative(&self, [wx, wy]: [DVec3; 2]) -> (DVec3, Vec<DVec3>) {
        let w = [-wx.x, -wx.y, -wx.z, wy.x, wy.y, wy.z];
        let d = self.p.iter().zip(w).map(|(p, w)| *p * w).sum();
        let column = |k: usize| self.a.iter().zip(w).map(|(a, w)| a[k] * w).sum();
        (d, (0..self.rank()).map(column).collect())
    }

    fn collides(&self, z: &[f64]) -> bool {
        let at = |v: usize| self.a[v].iter().zip(z).fold(self.p[v], |x, (a, z)| x + *a * *z);
        intersect_triangle_triangle(&[0, 1, 2].map(at), &[3, 4, 5].map(at))
    }

    /// The differences "point of Y minus point of X" at which vertex-face and edge-edge contacts can take
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

    /// The minimum `r_c` of the constant-mode problem, a norm (the paper's `R_c` is its square): the least of
    /// `Q` over all vertex-face and edge-edge pairs (Eqs. 7 to 9).
    ///
    /// A small multiple of the identity is added to the Gram matrix of Eq. 9: modes that do not reach all
    /// directions give a very large value, never more than the true one. 0 does **not** follow for triangles
    /// that pierce each other at rest: contacts of features alone do not show it.
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

    /// The bound of Eq. 11 for one triangle: how far its modes stray from their mean, as a 2-norm.
    fn stray(&self, side: usize) -> f64 {
        let mean = self.mean(side);
        let k: [f64; 3] =
            std::array::from_fn(|j| singular_values(&difference(&mean, &self.a[3 * side + j]))[0]);
        (k.iter().copied().fold(0.0, f64::max) + k.iter().sum::<f64>()) / 3.0
    }

    /// The quotient x of Eq. 10, for a given singular value.
    fn perturbation(&self, sigma: f64) -> f64 {
        (self.stray(0) + self.stray(1)) / sigma
    }

    fn mean_singular_values(&self) -> [f64; 3] {
        singular_values(&difference(&self.mean(1), &self.mean(0)))
    }

    /// Eq. 10 as Appendix A proves it: **norms**, the third singular value, the rest pose tested first.
    pub(super) fn eq10_safe(&self) -> f64 {
        let sigma = self.mean_singular_values()[2];
        if self.rank() < 3 || sigma <= 0.0 || self.collides(&vec![0.0; self.rank()]) {
            return 0.0;
        }
        self.constant_mode_minimum() / (1.0 + self.perturbation(sigma))
    }

    /// Eq. 10 as printed, with the squared `R_c` of the paper's section 5; the result is its root.
    pub(super) fn eq10_printed(&self) -> f64 {
        let r_c = self.constant_mode_minimum();
        (r_c * r_c / (1.0 + self.perturbation(self.mean_singular_values()[2]))).sqrt()
    }

    /// Eq. 10 with norms but without the test of the rest pose.
    pub(super) fn eq10_without_rest_test(&self) -> f64 {
        self.constant_mode_minimum() / (1.0 + self.perturbation(self.mean_singular_values()[2]))
    }

    /// Eq. 10 with norms and the last of the `min(3, r)` singular values that a usual decomposition returns.
    pub(super) fn eq10_last_singular_value(&self) -> f64 {
        let sigma = self.mean_singular_values()[self.rank().min(3) - 1];
        self.constant_mode_minimum() / (1.0 + self.perturbation(sigma))
    }

    /// The gap of the 1D estimate of section 5.2 (balls on the line between their centres) and the largest
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

    /// The 1D triangle estimate of section 5.2, one maximum per mode, combined.
    pub(super) fn line_estimate_safe(&self) -> f64 {
        let (gap, rates) = self.line_estimate();
        if gap > 0.0 { gap / length(&rates) } else { 0.0 }
    }

    /// The same as printed: the largest of all rates.
    pub(super) fn line_estimate_printed(&self) -> f64 {
        let (gap, rates) = self.line_estimate();
        if gap > 0.0 { gap / rates.into_iter().fold(0.0, f64::max) } else { 0.0 }
    }

    /// Searches the least `|z|` at which the two triangles meet. What it returns is an upper bound: that z
    /// brings two points together, to rounding, or the exact test found a collision at it.
    pub(super) fn true_minimum(&self, effort: usize, random: &mut Random) -> Option<f64> {
        let zero = vec![0.0; self.rank()];
        if self.collides(&zero) {
            return Some(0.0);
        }
        let by_points = self.closest_points(effort, random);
        by_points.into_iter().chain(self.along_rays(effort, random)).reduce(f64::min)
    }

    fn closest_points(&self, effort: usize, random: &mut Random) -> Option<f64> {
        let radius = |w: [DVec3; 2]| {
            let (d, b) = self.relative(w);
            let square = d.dot(gram(&b).inverse() * d);
            if square > 0.0 { square.sqrt() } else { f64::INFINITY }
        };
        let grid: Vec<DVec3> = (0..=effort)
            .flat_map(|i| (0..=effort - i).map(move |j| [i, j]))
            .map(|[i, j]| DVec3::new(i as f64, j as f64, (effort - i - j) as f64) / effort as f64)
            .collect();
        let mut best = (f64::INFINITY, [DVec3::X; 2]);
        for x in &grid {
            for y in &grid {
                let r = radius([*x, *y]);
                if r < best.0 {
                    best = (r, [*x, *y]);
                }
            }
        }
        let mut width = 1.0 / effort as f64;
        for _ in 0..60 * effort {
            let trial = best.1.map(|w| normalised(w + random.vector() * width));
            let r = radius(trial);
            if r < best.0 {
                best = (r, trial);
            } else {
                width = (width * 0.97).max(1e-9);
            }
        }
        self.meeting_point(best.1)
    }

    /// The least z that brings two points together, solved until it no longer changes; none where it does.
    fn meeting_point(&self, weights: [DVec3; 2]) -> Option<f64> {
        let (d, b) = self.relative(weights);
        let inverse = gram(&b).inverse();
        let mut z = vec![0.0; b.len()];
        let mut apart = d;
        for _ in 0..6 {
            let y = inverse * apart;
            z.iter_mut().zip(&b).for_each(|(z, b)| *z -= b.dot(y));
            apart = b.iter().zip(&z).fold(d, |x, (b, z)| x + *b * *z);
        }
        // How much z may still change to bring them together exactly.
        let sigma = singular_values(&b)[2];
        let reach = self.a.iter().flatten().map(|a| a.length()).fold(0.0, f64::max);
        let exact = sigma > 1e-13 * reach && apart.length() <= 1e-10 * sigma * length(&z);
        exact.then(|| length(&z))
    }

    /// Collisions found by the exact test along rays.
    fn along_rays(&self, effort: usize, random: &mut Random) -> Option<f64> {
        let rank = self.rank();
        let mut rays: Vec<Vec<f64>> = Vec::new();
        match rank {
            1 => rays.extend([vec![1.0], vec![-1.0]]),
            2 => rays.extend((0..12 * effort).map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / (12 * effort) as f64).sin_cos();
                vec![cos, sin]
            })),
            _ => {}
        }
        for _ in 0..2 * effort {
            let (d, b) = self.relative([random.weights(), random.weights()]);
            let ridge = DMat3::from_diagonal(DVec3::splat(random.power(-9.0, 0.0) * trace(&gram(&b))));
            let y = (gram(&b) + ridge).inverse() * d;
            rays.push(b.iter().map(|b| -b.dot(y)).collect());
        }
        let mut best = None;
        let (d, b) = self.relative([DVec3::ONE / 3.0; 2]);
        for ray in rays {
            let size = length(&ray);
            if !(size > 0.0 && size.is_finite()) {
                continue;
            }
            let at = |t: f64| ray.iter().map(|z| z / size * t).collect::<Vec<f64>>();
            let rate = b.iter().zip(&ray).map(|(b, z)| *b * *z).sum::<DVec3>().dot(d) / size;
            let speed =
                |a: &Vec<DVec3>| a.iter().zip(&ray).map(|(a, z)| *a * *z).sum::<DVec3>().length() / size;
            let fastest = self.a.iter().map(speed).fold(0.0, f64::max);
            let guess = if rate < 0.0 { -d.length_squared() / rate } else { d.length() / fastest };
            let steps = 12 * effort;
            let Some(hit) = (1..=steps).find(|i| self.collides(&at(guess * 2.0 * *i as f64 / steps as f64)))
            else {
                continue;
            };
            let step = guess * 2.0 / steps as f64;
            let (mut free, mut met) = (step * (hit - 1) as f64, step * hit as f64);
            for _ in 0..45 {
                let middle = 0.5 * (free + met);
                if self.collides(&at(middle)) { met = middle } else { free = middle }
            }
            best = Some(best.map_or(met, |b: f64| b.min(met)));
        }
        best
    }

    /// The least rest distance found between points of the two triangles.
    pub(super) fn rest_distance(&self, effort: usize, random: &mut Random) -> f64 {
        let steps = Self {
            p: self.p,
            a: std::array::from_fn(|v| {
                let s = if v < 3 { 0.0 } else { 1.0 };
                DVec3::AXES.map(|axis| axis * s).to_vec()
            }),
        };
        steps.closest_points(effort, random).unwrap_or(f64::INFINITY)
    }
}

/// The least of `d' metric d` over a triangle of differences d.
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

/// The smallest ball around a triangle, as centre and radius.
fn enclosing_ball(p: [DVec3; 3]) -> (DVec3, f64) {
    let radius = |c: DVec3| p.iter().map(|p| p.distance(c)).fold(0.0, f64::max);
    let mut centres = vec![(p[0] + p[1]) / 2.0, (p[1] + p[2]) / 2.0, (p[2] + p[0]) / 2.0];
    let (u, v) = (p[1] - p[0], p[2] - p[0]);
    let normal = u.cross(v);
    let round = (normal.cross(u) * v.length_squared() + v.cross(normal) * u.length_squared())
        / (2.0 * normal.length_squared());
    if round.is_finite() {
        centres.push(p[0] + round);
    }
    let best = centres.into_iter().min_by(|a, b| radius(*a).total_cmp(&radius(*b))).unwrap_or(p[0]);
    (best, radius(best) * (1.0 + 1e-14))
}

/// A BD-tree box (James and Pai 2004): rest interval and, for each mode, how its centre moves and it grows.
struct MovingBox {
    centre: DVec3,
    half: DVec3,
    rates: Vec<(DVec3, DVec3)>,
}

fn moving_box(p: &[DVec3], a: &[&[DVec3]]) -> MovingBox {
    let range = |points: &mut dyn Iterator<Item = DVec3>| {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lower, upper) = points.fold(empty, |(l, u), x| (l.min(x), u.max(x)));
        ((lower + upper) / 2.0, (upper - lower) / 2.0)
    };
    let (centre, half) = range(&mut p.iter().copied());
    let rates = (0..a[0].len()).map(|k| range(&mut a.iter().map(|a| a[k]))).collect();
    MovingBox { centre, half, rates }
}

/// For each axis the gap of two BD-tree boxes and the rate at which each mode can close it.
fn box_gaps(x: &MovingBox, y: &MovingBox) -> [(f64, Vec<f64>); 3] {
    std::array::from_fn(|c| {
        let gap = (y.centre - x.centre)[c].abs() - x.half[c] - y.half[c];
        let rate = |(x, y): (&(DVec3, DVec3), &(DVec3, DVec3))| (y.0 - x.0)[c].abs() + x.1[c] + y.1[c];
        (gap, x.rates.iter().zip(&y.rates).map(rate).collect())
    })
}

impl Pair {
    fn boxes(&self) -> [(f64, Vec<f64>); 3] {
        let side = |i: usize| {
            let a = [&self.a[3 * i][..], &self.a[3 * i + 1], &self.a[3 * i + 2]];
            moving_box(&self.triangle(i), &a)
        };
        box_gaps(&side(0), &side(1))
    }

    /// The AABB-AABB estimate of section 5.2 with all modes together: the best of the three axes.
    pub(super) fn box_estimate_safe(&self) -> f64 {
        let bound = |(gap, rates): (f64, Vec<f64>)| if gap > 0.0 { gap / length(&rates) } else { 0.0 };
        self.boxes().map(bound).into_iter().fold(0.0, f64::max)
    }

    /// The same as printed: on each axis the mode that closes the gap soonest, alone.
    pub(super) fn box_estimate_printed(&self) -> f64 {
        let bound = |(gap, rates): (f64, Vec<f64>)| {
            if gap > 0.0 { gap / rates.into_iter().fold(0.0, f64::max) } else { 0.0 }
        };
        self.boxes().map(bound).into_iter().fold(0.0, f64::max)
    }
}
