//! The last steps of z. They predict the next q, and how much the motion bends.

use crate::Metric;

/// A motion is nearly straight while the change of its step is expected to be at most this share of the step. The radius of a
/// capsule is then about a quarter of its length.
const MAX_BEND: f64 = 1.0;

/// The radius of a capsule in units of the expected distance of z from its segment.
const RADIUS_FACTOR: f64 = 2.0;
/// The share of a capsule's length that is added to its radius.
const ADDED_RADIUS: f64 = 1.0 / 64.0;

/// At most this many steps are predicted.
const MAX_STEPS: f64 = 1000.0;

/// The last steps of discrete queries that the root's certificate does not answer.
#[derive(Clone, Debug)]
pub(super) struct StepHistory {
    /// The last q; empty if there was none.
    pub(super) last_q: Vec<f64>,
    /// The step to the last q.
    step: Vec<f64>,
    /// The difference between the last two steps.
    change: Vec<f64>,
    /// Number of steps since the last jump, at most 2.
    count: u32,
    /// Scratch for a difference of q.
    offset: Vec<f64>,
}

impl StepHistory {
    pub(super) fn new(rank: usize) -> Self {
        let [step, change, offset] = [(); 3].map(|()| vec![0.0; rank]);
        Self { last_q: Vec::with_capacity(rank), step, change, count: 0, offset }
    }

    /// Returns the distance of z from the last one, rounded up; infinite if there was none.
    pub(super) fn distance(&mut self, metric: &Metric, q: &[f64]) -> f64 {
        if self.last_q.is_empty() {
            return f64::INFINITY;
        }
        metric.norm_from(q, &self.last_q, &mut self.offset)
    }

    /// Records the next q. After a jump the history of the motion is empty.
    pub(super) fn record(&mut self, q: &[f64], is_jump: bool) {
        if is_jump {
            self.count = 0;
        } else {
            self.count = (self.count + 1).min(2);
            let steps = self.step.iter_mut().zip(&mut self.change);
            for ((step, change), (q, last)) in steps.zip(q.iter().zip(&self.last_q)) {
                *change = (q - last) - *step;
                *step = q - last;
            }
        }
        self.last_q.clear();
        self.last_q.extend_from_slice(q);
    }

    /// Whether the last two steps are recorded.
    pub(super) fn is_known(&self) -> bool {
        self.count == 2
    }

    /// Returns the number of steps, at most `steps`, for which the motion is expected to be nearly straight.
    pub(super) fn straight_steps(&self, metric: &Metric, steps: f64) -> f64 {
        if !self.is_known() {
            return 0.0;
        }
        let bend = metric.length(&self.change) / metric.length(&self.step);
        // A motion at rest has no direction.
        if bend.is_finite() { steps.min(MAX_BEND / bend).min(MAX_STEPS).floor() } else { 0.0 }
    }

    /// Predicts the q after `steps` steps. Returns the radius of a capsule around the straight line to it:
    /// [`RADIUS_FACTOR`] times the expected largest distance of z from this line, and [`ADDED_RADIUS`] of the length of
    /// the steps.
    pub(super) fn predict(&self, metric: &Metric, steps: f64, end: &mut [f64]) -> f64 {
        let weight = 0.5 * steps * (steps + 1.0);
        for (((end, q), step), change) in end.iter_mut().zip(&self.last_q).zip(&self.step).zip(&self.change) {
            *end = q + steps * step + weight * change;
        }
        // The sagitta of a parabola.
        let distance = metric.length(&self.change) * steps * steps / 8.0;
        RADIUS_FACTOR * distance + ADDED_RADIUS * steps * metric.length(&self.step)
    }
}
