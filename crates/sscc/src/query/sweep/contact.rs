//! The contact at which a sweep ends: an exact hit just beyond the weight from which on a pair is not proven free, or the reason
//! why there is none.

use super::sweep::{Sweep, SweepOutcome};
use super::weight_line::{forward, simplest_between, weight_before};
use super::weight_sweep::WeightSweep;
use crate::detect::Impact;
use crate::geometry::nearest_to_origin;
use crate::{Error, Pair};

/// The number of exact tests at distances that are halved, beyond a weight from which on a pair is not proven free. The
/// next f64 and the simplest weight are tested as well.
const EXACT_TESTS: i32 = 24;

/// A sweep that can prove no further weights free tests twice this many weights for a collision.
const PROBES: i32 = 32;

impl WeightSweep<'_> {
    /// Returns the first of some weights within the bracket beyond `at` at which the pair collides exactly.
    pub(super) fn exact_hit(&mut self, pair: Pair, at: f64) -> Option<f64> {
        let filter = &self.query.context.detect.filter;
        let faces = [pair.0, pair.1].map(|t| filter.faces()[t as usize]);
        let to = self.sweep.to;
        // Shapes that pass through each other without overlap touch at one weight, which is often a simple number.
        let simplest = simplest_between(at, forward(at, self.bracket, to));
        // The first step is to the next f64.
        let steps = [0.0].into_iter().chain((0..EXACT_TESTS).rev().map(|n| self.bracket * 0.5_f64.powi(n)));
        let mut weights = std::iter::once(simplest).chain(steps.map(|step| forward(at, step, to)));
        weights.find(|&weight| {
            self.line.set([weight; 2]);
            let [a, b] = faces.map(|face| self.line.moving(face).t0);
            filter.collide(pair, &a, &b)
        })
    }

    /// Sets the result if a pair is not proven free beyond `at`, and exact tests find no hit.
    pub(super) fn close_contact(&mut self, pair: Pair, at: f64) -> Result<(), Error> {
        let end = forward(at, self.bracket, self.sweep.to);
        self.line.set([at, end]);
        let [q_t0, q_t1] = self.line.ends();
        let impacts = self.query.continuous(q_t0, q_t1)?;
        let time = impacts.iter().map(|impact| impact.time).reduce(f64::min);
        let mut pairs: Vec<Pair> = impacts.iter().map(|impact| impact.pair).collect();
        if pairs.is_empty() && self.is_within_tolerance(pair) {
            pairs.push(pair);
        }
        if pairs.is_empty() {
            self.sweep.outcome = SweepOutcome::TooClose(pair);
            return self.probe();
        }
        self.sweep.first_hit = Some(weight_before([at, end], time.unwrap_or(0.0)));
        (self.sweep.pairs, self.sweep.outcome) = (pairs, SweepOutcome::WithinTolerance);
        Ok(())
    }

    /// Whether the distance of the triangles of a pair at the first end of the line is within the tolerance of continuous queries.
    fn is_within_tolerance(&self, pair: Pair) -> bool {
        let mut simplices = self.query.context.detect.filter.simplex_pairs(pair.0, pair.1);
        simplices.any(|simplices| {
            let [a, b] = [simplices.a, simplices.b].map(|vertices| self.line.moving(vertices).t0);
            let size = a.iter().chain(&b).map(|p| (*p - a[0]).abs().max_element()).fold(0.0, f64::max);
            let differences: [_; 9] = std::array::from_fn(|ij| (b[ij % 3] - a[ij / 3]) / size);
            nearest_to_origin(&differences).point.length() <= Impact::TOLERANCE
        })
    }

    /// Looks for a collision beyond the weight up to which the shape is proven free, at distances that double and at
    /// weights that divide the range evenly.
    pub(super) fn probe(&mut self) -> Result<(), Error> {
        let Sweep { from, to, .. } = self.sweep;
        let free = self.sweep.first_free.unwrap_or(from);
        let doubling = (0..PROBES).map(|n| forward(free, self.range * 0.5_f64.powi(n), to));
        let even = (1..=PROBES).map(|n| from + (to - from) * (f64::from(n) / f64::from(PROBES)));
        let is_beyond = |w: &f64| *w != free && (*w > free) == (to > free);
        let mut weights: Vec<f64> = doubling.chain(even).filter(is_beyond).collect();
        weights.sort_by(|v, w| (v - free).abs().total_cmp(&(w - free).abs()));
        for weight in weights {
            let pairs = self.query.discrete(self.line.at(weight))?;
            if !pairs.is_empty() {
                (self.sweep.first_hit, self.sweep.pairs) = (Some(weight), pairs.to_vec());
                break;
            }
        }
        Ok(())
    }
}
