//! Safe distances: how far z may move before two separate triangles can collide. This is the separating-direction
//! bound of certificates ([`bound_along`]) about the current z instead of the centre.

use std::sync::Arc;

use glam::DVec3;

use crate::Pair;
use crate::bounds::{CornerProjections, PairCorners, bound_along};
use crate::filter::PairFilter;
use crate::geometry::{TwoTriangles, nearest_to_origin};
use crate::model::{RoundingBound, ScaledModel, scale_direction};

/// Safe distances are at most this many times the largest norm of the z about which they are computed.
///
/// The proof needs no such cap. Let E be the rounding bound of a gap at `|z|`, `e0 + e1 |z|`, and let the distance D
/// be about a z of at most the norm N: both ends together need `2 e0 + e1 (2 N + D)`.
/// [`RoundingBound::between_configurations`] has `4 e0` and `12 N e1`, and [`bound_along`] adds `e1 D`, since e1 is
/// part of the rate. The cap keeps distances in the range of numbers that N is in, for any rates.
const MAX_NORMS: f64 = 2.0;

/// Computes safe distances, from the model in scaled coordinates.
#[derive(Clone)]
pub(super) struct SafeDistances {
    model: Arc<ScaledModel>,
    error: RoundingBound,
    /// The cap of distances: the rounding bound holds up to this distance.
    largest: f64,
    projections: CornerProjections,
}

impl SafeDistances {
    pub(super) fn new(model: ScaledModel) -> Self {
        Self {
            error: model.rounding.between_configurations(0.0),
            largest: 0.0,
            projections: CornerProjections::new(model.row_len),
            model: Arc::new(model),
        }
    }

    /// Sets the largest norm of the z about which distances are computed from now on.
    pub(super) fn begin(&mut self, norm: f64) {
        self.largest = MAX_NORMS * norm;
        self.error = self.model.rounding.between_configurations((1.0 + MAX_NORMS) * norm);
    }

    /// Returns the safe distance of two triangles whose corners are at these computed positions: they stay separate until z has
    /// moved by it.
    pub(super) fn of_triangles(&mut self, filter: &PairFilter, pair: Pair, corners: [[DVec3; 3]; 2]) -> f64 {
        let faces = [pair.0, pair.1].map(|t| self.model.faces[t as usize]);
        let mut distance = with_mutant!(self.largest, SafeDistanceUncapped, f64::INFINITY);
        for simplices in filter.simplex_pairs_of_corners(pair.0, pair.1) {
            let modes =
                |which: usize, simplex: [usize; 3]| simplex.map(|i| self.model.modes(faces[which][i]));
            let pair = PairCorners {
                corners: TwoTriangles {
                    a: simplices.a.map(|i| corners[0][i]),
                    b: simplices.b.map(|j| corners[1][j]),
                },
                modes_a: modes(0, simplices.a),
                modes_b: modes(1, simplices.b),
            };
            let differences = pair.differences();
            let Some(dir) = scale_direction(nearest_to_origin(&differences).point) else { return 0.0 };
            let least = self.error.along(dir);
            distance = distance.min(bound_along(&pair, &differences, dir, least, &mut self.projections));
        }
        distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::Scope;
    use crate::test_models::{Random, strips};
    use crate::{ContactFilter, Neighbours};

    /// No pair collides within its safe distance, in random directions and in those that close gaps fastest. Distances are not
    /// much too small: many pairs collide within twice their distance.
    #[test]
    fn nothing_collides_within_a_safe_distance() {
        let (mut measured, mut reached) = (0, 0);
        for case in 0..600 {
            let random = &mut Random(case as u64 + 1);
            let (model, half) = strips(random, case);
            let rank = model.rank();
            let filter = ContactFilter::new([Neighbours::Exclude, Neighbours::IncludeOneVertex][case % 2]);
            let center = (0..rank).map(|_| if case % 5 == 0 { random.signed() } else { 0.0 }).collect();
            let scope = Scope { center, filter: filter.clone(), ..Scope::of(&model) };
            let filter = PairFilter::new(&model, &filter);
            let mut distances = SafeDistances::new(ScaledModel::new(&model, &scope.metric, &scope.center));
            distances.begin(30.0);
            let q: Vec<f64> = scope.center.iter().map(|c| c + random.signed() * 0.7).collect();
            let corners = |t: u32, q: &[f64]| model.mesh().faces()[t as usize].map(|v| model.position(v, q));
            let pairs: Vec<Pair> = (0..half).flat_map(|a| (half..2 * half).map(move |b| (a, b))).collect();
            for pair in pairs.into_iter().step_by(2) {
                let distance = distances
                    .of_triangles(&filter, pair, [corners(pair.0, &q), corners(pair.1, &q)])
                    .min(50.0);
                if distance == 0.0 {
                    continue;
                }
                measured += 1;
                let meets = |q: &[f64]| filter.collide(pair, &corners(pair.0, q), &corners(pair.1, q));
                let mut near = false;
                for attempt in 0..30 {
                    let mut way: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
                    if attempt % 2 == 0 {
                        let mut pick = |t: u32| {
                            model.mesh().faces()[t as usize][(random.signed().abs() * 3.0) as usize % 3]
                        };
                        let (v, w) = (pick(pair.0), pick(pair.1));
                        let d = model.position(w, &q) - model.position(v, &q);
                        let scaled = |v: u32| {
                            let mut rows = vec![DVec3::ZERO; rank];
                            scope.metric.scaled_modes(model.modes().of_vertex(v), &mut rows);
                            rows
                        };
                        way = scaled(v).iter().zip(scaled(w)).map(|(a, b)| -d.dot(b - *a)).collect();
                    }
                    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let step = |size: f64| -> Vec<f64> {
                        let z: Vec<f64> = way.iter().map(|x| x / length * size).collect();
                        q.iter().zip(scope.metric.unscale(&z)).map(|(q, d)| q + d).collect()
                    };
                    if length > 0.0 {
                        for share in [0.3, 0.7, 0.9, 0.99, 1.0 - 1e-9] {
                            assert!(!meets(&step(distance * share)), "case {case}, distance {distance}");
                        }
                        near |= [1.05, 1.1, 1.2, 1.5, 2.0].iter().any(|share| meets(&step(distance * share)));
                    }
                }
                reached += usize::from(near);
            }
        }
        assert!(measured > 1000 && reached > 200, "{measured} {reached}");
    }

    /// Distances are at most twice the norm, and both ends of one have at most three times the norm.
    #[test]
    fn gaps_are_rounded_as_at_three_times_the_norm() {
        let (model, _) = strips(&mut Random(3), 3);
        let scope = Scope::of(&model);
        let mut distances = SafeDistances::new(ScaledModel::new(&model, &scope.metric, &scope.center));
        for norm in [0.25, 1.0, 30.0] {
            distances.begin(norm);
            assert_eq!(distances.largest, 2.0 * norm);
            let expected = distances.model.rounding.between_configurations(3.0 * norm);
            for dir in [DVec3::X, DVec3::Y, DVec3::ONE] {
                assert_eq!(distances.error.at_rest(dir), expected.at_rest(dir), "{norm} {dir}");
                assert_eq!(distances.error.per_norm(dir), expected.per_norm(dir), "{norm} {dir}");
            }
        }
    }
}
