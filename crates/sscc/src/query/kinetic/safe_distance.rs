//! How far z may go before two triangles that are apart can meet: the separating-direction bound of certificates (see
//! `bounds/separating_direction.rs`), about the current z in the place of rest.

use glam::DVec3;

use crate::Pair;
use crate::bounds::{PairCorners, bound_along};
use crate::filter::PairFilter;
use crate::geometry::{TwoTriangles, nearest_to_origin};
use crate::model::{RoundingBound, ScaledModel, scale_direction};

/// Margins are at most so many times the norm that they are measured at.
const FAR: f64 = 2.0;

/// Measures margins. Holds the model in scaled coordinates.
pub(crate) struct Margins {
    model: ScaledModel,
    error: RoundingBound,
    /// No margin is larger: the error is granted that far.
    most: f64,
    projections: Vec<f64>,
}

impl Margins {
    pub(crate) fn new(model: ScaledModel) -> Self {
        Self {
            error: model.rounding.between_configurations(0.0),
            most: 0.0,
            projections: vec![0.0; 6 * model.row],
            model,
        }
    }

    /// From now on margins are about z of at most this norm.
    pub(crate) fn within(&mut self, norm: f64) {
        self.most = FAR * norm;
        self.error = self.model.rounding.between_configurations((1.0 + FAR) * norm);
    }

    /// Of two triangles, whose corners are at these computed positions: while z has moved by less, they stay apart.
    pub(crate) fn triangles(&mut self, filter: &PairFilter, pair: Pair, at: [[DVec3; 3]; 2]) -> f64 {
        let faces = [pair.0, pair.1].map(|t| self.model.faces[t as usize]);
        let mut margin = self.most;
        for hulls in filter.hulls_of_corners(pair.0, pair.1) {
            let modes =
                |which: usize, corners: [usize; 3]| corners.map(|i| self.model.modes(faces[which][i]));
            let pair = PairCorners {
                corners: TwoTriangles { a: hulls.a.map(|i| at[0][i]), b: hulls.b.map(|j| at[1][j]) },
                modes_a: modes(0, hulls.a),
                modes_b: modes(1, hulls.b),
            };
            let differences = pair.differences();
            let Some(n) = scale_direction(nearest_to_origin(&differences).point) else { return 0.0 };
            margin = margin.min(bound_along(&pair, &differences, n, &self.error, &mut self.projections));
        }
        margin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::kinetic::tests::{Random, strips};
    use crate::{Neighbours, PairRule, Scope};

    /// Nothing meets within a margin: looked for at random, and towards where corners come closer fastest. And margins
    /// are not much too small: many are reached up to a tenth.
    #[test]
    fn nothing_meets_within_a_margin() {
        let (mut measured, mut reached) = (0, 0);
        for case in 0..600 {
            let random = &mut Random(case as u64 + 1);
            let (model, half) = strips(random, case);
            let rank = model.rank();
            let rule = PairRule::new([Neighbours::Exclude, Neighbours::IncludeOneVertex][case % 2], false);
            let center = (0..rank).map(|_| if case % 5 == 0 { random.signed() } else { 0.0 }).collect();
            let scope = Scope { center, rule: rule.clone(), ..Scope::of(&model) };
            let filter = PairFilter::new(&model, &rule);
            let mut margins = Margins::new(ScaledModel::new(&model, &scope.metric, &scope.center));
            margins.within(30.0);
            let q: Vec<f64> = scope.center.iter().map(|c| c + random.signed() * 0.7).collect();
            let corners = |t: u32, q: &[f64]| model.mesh().faces()[t as usize].map(|v| model.position(v, q));
            let pairs: Vec<Pair> = (0..half).flat_map(|a| (half..2 * half).map(move |b| (a, b))).collect();
            for pair in pairs.into_iter().step_by(2) {
                let margin =
                    margins.triangles(&filter, pair, [corners(pair.0, &q), corners(pair.1, &q)]).min(50.0);
                if margin == 0.0 {
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
                        q.iter().zip(scope.metric.unscaled(&z)).map(|(q, d)| q + d).collect()
                    };
                    if length > 0.0 {
                        for share in [0.3, 0.7, 0.9, 0.99, 1.0 - 1e-9] {
                            assert!(!meets(&step(margin * share)), "case {case}, margin {margin}");
                        }
                        near |= [1.05, 1.1, 1.2, 1.5, 2.0].iter().any(|share| meets(&step(margin * share)));
                    }
                }
                reached += usize::from(near);
            }
        }
        assert!(measured > 1000 && reached > 200, "{measured} {reached}");
    }
}
