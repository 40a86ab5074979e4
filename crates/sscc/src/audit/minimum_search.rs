//! A search for the closest collision of two triangles: its norm is an upper bound of the true radius.

use glam::DVec3;

use super::point_pairs::{GRID, PointPairs, Weights, grid};
use super::random::Random;
use crate::certificates::Scope;
use crate::filter::{PairFilter, RingPairs, SimplexPair};
use crate::model::ScaledModel;
use crate::{Clearance, Pair, ReducedModel, distance_triangle_triangle};

/// A configuration at which two points of two triangles meet, or with a clearance are as near as it, up to rounding.
///
/// Triangles that approach each other along one surface touch at that q alone and miss each other beyond it, so the exact test
/// may not confirm it. Its norm is an upper bound of the true radius all the same. Only a collision that the exact test confirms
/// at a smaller norm than a radius refutes that radius.
#[derive(Clone, Debug)]
pub(super) struct Collision {
    pub(super) faces: Pair,
    pub(super) q: Vec<f64>,
    /// `|S (q - center)|`, rounded up.
    pub(super) norm: f64,
    /// A configuration near q that the exact test confirms.
    pub(super) confirmed: Option<Confirmed>,
}

/// A configuration at which the computed positions of two triangles collide by the exact test.
#[derive(Clone, Debug)]
pub(super) struct Confirmed {
    pub(super) q: Vec<f64>,
    /// `|S (q - center)|`, rounded up.
    pub(super) norm: f64,
}

/// The exact test may miss triangles that meet in one point alone: it is repeated at q times these factors.
const FACTORS: [f64; 5] = [1.0, 1.0 + 1e-12, 1.0 + 1e-9, 1.0 + 1e-6, 1.001];

/// The exact test is also repeated where other points meet: the points found, moved by these fractions towards the centroids.
const INWARDS: [f64; 6] = [0.0, 1e-6, 1e-3, 0.01, 0.05, 0.2];

/// Number of random steps of the local search.
const STEPS: usize = 400;

/// Searches the closest collisions of triangle pairs of a model.
#[derive(Clone, Copy)]
pub(super) struct MinimumSearch<'a> {
    pub(super) model: &'a ReducedModel,
    pub(super) scope: &'a Scope,
    pub(super) scaled: &'a ScaledModel,
    pub(super) filter: &'a PairFilter,
    /// Pairs that need not keep the clearance; empty without a clearance.
    pub(super) rings: &'a RingPairs,
    /// The search is for triangles nearer than this. If None, it is for triangles that collide.
    pub(super) clearance: Option<Clearance>,
}

/// A candidate for the minimum over pairs of points.
#[derive(Clone, Copy)]
struct Candidate {
    radius: f64,
    weights: Weights,
}

impl MinimumSearch<'_> {
    /// Searches the smallest `|z|` at which two triangles collide, and returns the collision found. It minimizes over
    /// point pairs, first on a grid, then by random steps, because [`PointPairs`] computes the smallest z of one point
    /// pair. Where the modes cannot move points in all directions, it searches along rays.
    pub(super) fn search(&self, faces: Pair, random: &mut Random) -> Option<Collision> {
        let found = self
            .filter
            .simplex_pairs(faces.0, faces.1)
            .filter_map(|simplices| self.search_simplices(faces, &self.points(simplices), random));
        found.reduce(|best, next| if next.norm < best.norm { next } else { best })
    }

    /// Returns the offset from the centre of a q at which random points of two triangles meet. None if the triangles
    /// never count by their relation, the modes cannot bring the points together, or the points are together at the
    /// centre.
    pub(super) fn approach(&self, faces: Pair, random: &mut Random) -> Option<Vec<f64>> {
        let simplices = self.filter.simplex_pairs(faces.0, faces.1).next()?;
        let z = self.points(simplices).solution(Weights::random(random));
        let moves = z.iter().any(|z| *z != 0.0);
        moves.then(|| self.scope.metric.unscale(&z[..self.model.rank()]))
    }

    fn search_simplices(
        &self,
        faces: Pair,
        points: &PointPairs<'_>,
        random: &mut Random,
    ) -> Option<Collision> {
        let best = minimize(points, random);
        if !best.radius.is_finite() {
            return self.search_along_rays(faces, points, random);
        }
        // At a q where points well inside both triangles meet, the triangles cross.
        let inwards = |share: f64| best.weights.map(|w| w * (1.0 - share) + DVec3::splat(share / 3.0));
        let at = |share: f64, factor: f64| {
            self.scope.at(&points.solution(inwards(share))[..self.model.rank()], factor)
        };
        let tries = INWARDS.into_iter().flat_map(|share| FACTORS.map(|factor| at(share, factor)));
        let confirmed = tries
            .filter(|q| self.collides(faces, q))
            .map(|q| Confirmed { norm: self.scope.norm(&q), q })
            .reduce(|best, next| if next.norm < best.norm { next } else { best });
        let q = at(0.0, 1.0);
        Some(Collision { faces, norm: self.scope.norm(&q), q, confirmed })
    }

    /// Returns the points of two simplices.
    fn points(&self, simplices: SimplexPair<u32>) -> PointPairs<'_> {
        let distance = self.clearance.map_or(0.0, |clearance| clearance.distance());
        PointPairs { scaled: self.scaled, simplices, distance }
    }

    /// Whether two triangles collide at q, or are nearer than the clearance, on the computed positions.
    pub(super) fn collides(&self, faces: Pair, q: &[f64]) -> bool {
        let corners = |face: u32| self.model.mesh().faces()[face as usize].map(|i| self.model.position(i, q));
        if self.model.check_coordinates(q).is_err() {
            return false;
        }
        let [a, b] = [corners(faces.0), corners(faces.1)];
        match self.clearance {
            Some(clearance) => distance_triangle_triangle(&a, &b) < clearance.distance(),
            None => self.filter.collide(faces, &a, &b),
        }
    }

    /// Searches collisions along rays: along each of the first eight modes, and along directions in which points of the pair
    /// approach.
    fn search_along_rays(
        &self,
        faces: Pair,
        points: &PointPairs<'_>,
        random: &mut Random,
    ) -> Option<Collision> {
        let rank = self.model.rank();
        let mut rays: Vec<Vec<f64>> = Vec::new();
        for k in 0..rank.min(8) {
            for sign in [1.0, -1.0] {
                rays.push((0..rank).map(|other| if other == k { sign } else { 0.0 }).collect());
            }
        }
        for _ in 0..24 {
            let relative = points.relative(Weights::random(random));
            rays.push((0..rank).map(|k| -relative.modes[k].dot(relative.difference)).collect());
        }
        let mut best: Option<Collision> = None;
        for ray in rays {
            let length = ray.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            // The gap closes at about this |z|, if ever; search on both sides of it.
            let centroids = points.relative(Weights::CENTROIDS);
            let d = centroids.difference;
            let rate: f64 = (0..rank).map(|k| centroids.modes[k].dot(d) * ray[k]).sum::<f64>() / length;
            let guess = if rate < 0.0 { -d.length_squared() / rate } else { continue };
            for step in 1..200 {
                let t = guess * f64::from(step) * 0.02;
                let q = self.scope.at(&ray, t / length);
                if self.collides(faces, &q) {
                    let norm = self.scope.norm(&q);
                    if best.as_ref().is_none_or(|best| norm < best.norm) {
                        let confirmed = Some(Confirmed { q: q.clone(), norm });
                        best = Some(Collision { faces, confirmed, q, norm });
                    }
                    break;
                }
            }
        }
        best
    }
}

/// Returns the pair of points with the smallest radius, on a grid and then by random steps of decreasing width.
fn minimize(points: &PointPairs<'_>, random: &mut Random) -> Candidate {
    let mut best = Candidate { radius: f64::INFINITY, weights: Weights { a: DVec3::X, b: DVec3::X } };
    for a in grid() {
        for b in grid() {
            let weights = Weights { a, b };
            let radius = points.radius(weights);
            if radius < best.radius {
                best = Candidate { radius, weights };
            }
        }
    }
    let mut width = 1.0 / GRID as f64;
    for _ in 0..if best.radius.is_finite() { STEPS } else { 0 } {
        let weights = best.weights.map(|w| {
            let moved = w + DVec3::new(random.normal(), random.normal(), random.normal()) * width;
            let clamped = moved.max(DVec3::ZERO);
            clamped / (clamped.x + clamped.y + clamped.z).max(f64::MIN_POSITIVE)
        });
        let radius = points.radius(weights);
        if radius < best.radius {
            best = Candidate { radius, weights };
        } else {
            width = (width * 0.98).max(1e-9);
        }
    }
    best
}
