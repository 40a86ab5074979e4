//! Collisions between bodies: boxes over bodies first, then tree against tree, down to triangles.

use sscc::{Aabb, Pair};

use crate::DynamicsError;
use crate::body::Body;

/// Two bodies that collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyPairs<'a> {
    /// Their numbers, ascending.
    pub bodies: [usize; 2],
    /// The pairs of triangles that have a point in common, one triangle of each body, sorted.
    pub pairs: &'a [Pair],
}

/// Two bodies that collide, and where their pairs are.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    bodies: [usize; 2],
    first: usize,
    end: usize,
}

/// What collides between bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbours {
    boxes: Vec<Aabb>,
    /// Bodies by the lower end of their boxes along x.
    order: Vec<usize>,
    candidates: Vec<[usize; 2]>,
    meetings: Vec<Meeting>,
    pairs: Vec<Pair>,
}

impl Neighbours {
    /// Finds all pairs of triangles of different bodies that have a point in common: exactly those of the positions
    /// [`Body::pose`] of `p + U q`.
    pub fn update(&mut self, bodies: &mut [Body<'_>]) -> Result<(), DynamicsError> {
        self.meetings.clear();
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
                self.meetings.push(Meeting { bodies: [a, b], first, end: self.pairs.len() });
            }
        }
        Ok(())
    }

    /// The pairs of bodies whose boxes overlap, sorted.
    fn sweep(&mut self) {
        let boxes = &self.boxes;
        // Bodies are added at the end, and the order of the last step is nearly right.
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

    /// The bodies that collide, sorted.
    pub fn colliding(&self) -> impl Iterator<Item = BodyPairs<'_>> {
        let pairs = |meeting: &Meeting| &self.pairs[meeting.first..meeting.end];
        self.meetings.iter().map(move |meeting| BodyPairs { bodies: meeting.bodies, pairs: pairs(meeting) })
    }
}
