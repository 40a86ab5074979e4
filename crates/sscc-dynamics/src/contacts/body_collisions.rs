//! Collisions between different bodies: a sweep over the AABBs of bodies, then a traversal of two BVHs down to triangle
//! pairs.

use rayon::prelude::*;
use sscc::parts::{Aabb, SweptShape};
use sscc::{Impact, Pair};

use super::sweep_and_prune::SweepAndPrune;
use crate::bodies::body_set::BodySet;
use crate::error::first_error;
use crate::{Body, DynamicsError};

/// Two bodies that collide, with their colliding triangle pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyPairs<'a> {
    /// Numbers of the bodies, ascending.
    pub bodies: [usize; 2],
    /// Triangle pairs that have a point in common, one triangle of each body, sorted.
    pub pairs: &'a [Pair],
}

/// Maximum number of near pairs of two bodies: bounds the memory where the skin is large. A near pair that is omitted is
/// found as an impact if its triangles meet.
const MAX_NEAR: usize = 1 << 14;

/// Two bodies, and the range of their pairs or impacts in a list for all bodies.
#[derive(Clone, Copy, Debug)]
struct Found {
    bodies: [usize; 2],
    first: usize,
    end: usize,
}

/// Collisions between bodies in the current state, impacts in the current step, and the buffers to find them.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyCollisions {
    discrete: SweepAndPrune,
    swept: SweepAndPrune,
    /// Whether the swept AABB of each body is that of its last motion.
    is_placed: Vec<bool>,
    /// AABB of all motions so far; bodies that do not move keep their volumes while the frame stays the same.
    around: Option<Aabb>,
    /// Number of bodies among which all others but [`Self::colliding`] are proven free by swept queries.
    proven: usize,
    colliding_bodies: Vec<Found>,
    pairs: Vec<Pair>,
    impact_bodies: Vec<Found>,
    impacts: Vec<Impact>,
}

impl BodyCollisions {
    /// Finds all pairs of triangles of different bodies that have a point in common: exactly those of the positions
    /// [`Body::pose`] of `p + U q`. Bodies that swept queries have proven free since the last state are not tested.
    pub fn update(&mut self, bodies: &mut [Body]) -> Result<(), DynamicsError> {
        let is_proven = self.proven == bodies.len();
        if is_proven && self.colliding_bodies.is_empty() {
            return Ok(());
        }
        let suspects: Option<Vec<[usize; 2]>> =
            is_proven.then(|| self.colliding_bodies.iter().map(|found| found.bodies).collect());
        self.colliding_bodies.clear();
        self.pairs.clear();
        self.proven = 0;
        self.discrete.boxes.clear();
        for body in bodies.iter_mut() {
            self.discrete.boxes.push(body.place()?);
        }
        self.discrete.find();
        let Some(around) = self.discrete.boxes.iter().copied().reduce(|a, b| a.union(&b)) else {
            return Ok(());
        };
        for &[a, b] in suspects.as_ref().unwrap_or(&self.discrete.candidates) {
            let first = self.pairs.len();
            let (left, right) = bodies.split_at_mut(b);
            left[a].posed.colliding(&mut right[0].posed, around, &mut self.pairs)?;
            if self.pairs.len() > first {
                self.colliding_bodies.push(Found { bodies: [a, b], first, end: self.pairs.len() });
            }
        }
        self.proven = bodies.len();
        Ok(())
    }

    /// Finds all impacts between bodies in the motion from the beginning of the step to their current states, where at least
    /// one of the two has moved (`has_moved`). Bodies that collide at the beginning are not tested: they may pass through
    /// each other until they are apart.
    pub fn find_impacts(&mut self, bodies: &mut [Body], has_moved: &BodySet) -> Result<(), DynamicsError> {
        self.impact_bodies.clear();
        self.impacts.clear();
        let boxes = &mut self.swept.boxes;
        boxes.resize(bodies.len(), Aabb::EMPTY);
        self.is_placed.resize(bodies.len(), false);
        let place = |((body, has_moved), (aabb, is_placed)): ((&mut Body, &bool), (&mut Aabb, &mut bool))| {
            if *has_moved || !*is_placed {
                *aabb = body.sweep()?;
                *is_placed = true;
            }
            Ok(())
        };
        let placed = boxes.par_iter_mut().zip(&mut self.is_placed);
        first_error(bodies.par_iter_mut().zip(has_moved.flags()).zip(placed).map(place).collect())?;
        self.swept.find();
        let all = boxes_union(&self.swept.boxes);
        let around = match self.around {
            Some(around) if around.union(&all) == around => around,
            // The margin avoids a new frame in each step of a slow motion.
            _ => widened(all),
        };
        self.around = Some(around);
        let is_tested = |[a, b]: &[usize; 2]| {
            let is_colliding = self.colliding_bodies.binary_search_by_key(&[*a, *b], |found| found.bodies);
            (has_moved.contains(*a) || has_moved.contains(*b)) && is_colliding.is_err()
        };
        let mut open: Vec<[usize; 2]> = self.swept.candidates.iter().copied().filter(is_tested).collect();
        let mut found: Vec<([usize; 2], Vec<Impact>)> = Vec::new();
        while !open.is_empty() {
            let mut round = disjoint_pairs(bodies, &mut open);
            let search = |one: &mut MotionPair| -> Result<(), DynamicsError> {
                let [x, y] = &mut one.motions;
                Ok(x.impacts(y, around, &mut one.impacts)?)
            };
            let searched = round.par_iter_mut().map(search).collect();
            for MotionPair { bodies: [a, b], motions: [x, y], impacts } in round {
                (bodies[a].swept, bodies[b].swept) = (Some(x), Some(y));
                if !impacts.is_empty() {
                    found.push(([a, b], impacts));
                }
            }
            first_error(searched)?;
        }
        found.sort_unstable_by_key(|(bodies, _)| *bodies);
        for (bodies, impacts) in found {
            let first = self.impacts.len();
            self.impacts.extend(impacts);
            self.impact_bodies.push(Found { bodies, first, end: self.impacts.len() });
        }
        Ok(())
    }

    /// Appends the pairs of triangles of two bodies that come within a distance of each other in the motion of the last
    /// [`BodyCollisions::find_impacts`]. The list may contain pairs that stay farther apart, and has at most [`MAX_NEAR`]
    /// pairs. It depends on the two motions alone.
    pub fn find_near(
        bodies: &mut [Body],
        [a, b]: [usize; 2],
        margin: f64,
        found: &mut Vec<([usize; 2], Pair)>,
    ) -> Result<(), DynamicsError> {
        let mut pairs = Vec::new();
        let (left, right) = bodies.split_at_mut(b);
        if let (Some(x), Some(y)) = (&mut left[a].swept, &mut right[0].swept) {
            // Which pairs are found, and their order up to the limit, depends on the frame. The frame of earlier motions would
            // give other contacts after a restart.
            x.near(y, Aabb::EMPTY, margin, MAX_NEAR, &mut pairs)?;
        }
        found.extend(pairs.into_iter().map(|pair| ([a, b], pair)));
        Ok(())
    }

    /// Returns the colliding bodies, sorted, with their triangle pairs.
    pub fn colliding(&self) -> impl Iterator<Item = BodyPairs<'_>> {
        let pairs = |found: &Found| &self.pairs[found.first..found.end];
        self.colliding_bodies.iter().map(move |found| BodyPairs { bodies: found.bodies, pairs: pairs(found) })
    }

    /// Returns the bodies with impacts, sorted, and their impacts.
    pub fn impacts(&self) -> impl Iterator<Item = ([usize; 2], &[Impact])> {
        self.impact_bodies.iter().map(|found| (found.bodies, &self.impacts[found.first..found.end]))
    }

    /// Discards the results of swept queries; needed after a body was moved to another state.
    pub fn reset(&mut self) {
        self.proven = 0;
        self.is_placed.fill(false);
    }

    /// Discards the motion of a body, which has changed since it was computed.
    pub fn forget_motion(&mut self, body: usize) {
        if let Some(is_placed) = self.is_placed.get_mut(body) {
            *is_placed = false;
        }
    }
}

/// The motions of two bodies, taken from them, and their impacts.
struct MotionPair {
    bodies: [usize; 2],
    motions: [Box<SweptShape>; 2],
    impacts: Vec<Impact>,
}

/// Takes pairs from a list such that no body occurs twice: the pairs can be tested at the same time.
fn disjoint_pairs(bodies: &mut [Body], open: &mut Vec<[usize; 2]>) -> Vec<MotionPair> {
    let mut is_taken = vec![false; bodies.len()];
    let mut pairs = Vec::new();
    open.retain(|&[a, b]| {
        if is_taken[a] || is_taken[b] {
            return true;
        }
        match (bodies[a].swept.take(), bodies[b].swept.take()) {
            (Some(x), Some(y)) => {
                (is_taken[a], is_taken[b]) = (true, true);
                pairs.push(MotionPair { bodies: [a, b], motions: [x, y], impacts: Vec::new() });
            }
            // A body without a motion has no impact.
            (x, y) => (bodies[a].swept, bodies[b].swept) = (x, y),
        }
        false
    });
    pairs
}

fn boxes_union(boxes: &[Aabb]) -> Aabb {
    boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one))
}

fn widened(Aabb { lower, upper }: Aabb) -> Aabb {
    let margin = (upper - lower) * 0.1;
    Aabb { lower: lower - margin, upper: upper + margin }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::test_shapes::tetrahedron;
    use crate::{Start, WorldOptions};

    /// Returns the near pairs of two bodies at rest, 0.05 apart.
    fn near_pairs(collisions: &mut BodyCollisions, bodies: &mut [Body], moved: &BodySet) -> Vec<Pair> {
        move_to(&mut bodies[1], 1.05);
        collisions.reset();
        collisions.find_impacts(bodies, moved).unwrap();
        let mut near = Vec::new();
        BodyCollisions::find_near(bodies, [0, 1], 0.1, &mut near).unwrap();
        near.into_iter().map(|(_, pair)| pair).collect()
    }

    fn move_to(body: &mut Body, x: f64) {
        body.rigid.position = DVec3::X * x;
        body.save_start();
    }

    #[test]
    fn near_pairs_do_not_depend_on_earlier_motions() {
        let shape = tetrahedron(vec![DVec3::ZERO; 4], &[1.0]);
        let start = Start { position: Some(DVec3::ZERO), ..Start::default() };
        let mut bodies: Vec<Body> =
            (0..2).map(|_| Body::new(&shape, &start, &WorldOptions::default(), None).unwrap()).collect();
        let mut moved = BodySet::default();
        moved.set([true; 2].into_iter());
        let expected = near_pairs(&mut BodyCollisions::default(), &mut bodies, &moved);
        // Faces with the corners that are near, and not all faces.
        assert!((9..16).contains(&expected.len()), "{expected:?}");
        let mut collisions = BodyCollisions::default();
        move_to(&mut bodies[1], 1e7);
        collisions.find_impacts(&mut bodies, &moved).unwrap();
        assert_eq!(near_pairs(&mut collisions, &mut bodies, &moved), expected);
    }
}
