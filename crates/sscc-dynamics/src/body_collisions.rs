//! Collisions between different bodies: a sweep over the AABBs of bodies, then a traversal of two BVHs down to triangle
//! pairs.

use sscc::{Aabb, Pair};

use crate::DynamicsError;
use crate::body::Body;

/// Two bodies that collide, with their colliding triangle pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyPairs<'a> {
    /// Numbers of the bodies, ascending.
    pub bodies: [usize; 2],
    /// Triangle pairs that have a point in common, one triangle of each body, sorted.
    pub pairs: &'a [Pair],
}

/// Two colliding bodies, and the range of their triangle pairs in [`BodyCollisions::pairs`].
#[derive(Clone, Copy, Debug)]
struct CollidingBodies {
    bodies: [usize; 2],
    first: usize,
    end: usize,
}

/// Collisions between bodies in the current step, and the buffers to find them.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyCollisions {
    boxes: Vec<Aabb>,
    /// Bodies ordered by the lower end of their AABBs along x.
    order: Vec<usize>,
    candidates: Vec<[usize; 2]>,
    colliding_bodies: Vec<CollidingBodies>,
    pairs: Vec<Pair>,
}

impl BodyCollisions {
    /// Finds all pairs of triangles of different bodies that have a point in common: exactly those of the positions
    /// [`Body::pose`] of `p + U q`.
    pub fn update(&mut self, bodies: &mut [Body<'_>]) -> Result<(), DynamicsError> {
        self.colliding_bodies.clear();
        self.pairs.clear();
        if bodies.len() < 2 {
            return Ok(());
        }
        self.boxes.clear();
        for body in bodies.iter_mut() {
            self.boxes.push(body.place()?);
        }
        self.sweep();
        let Some(around) = self.boxes.iter().copied().reduce(|a, b| a.union(&b)) else {
            return Ok(());
        };
        for &[a, b] in &self.candidates {
            let first = self.pairs.len();
            let (left, right) = bodies.split_at_mut(b);
            left[a].posed.colliding(&mut right[0].posed, around, &mut self.pairs);
            if self.pairs.len() > first {
                self.colliding_bodies.push(CollidingBodies { bodies: [a, b], first, end: self.pairs.len() });
            }
        }
        Ok(())
    }

    /// Finds the pairs of bodies whose AABBs overlap, sorted (sweep and prune along x).
    fn sweep(&mut self) {
        let boxes = &self.boxes;
        // New bodies come last. The order of the last step is nearly sorted.
        self.order.retain(|n| *n < boxes.len());
        self.order.extend(self.order.len()..boxes.len());
        self.order.sort_by(|a, b| boxes[*a].lower.x.total_cmp(&boxes[*b].lower.x).then(a.cmp(b)));
        self.candidates.clear();
        for (i, &a) in self.order.iter().enumerate() {
            for &b in &self.order[i + 1..] {
                if boxes[b].lower.x > boxes[a].upper.x {
                    break;
                }
                if !boxes[a].is_disjoint(&boxes[b]) {
                    self.candidates.push([a.min(b), a.max(b)]);
                }
            }
        }
        self.candidates.sort_unstable();
    }

    /// Returns the colliding bodies, sorted, with their triangle pairs.
    pub fn colliding(&self) -> impl Iterator<Item = BodyPairs<'_>> {
        let pairs = |found: &CollidingBodies| &self.pairs[found.first..found.end];
        self.colliding_bodies.iter().map(move |found| BodyPairs { bodies: found.bodies, pairs: pairs(found) })
    }
}
