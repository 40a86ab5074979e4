//! `Walk`: steps in q-space from a free configuration towards a colliding one that stay free.

use super::counted::Counted;
use super::projection::Projection;
use super::separations::Separations;
use crate::query::query::Query;
use crate::{Error, Impact};

/// A continuous query lists at most this many impacts, exceptions apart; if there are more, the step is halved.
const MAX_IMPACTS: usize = 1 << 12;

/// A step is halved at most this many times.
const MAX_HALVINGS: usize = 64;

/// The largest number of projections for one step: each adds the impacts of the last one as half-spaces.
const MAX_PROJECTIONS: usize = 24;

/// The largest number of scans of all half-spaces for one projection.
const MAX_SCANS: usize = 64;

/// If no free step is found, the walk moves up to this share of the time of impact.
const PARTIAL: f64 = 0.9;

/// The state of a walk: a free configuration, and the pairs that are near there.
pub(super) struct Walk<'w> {
    query: &'w mut Query,
    target: &'w [f64],
    counted: Counted,
    /// The current configuration: free.
    q: Vec<f64>,
    separations: Separations,
    offset: Vec<f64>,
}

impl<'w> Walk<'w> {
    pub(super) fn new(query: &'w mut Query, target: &'w [f64], start: Vec<f64>, all: bool) -> Self {
        let rank = target.len();
        let counted = Counted::new(query, all);
        Self {
            query,
            target,
            counted,
            q: start,
            separations: Separations::new(rank),
            offset: vec![0.0; rank],
        }
    }

    /// Returns the distance to the target in the metric, rounded up.
    pub(super) fn distance(&mut self) -> f64 {
        let Self { query, target, q, offset, .. } = self;
        query.context.scope.metric.norm_from(target, q, offset)
    }

    /// Whether a configuration is free of pairs that count.
    pub(super) fn is_free(&mut self, q: &[f64]) -> Result<bool, Error> {
        self.counted.is_free(self.query, q)
    }

    /// Whether the current configuration is free of pairs that count.
    pub(super) fn is_here_free(&mut self) -> Result<bool, Error> {
        self.counted.is_free(self.query, &self.q)
    }

    /// Returns the current configuration.
    pub(super) fn into_configuration(self) -> Vec<f64> {
        self.q
    }

    /// Returns an upper bound of the displacement of a vertex from here to the target, along each axis.
    pub(super) fn displacement(&self) -> f64 {
        let way: Vec<f64> = self.target.iter().zip(&self.q).map(|(t, q)| t - q).collect();
        self.query.context.model.displacement_bound(&way)
    }

    /// Moves straight towards the target up to a share of the way to the first impact. Returns the last free configuration
    /// on this line and its distance from the target.
    pub(super) fn approach(&mut self, share: f64) -> Result<(Vec<f64>, f64), Error> {
        let (start, target) = (self.q.clone(), self.target.to_vec());
        let (time, _) = self.impacts(&target)?;
        self.go_part(&target, time)?;
        let (last, distance) = (self.q.clone(), self.distance());
        self.q = start;
        self.go_part(&target, time * share)?;
        Ok((last, distance))
    }

    /// Steps as near to the target as the half-spaces of near pairs allow, with this margin: pairs keep at least this gap,
    /// or the smaller one that they have.
    pub(super) fn step(&mut self, margin: f64) -> Result<(), Error> {
        self.update(margin);
        for projections in 1..=MAX_PROJECTIONS {
            if self.query.context.detect.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let there = self.nearest();
            let (time, impacts) = self.impacts(&there)?;
            if impacts.is_empty() && time >= 1.0 && self.is_free(&there)? {
                self.q = there;
                break;
            }
            let mut is_new = false;
            for impact in impacts {
                is_new |= !self.separations.contains(impact.pair)
                    && self.separations.add(&self.query.context, &self.q, impact.pair, margin);
            }
            if !is_new || projections == MAX_PROJECTIONS {
                self.go_part(&there, time * PARTIAL)?;
                break;
            }
        }
        Ok(())
    }

    /// Computes the separating directions of near pairs at the current configuration.
    fn update(&mut self, margin: f64) {
        // No projection is farther from here than twice the distance of the target. A pair that is removed here is found
        // again as an impact.
        let distance = self.distance();
        for pair in self.separations.take_near(2.0 * distance) {
            self.separations.add(&self.query.context, &self.q, pair, margin);
        }
    }

    /// Returns the configuration nearest to the target within the half-spaces.
    fn nearest(&self) -> Vec<f64> {
        let metric = &self.query.context.scope.metric;
        let way: Vec<f64> = self.target.iter().zip(&self.q).map(|(t, q)| t - q).collect();
        let rank = way.len();
        let mut projection = Projection::new(metric.scaled(&way));
        'scans: for _ in 0..MAX_SCANS {
            let violated = self.separations.most_violated(projection.point(), rank);
            if violated.is_empty() {
                break;
            }
            for (normal, offset) in violated {
                if projection.add(&normal, offset).is_err() {
                    break 'scans;
                }
            }
        }
        // The zero displacement violates no half-space, and half-spaces are convex. So a share of the allowed part of this
        // displacement violates none, either.
        let displacement = projection.point();
        let share = self.separations.allowed_share(displacement);
        let displacement: Vec<f64> = displacement.iter().map(|s| s * share).collect();
        let there: Vec<f64> = self.q.iter().zip(metric.unscale(&displacement)).map(|(q, d)| q + d).collect();
        // Extreme numbers can overflow.
        if self.query.context.model.check_coordinates(&there).is_ok() { there } else { self.q.clone() }
    }

    /// Returns the impacts that count between the current configuration and another one, and a time before which there are
    /// none.
    fn impacts(&mut self, there: &[f64]) -> Result<(f64, Vec<Impact>), Error> {
        let most = MAX_IMPACTS + self.counted.others();
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let end = self.between(there, length);
            let mut impacts = self.query.continuous_at_most(&self.q, &end, most)?.to_vec();
            if self.query.statistics().complete {
                impacts.retain(|impact| self.counted.contains(impact.pair));
                let first = impacts.iter().map(|impact| impact.time).fold(1.0, f64::min);
                return Ok((first * length, impacts));
            }
            length *= 0.5;
        }
        Ok((0.0, Vec::new()))
    }

    /// Returns the configuration at a share of the way to another one.
    fn between(&self, there: &[f64], share: f64) -> Vec<f64> {
        if share >= 1.0 {
            return there.to_vec();
        }
        self.q.iter().zip(there).map(|(q, t)| q + share * (t - q)).collect()
    }

    /// Moves along a straight line, which is free before this time, up to this time, or less if rounding makes the end
    /// collide.
    fn go_part(&mut self, there: &[f64], mut time: f64) -> Result<(), Error> {
        let mut back = f64::EPSILON;
        for _ in 0..MAX_HALVINGS {
            let end = self.between(there, time);
            if self.is_free(&end)? {
                self.q = end;
                break;
            }
            time -= time * back;
            back = (back * 8.0).min(0.5);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::parts::Scope;
    use crate::test_models::square;
    use crate::{Method, Modes, ReducedModel, ResolveOptions, TriMesh};

    /// The whole step and its first half have more impacts than a query lists; its first quarter has none, which is no proof for
    /// the rest.
    #[test]
    fn a_step_with_too_many_impacts_stays_before_them() {
        let sheet = square(18);
        let n = sheet.rest_positions().len() as u32;
        let p = [DVec3::ZERO, DVec3::Z]
            .into_iter()
            .flat_map(|by| sheet.rest_positions().iter().map(move |p| *p + by));
        let faces = [0, n]
            .into_iter()
            .flat_map(|first| sheet.faces().iter().map(move |face| face.map(|v| v + first)));
        let modes = (0..2 * n).map(|v| if v < n { DVec3::ZERO } else { DVec3::NEG_Z }).collect();
        let mesh = TriMesh::new(p.collect(), faces.collect()).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
        let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
        assert!(query.continuous(&[0.0], &[1.0]).unwrap().len() > MAX_IMPACTS);
        // The first quarter of the second step ends just before the contact.
        for target in [[2.0], [3.8]] {
            let mut walk = Walk::new(&mut query, &target, vec![0.0], true);
            walk.step(1e-3).unwrap();
            let q = walk.into_configuration();
            assert!(q[0] > 0.0 && q[0] < 1.0, "{target:?} {q:?}");
        }
    }

    /// All triangles are horizontal: only at the heights 1 and 3 does anything collide.
    #[test]
    fn no_path_passes_a_contact_at_one_time() {
        let small = [DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.1];
        let plate = |z: f64| [[-4.0, -4.0], [4.0, -4.0], [0.0, 6.0]].map(|[x, y]| DVec3::new(x, y, z));
        let p = [small, plate(1.0), plate(3.0)].concat();
        let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap();
        let modes = (0..9).map(|v| if v < 3 { DVec3::Z } else { DVec3::ZERO }).collect();
        let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
        let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
        for start in [None, Some(vec![0.5])] {
            let q = query.resolve(&[3.0], &ResolveOptions::default().start(start)).unwrap().q.unwrap();
            assert!(q[0] > 0.9 && q[0] < 1.0, "{q:?}");
        }
        // The end of this part is at the contact.
        let mut walk = Walk::new(&mut query, &[2.0], vec![0.0], true);
        walk.go_part(&[2.0], 0.5).unwrap();
        let q = walk.into_configuration();
        assert!(q[0] > 0.999 && q[0] < 1.0, "{q:?}");
    }
}
