//! The closest collision of two triangles that a search can find: an upper bound of the true radius.

use glam::{DMat3, DVec3};

use super::random::Random;
use crate::filter::PairFilter;
use crate::model::ScaledModel;
use crate::{Pair, ReducedModel, Scope};

/// A configuration at which two points of two triangles meet, up to rounding.
///
/// Triangles that close up within their surface touch at that q alone and miss each other beyond it, so the exact
/// test may not see it. It is an upper bound of the true radius all the same; only a collision that the
/// exact test confirms at a smaller norm than a radius proves that radius wrong.
#[derive(Clone, Debug)]
pub(super) struct Collision {
    pub(super) faces: Pair,
    pub(super) q: Vec<f64>,
    /// `|S (q - center)|`, rounded up.
    pub(super) norm: f64,
    /// A q near it at which the computed positions collide by the exact test, with its norm.
    pub(super) confirmed: Option<(f64, Vec<f64>)>,
}

/// Barycentric grid: this many steps along each edge.
const GRID: usize = 6;

/// Triangles that meet in one point alone are looked at beyond it, too: the exact test may not see them before ...
const FACTORS: [f64; 5] = [1.0, 1.0 + 1e-12, 1.0 + 1e-9, 1.0 + 1e-6, 1.001];

/// ... and where points meet that lie so much towards the centroids.
const INWARDS: [f64; 6] = [0.0, 1e-6, 1e-3, 0.01, 0.05, 0.2];

/// Steps of the local search.
const STEPS: usize = 400;

/// What is known of the certificates under attack.
#[derive(Clone, Copy)]
pub(super) struct Minimum<'a> {
    pub(super) model: &'a ReducedModel,
    pub(super) scope: &'a Scope,
    pub(super) scaled: &'a ScaledModel,
    pub(super) filter: &'a PairFilter,
}

impl Minimum<'_> {
    /// Searches the smallest `|z|` at which two triangles collide: over point pairs, whose smallest z is known in
    /// closed form, on a grid and then by random steps; where modes cannot move points in all directions, along
    /// rays.
    pub(super) fn search(&self, faces: Pair, random: &mut Random) -> Option<Collision> {
        let found = self
            .filter
            .hulls(faces.0, faces.1)
            .filter_map(|(x, y)| self.of_hulls(faces, &PointPairs { scaled: self.scaled, x, y }, random));
        found.reduce(|a, b| if b.norm < a.norm { b } else { a })
    }

    /// A way from the centre on which random points of two triangles meet; none where they are no pair, or modes do not
    /// bring them together.
    pub(super) fn approach(&self, faces: Pair, random: &mut Random) -> Option<Vec<f64>> {
        let (x, y) = self.filter.hulls(faces.0, faces.1).next()?;
        let z = PointPairs { scaled: self.scaled, x, y }.solution(random_weights(random));
        let moves = z.iter().any(|z| *z != 0.0);
        moves.then(|| self.scope.metric.unscaled(&z[..self.model.rank()]))
    }

    fn of_hulls(&self, faces: Pair, pair: &PointPairs<'_>, random: &mut Random) -> Option<Collision> {
        let mut best = (f64::INFINITY, [DVec3::X; 2]);
        for x in grid() {
            for y in grid() {
                let radius = pair.radius([x, y]);
                if radius < best.0 {
                    best = (radius, [x, y]);
                }
            }
        }
        let mut width = 1.0 / GRID as f64;
        for _ in 0..if best.0.is_finite() { STEPS } else { 0 } {
            let mut step = |w: DVec3| {
                let moved = w + DVec3::new(random.normal(), random.normal(), random.normal()) * width;
                let clamped = moved.max(DVec3::ZERO);
                clamped / (clamped.x + clamped.y + clamped.z).max(f64::MIN_POSITIVE)
            };
            let trial = best.1.map(&mut step);
            let radius = pair.radius(trial);
            if radius < best.0 {
                best = (radius, trial);
            } else {
                width = (width * 0.98).max(1e-9);
            }
        }
        if !best.0.is_finite() {
            return self.along_rays(faces, pair, random);
        }
        // Points well inside both triangles, when they meet, let the triangles cross.
        let inwards = |share: f64| best.1.map(|w| w * (1.0 - share) + DVec3::splat(share / 3.0));
        let at = |share: f64, factor: f64| {
            self.scope.at(&pair.solution(inwards(share))[..self.model.rank()], factor)
        };
        let tries = INWARDS.into_iter().flat_map(|share| FACTORS.map(|factor| at(share, factor)));
        let confirmed = tries
            .filter(|q| self.collides(faces, q))
            .map(|q| (self.scope.norm(&q), q))
            .reduce(|a, b| if b.0 < a.0 { b } else { a });
        let q = at(0.0, 1.0);
        Some(Collision { faces, norm: self.scope.norm(&q), q, confirmed })
    }

    /// Whether two triangles collide at q, on the computed positions.
    pub(super) fn collides(&self, faces: Pair, q: &[f64]) -> bool {
        let corners = |face: u32| self.model.mesh().faces()[face as usize].map(|v| self.model.position(v, q));
        self.model.check_coordinates(q).is_ok()
            && self.filter.collide(faces, &corners(faces.0), &corners(faces.1))
    }

    /// Looks for collisions along rays: along each mode, and along the ways in which points of the pair approach.
    fn along_rays(&self, faces: Pair, pair: &PointPairs<'_>, random: &mut Random) -> Option<Collision> {
        let rank = self.model.rank();
        let mut rays: Vec<Vec<f64>> = Vec::new();
        for k in 0..rank.min(8) {
            for sign in [1.0, -1.0] {
                rays.push((0..rank).map(|j| if j == k { sign } else { 0.0 }).collect());
            }
        }
        for _ in 0..24 {
            let (d, b) = pair.relative(random_weights(random));
            rays.push((0..rank).map(|k| -b[k].dot(d)).collect());
        }
        let mut best: Option<Collision> = None;
        for ray in rays {
            let length = ray.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            // The gap closes at about this |z|, if ever; look on both sides of it.
            let (d, b) = pair.relative([DVec3::ONE / 3.0; 2]);
            let rate: f64 = (0..rank).map(|k| b[k].dot(d) * ray[k]).sum::<f64>() / length;
            let guess = if rate < 0.0 { -d.length_squared() / rate } else { continue };
            for step in 1..200 {
                let t = guess * f64::from(step) * 0.02;
                let q = self.scope.at(&ray, t / length);
                if self.collides(faces, &q) {
                    let norm = self.scope.norm(&q);
                    if best.as_ref().is_none_or(|b| norm < b.norm) {
                        best = Some(Collision { faces, confirmed: Some((norm, q.clone())), q, norm });
                    }
                    break;
                }
            }
        }
        best
    }
}

/// Points of two triangles, given by barycentric weights.
struct PointPairs<'a> {
    scaled: &'a ScaledModel,
    x: [u32; 3],
    y: [u32; 3],
}

impl PointPairs<'_> {
    /// `d` and the columns of `B` for the pair of points with the given weights.
    fn relative(&self, [wx, wy]: [DVec3; 2]) -> (DVec3, Vec<DVec3>) {
        let row = self.scaled.row;
        let mut d = DVec3::ZERO;
        let mut b = vec![DVec3::ZERO; row];
        for (corners, weights, sign) in [(self.x, wx, -1.0), (self.y, wy, 1.0)] {
            for (&v, w) in corners.iter().zip(weights.to_array()) {
                let modes = self.scaled.modes(v);
                d += self.scaled.positions[v as usize] * (w * sign);
                for (k, b) in b.iter_mut().enumerate() {
                    *b += DVec3::new(modes[k], modes[row + k], modes[2 * row + k]) * (w * sign);
                }
            }
        }
        (d, b)
    }

    /// `(B B')^-1 d`, where B has full rank.
    fn multiplier(d: DVec3, b: &[DVec3]) -> Option<DVec3> {
        let mut gram = DMat3::ZERO;
        for b in b {
            gram += DMat3::from_cols(*b * b.x, *b * b.y, *b * b.z);
        }
        let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        (gram.determinant() > 1e-15 * trace * trace * trace).then(|| gram.inverse() * d)
    }

    /// The smallest `|z|` that brings the two points together; infinite where modes do not reach.
    fn radius(&self, weights: [DVec3; 2]) -> f64 {
        let (d, b) = self.relative(weights);
        Self::multiplier(d, &b).map_or(f64::INFINITY, |y| d.dot(y).max(0.0).sqrt())
    }

    /// That z.
    fn solution(&self, weights: [DVec3; 2]) -> Vec<f64> {
        let (d, b) = self.relative(weights);
        let y = Self::multiplier(d, &b).unwrap_or(DVec3::ZERO);
        b.iter().map(|b| -b.dot(y)).collect()
    }
}

/// Random barycentric weights of a point in each of two triangles.
fn random_weights(random: &mut Random) -> [DVec3; 2] {
    [(); 2].map(|()| {
        let w = DVec3::new(random.uniform(), random.uniform(), random.uniform());
        w / (w.x + w.y + w.z).max(f64::MIN_POSITIVE)
    })
}

/// Barycentric weights on a regular grid.
fn grid() -> impl Iterator<Item = DVec3> {
    (0..=GRID).flat_map(|i| {
        (0..=GRID - i).map(move |j| DVec3::new(i as f64, j as f64, (GRID - i - j) as f64) / GRID as f64)
    })
}
