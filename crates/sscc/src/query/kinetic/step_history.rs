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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MetricKind;
    use crate::test_models::Random;

    /// Positions and norms are those of a parabola in whole 64ths, of which no number is rounded.
    #[test]
    fn predictions_continue_a_parabola() {
        for case in 0..60 {
            let random = &mut Random(case + 40);
            let rank = 1 + case as usize % 5;
            let scales: Vec<f64> = (0..rank).map(|_| 0.5 + random.signed().abs()).collect();
            let metric = Metric::from_scales(MetricKind::Given, scales.clone()).unwrap();
            let mut vector =
                || -> Vec<f64> { (0..rank).map(|_| (random.signed() * 64.0).round() / 64.0).collect() };
            let (start, first, change) = (vector(), vector(), vector());
            let at = |k: f64| -> Vec<f64> {
                (0..rank).map(|i| start[i] + k * first[i] + 0.5 * k * (k - 1.0) * change[i]).collect()
            };
            let length =
                |x: Vec<f64>| x.iter().zip(&scales).map(|(x, s)| (s * x).powi(2)).sum::<f64>().sqrt();
            let mut history = StepHistory::new(rank);
            for (k, is_jump) in [(-7.0, true), (3.0, false), (0.0, true), (1.0, false)] {
                history.record(&at(k), is_jump);
                assert!(!history.is_known());
                assert_eq!(history.straight_steps(&metric, 100.0), 0.0);
            }
            history.record(&at(2.0), false);
            assert!(history.is_known());
            for steps in [16.0, 21.0, 1000.0] {
                let mut end = vec![0.0; rank];
                let radius = history.predict(&metric, steps, &mut end);
                assert_eq!(end, at(2.0 + steps), "case {case}, {steps} steps");
                // Twice the sagitta, and a 64th of the way.
                let step = (0..rank).map(|i| first[i] + change[i]).collect();
                let expected = 0.25 * length(change.clone()) * steps * steps + length(step) * steps / 64.0;
                assert!((radius - expected).abs() <= 1e-12 * expected, "case {case}: {radius} {expected}");
            }
        }
    }

    #[test]
    fn distances_are_those_from_the_last_q() {
        let metric = Metric::identity(2);
        let mut history = StepHistory::new(2);
        assert_eq!(history.distance(&metric, &[3.0, 4.0]), f64::INFINITY);
        history.record(&[0.0, 0.0], true);
        for (q, expected) in [([3.0, 4.0], 5.0), ([3.0, 5.0], 1.0), ([-9.0, 0.0], 13.0), ([-9.0, 0.0], 0.0)] {
            let distance = history.distance(&metric, &q);
            assert!(distance >= expected && distance <= expected * (1.0 + 1e-13), "{distance} {expected}");
            history.record(&q, false);
        }
    }

    /// A motion is nearly straight for as many steps as its change needs to become as long as a step.
    #[test]
    fn motions_are_straight_while_their_change_is_small() {
        let metric = Metric::identity(2);
        for (step, change, limit, expected) in [
            (10.5, 1.0, 1e9, 10.0),
            (10.5, 1.0, 7.9, 7.0),
            (10.5, 0.0, 1e9, 1000.0),
            (10.5, 1e-5, 2000.0, 1000.0),
            (1.0, 2.5, 100.0, 0.0),
            (0.0, 1.0, 100.0, 0.0),
            (0.0, 0.0, 100.0, 0.0),
        ] {
            let history = StepHistory {
                step: vec![0.0, step],
                change: vec![change, 0.0],
                count: 2,
                ..StepHistory::new(2)
            };
            assert_eq!(history.straight_steps(&metric, limit), expected, "{step} {change} {limit}");
        }
    }
}
