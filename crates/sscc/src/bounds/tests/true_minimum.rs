//! The oracle: a slow search of the smallest `|z|` at which two triangles meet.

use glam::{DMat3, DVec3};

use super::random::{Random, normalize};
use crate::intersect_triangle_triangle;

/// Two triangles: corners 0 to 2 and 3 to 5, with their scaled modes.
#[derive(Clone, Debug)]
pub(super) struct OraclePair {
    pub(super) p: [DVec3; 6],
    pub(super) a: [Vec<DVec3>; 6],
}

/// Returns the Gram matrix `B B'` of modes given by columns.
pub(super) fn gram(b: &[DVec3]) -> DMat3 {
    b.iter().fold(DMat3::ZERO, |g, b| g + DMat3::from_cols(*b * b.x, *b * b.y, *b * b.z))
}

pub(super) fn trace(m: &DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}

pub(super) fn length(z: &[f64]) -> f64 {
    z.iter().map(|z| z * z).sum::<f64>().sqrt()
}

pub(super) fn difference(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| *a - *b).collect()
}

/// Returns the singular values of a 3 x r matrix given by columns, greatest first: always three (Jacobi rotations of
/// its rows, which keep the relative precision of small values).
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

impl OraclePair {
    pub(super) fn rank(&self) -> usize {
        self.a[0].len()
    }

    pub(super) fn triangle(&self, side: usize) -> [DVec3; 3] {
        [self.p[3 * side], self.p[3 * side + 1], self.p[3 * side + 2]]
    }

    /// Returns `d` and the columns of `B` for two points given by barycentric weights.
    pub(super) fn relative(&self, [wx, wy]: [DVec3; 2]) -> (DVec3, Vec<DVec3>) {
        let w = [-wx.x, -wx.y, -wx.z, wy.x, wy.y, wy.z];
        let d = self.p.iter().zip(w).map(|(p, w)| *p * w).sum();
        let column = |k: usize| self.a.iter().zip(w).map(|(a, w)| a[k] * w).sum();
        (d, (0..self.rank()).map(column).collect())
    }

    pub(super) fn collides(&self, z: &[f64]) -> bool {
        let at = |v: usize| self.a[v].iter().zip(z).fold(self.p[v], |x, (a, z)| x + *a * *z);
        intersect_triangle_triangle(&[0, 1, 2].map(at), &[3, 4, 5].map(at))
    }

    /// Searches for the smallest `|z|` at which the two triangles meet. The result is an upper bound: at that z two
    /// points coincide up to rounding, or the exact test finds a collision.
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
            let trial = best.1.map(|w| normalize(w + random.vector() * width));
            let r = radius(trial);
            if r < best.0 {
                best = (r, trial);
            } else {
                width = (width * 0.97).max(1e-9);
            }
        }
        self.meeting_point(best.1)
    }

    /// Returns the norm of the smallest z that brings two points together, found by iteration. None if the iteration does not
    /// converge.
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
        // Accepts z only if a small change of it brings the points together exactly.
        let sigma = singular_values(&b)[2];
        let reach = self.a.iter().flatten().map(|a| a.length()).fold(0.0, f64::max);
        let exact = sigma > 1e-13 * reach && apart.length() <= 1e-10 * sigma * length(&z);
        exact.then(|| length(&z))
    }

    /// Returns the smallest norm of a collision that the exact test finds along rays.
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

    /// Returns the smallest rest distance found between points of the two triangles.
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
