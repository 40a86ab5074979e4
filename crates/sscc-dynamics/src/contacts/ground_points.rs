//! Choice of the points on the ground: vertices of a body that the corrections of a step keep above the ground.
//!
//! Few of the vertices near the ground bear the body, and the modes carry the others with them. So a step begins with the
//! points that bore the body in the last step, and adds the lowest of the vertices that would still sink.

use super::contact_laws::ContactLaws;
use super::ground_contacts::GroundContacts;
use super::ground_point::GroundPoint;
use crate::{Body, DynamicsError, Ground};

/// Maximum number of points that a body gains in one correction.
const MAX_NEW_POINTS: usize = 8;

/// Minimum distance between points that a body gains in the same correction, as a share of its radius.
const MIN_DISTANCE: f64 = 0.05;

impl GroundContacts {
    /// Begins a step: finds the vertices near the ground, and keeps the points that bore the body in the last step.
    pub fn begin(
        &mut self,
        body: &mut Body,
        ground: &Ground,
        laws: &ContactLaws,
    ) -> Result<(), DynamicsError> {
        self.update(body, ground, laws.skin)?;
        self.count = self.touching.len();
        self.touching_at_start.clone_from(&self.touching);
        self.points.retain(|point| point.normal_impulse > 0.0);
        self.locate(body, ground, laws);
        Ok(())
    }

    /// Computes the geometry of all points at the beginning of the step.
    fn locate(&mut self, body: &Body, ground: &Ground, laws: &ContactLaws) {
        for point in &mut self.points {
            let GroundPoint { normal_impulse, friction_impulse, .. } = *point;
            *point = GroundPoint {
                normal_impulse,
                friction_impulse,
                ..GroundPoint::at(point.vertex, body, ground, laws)
            };
        }
    }

    /// Makes points of the lowest vertices that sink in the motion to the current state, which is the state of the last
    /// update. Returns whether any vertex sinks.
    pub fn add_sinking(&mut self, body: &Body, ground: &Ground, laws: &ContactLaws) -> bool {
        let mut sinking: Vec<(u32, f64)> = Vec::new();
        for &(vertex, gap) in &self.touching {
            if gap < laws.min_gap() && gap < self.start_gap(vertex) && self.find(vertex).is_err() {
                sinking.push((vertex, gap));
            }
        }
        sinking.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let distance = MIN_DISTANCE * body.shape().radius();
        let mut new: Vec<GroundPoint> = Vec::new();
        for (vertex, _) in sinking {
            let point = GroundPoint::at(vertex, body, ground, laws);
            if new.iter().all(|other| other.arm.distance(point.arm) > distance) {
                new.push(point);
                if new.len() == MAX_NEW_POINTS {
                    break;
                }
            }
        }
        self.points.extend_from_slice(&new);
        self.points.sort_unstable_by_key(|point| point.vertex);
        !new.is_empty()
    }

    /// Returns the fraction of the step after which the first vertex is below the ground in the current state, which is the
    /// state of the last update; None if all stay above. A vertex that begins below must not sink further, but for rounding: a
    /// vertex on the ground may begin below by the rounding of its gap, and that of the test of the first state.
    pub fn sinks_after(&self) -> Option<f64> {
        let mut first = None;
        for &(vertex, gap) in self.touching.iter().filter(|(_, gap)| *gap < 0.0) {
            // Vertices that began beyond the skin have at least this gap at the beginning.
            let start = self.start_gap(vertex);
            if start >= 0.0 || gap < start.min(-2.0 * self.rounding) {
                let start = start.max(0.0);
                let share = start / (start - gap);
                first = Some(first.map_or(share, |other: f64| other.min(share)));
            }
        }
        first
    }

    /// Returns the gap of a vertex at the beginning of the step, or the skin if it is larger.
    fn start_gap(&self, vertex: u32) -> f64 {
        let found = self.touching_at_start.binary_search_by_key(&vertex, |(vertex, _)| *vertex);
        found.map_or(self.skin, |n| self.touching_at_start[n].1)
    }

    /// Returns the index of a vertex's point, or the index at which it would be inserted.
    pub fn find(&self, vertex: u32) -> Result<usize, usize> {
        self.points.binary_search_by_key(&vertex, |point| point.vertex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_vertex_sinks_further() {
        let sinks_after = |start: f64, gap: f64| {
            let mut contacts = GroundContacts::default();
            (contacts.skin, contacts.rounding) = (1.0, 1e-15);
            (contacts.touching_at_start, contacts.touching) = (vec![(3, start)], vec![(3, gap)]);
            contacts.sinks_after()
        };
        assert_eq!(sinks_after(0.5, 0.1), None);
        assert_eq!(sinks_after(0.5, -0.5), Some(0.5));
        assert_eq!(sinks_after(0.0, -0.5), Some(0.0));
        // On the ground, below it by rounding: at rest, and on the way down.
        assert_eq!(sinks_after(-1e-16, -1.5e-15), None);
        assert_eq!(sinks_after(-1e-16, -1e-3), Some(0.0));
        assert_eq!(sinks_after(-0.2, -0.1), None);
        assert_eq!(sinks_after(-0.2, -0.3), Some(0.0));
    }
}
