//! The region of z for which a search found all pairs that can collide.

use crate::Metric;
use crate::query::configuration::Configuration;
use crate::query::kinetic::region_pairs::up;

/// The distance that z may travel in a capsule, in units of its length.
const MAX_DETOUR: f64 = 1.1;

/// All z within a radius of the segment between the z of two q: a capsule, or, where both are the same, a ball.
#[derive(Clone, Debug)]
pub(super) struct Region {
    pub(super) start: Vec<f64>,
    /// The q at which the motion is expected to leave the region; any finite q is valid.
    pub(super) end: Vec<f64>,
    /// `|S (end - start)|`, rounded up.
    length: f64,
    pub(super) radius: f64,
    /// The largest norm in the region.
    pub(super) norm: f64,
    /// An upper bound of the magnitude of every term of every position in the region.
    pub(super) reach: f64,
    /// Scratch: a point of the segment.
    point: Vec<f64>,
    /// Scratch: a difference of q.
    offset: Vec<f64>,
}

impl Region {
    pub(super) fn new(rank: usize) -> Self {
        let [start, end, point, offset] = [(); 4].map(|()| vec![0.0; rank]);
        Self { start, end, length: 0.0, radius: 0.0, norm: 0.0, reach: 0.0, point, offset }
    }

    /// Sets a ball around a configuration.
    pub(super) fn set_ball(&mut self, Configuration { q, norm, reach }: Configuration<'_>, radius: f64) {
        self.start.copy_from_slice(q);
        self.end.copy_from_slice(q);
        (self.length, self.radius) = (0.0, radius);
        (self.norm, self.reach) = (up(norm + radius), 2.0 * reach);
    }

    /// Sets a capsule from a configuration to the end that is set, whose norm and reach are given.
    pub(super) fn set_capsule(
        &mut self,
        metric: &Metric,
        start: Configuration<'_>,
        (norm, reach): (f64, f64),
        radius: f64,
    ) {
        self.start.copy_from_slice(start.q);
        self.length = metric.norm_from(&self.end, start.q, &mut self.offset);
        self.radius = radius;
        let reach = with_mutant!(start.reach.max(reach), RegionReachAtStart, start.reach);
        // [`Self::contains`] compares norms, so that a norm that is rounded down makes the region smaller by the rounding, and no more.
        let largest = start.norm.max(norm) + radius;
        (self.norm, self.reach) = (with_mutant!(up(largest), RegionNormToNearest, largest), 2.0 * reach);
    }

    /// Returns the radius of a ball, or the length of a capsule.
    pub(super) fn size(&self) -> f64 {
        if self.length > 0.0 { self.length } else { self.radius }
    }

    /// Returns the distance of travel after which the region ends, even if z stays in it.
    pub(super) fn largest_travel(&self) -> f64 {
        MAX_DETOUR * self.length + self.radius
    }

    /// Whether the z of a configuration is in the region, and its norm and reach are at most those of the region.
    ///
    /// The distance from any point of the segment is an upper bound of the distance from the segment. The point's rounding
    /// moves vertices by less than the rounding bound of positions, which
    /// [`CapsuleMotion`](crate::query::capsule_motion::CapsuleMotion) adds.
    pub(super) fn contains(&mut self, metric: &Metric, at: Configuration<'_>) -> bool {
        let is_within_norm = with_mutant!(at.norm <= self.norm, RegionNormUnchecked, true);
        if !(is_within_norm && with_mutant!(at.reach <= self.reach, RegionReachUnchecked, true)) {
            return false;
        }
        let Self { start, end, length, point, offset, .. } = self;
        let mut distance = metric.norm_from(at.q, start, offset);
        if *length > 0.0 {
            let to_end = metric.norm_from(at.q, end, offset);
            // The parameter of the nearest point, from its distances to both ends. NaN fails the comparison below.
            let t = 0.5 + 0.5 * ((distance - to_end) / *length) * ((distance + to_end) / *length);
            let t = with_mutant!(t.clamp(0.0, 1.0), SegmentWithoutEnds, t);
            for ((x, a), b) in point.iter_mut().zip(&*start).zip(&*end) {
                *x = a + t * (b - a);
            }
            distance = metric.norm_from(at.q, point, offset);
        }
        distance <= self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MetricKind;
    use crate::test_models::Random;

    /// Tests points at given distances from segments, in diagonal and dense metrics.
    #[test]
    fn points_within_the_radius_are_contained_and_no_others() {
        for case in 0..300 {
            let random = &mut Random(case + 5);
            let rank = 2 + case as usize % 5;
            let metric = if case % 2 == 0 {
                let scales = (0..rank).map(|_| 0.1 + random.signed().abs()).collect();
                Metric::from_scales(MetricKind::Given, scales).unwrap()
            } else {
                let mut entry = |i: usize, j: usize| match i.cmp(&j) {
                    std::cmp::Ordering::Less => 0.5 * random.signed(),
                    std::cmp::Ordering::Equal => 1.0,
                    std::cmp::Ordering::Greater => 0.0,
                };
                let factor = (0..rank * rank).map(|e| entry(e / rank, e % rank)).collect();
                Metric::from_factor(MetricKind::Given, rank, factor).unwrap()
            };
            // In z the segment lies along the first axis.
            let q = |along: f64, across: f64| {
                let mut z = vec![0.0; rank];
                (z[0], z[1]) = (along, across);
                metric.unscale(&z)
            };
            let (start, end) = (q(1.0, 0.0), q(3.0, 0.0));
            let mut region = Region::new(rank);
            region.end.copy_from_slice(&end);
            let first = Configuration { q: &start, norm: metric.length(&start), reach: 1.0 };
            // The larger reach, 1.5, is that of the end or of the start.
            let (reach_t0, reach_t1) = if case % 3 == 0 { (1.0, 1.5) } else { (1.5, 0.5) };
            let first = Configuration { reach: reach_t0, ..first };
            region.set_capsule(&metric, first, (metric.length(&end), reach_t1), 0.5);
            for (along, across, is_in) in [
                (1.0, 0.499, true),
                (1.0, 0.501, false),
                (2.2, -0.499, true),
                (2.2, 0.501, false),
                (0.501, 0.0, true),
                (0.499, 0.0, false),
                (3.499, 0.0, true),
                (3.501, 0.0, false),
                (3.3, 0.399, true),
                (3.3, 0.401, false),
                (0.7, 0.399, true),
                (0.7, -0.401, false),
            ] {
                let q = q(along, across);
                let at = |reach| Configuration { q: &q, norm: metric.length(&q), reach };
                assert_eq!(region.contains(&metric, at(3.0)), is_in, "case {case}: {along} {across}");
                assert!(!region.contains(&metric, at(3.1)));
            }
            region.set_ball(Configuration { q: &end, norm: metric.length(&end), reach: 1.0 }, 0.5);
            for (along, across, is_in) in [(3.3, 0.399, true), (3.3, 0.401, false), (f64::NAN, 0.0, false)] {
                let q = q(along, across);
                let at = Configuration { q: &q, norm: metric.length(&q), reach: 1.0 };
                assert_eq!(region.contains(&metric, at), is_in);
            }
        }
    }

    /// A search knows radii up to the norm of its region alone.
    #[test]
    fn points_of_larger_norms_are_not_contained() {
        let metric = Metric::identity(1);
        let mut region = Region::new(1);
        region.set_ball(Configuration { q: &[1.0], norm: 1.0, reach: 1.0 }, 0.5);
        let at = |norm| Configuration { q: &[1.4], norm, reach: 1.0 };
        assert!(region.contains(&metric, at(region.norm)));
        assert!(!region.contains(&metric, at(region.norm.next_up())));
        assert!(!region.contains(&metric, at(f64::NAN)));
    }

    /// A search adds the rounding of positions of the region's reach, and control uses its size.
    #[test]
    fn regions_have_twice_the_reach_of_their_ends() {
        let metric = Metric::identity(1);
        let mut region = Region::new(1);
        for reach in [1e-3, 0.5, 1.0, 7.0, 1e6] {
            region.set_ball(Configuration { q: &[1.0], norm: 1.0, reach }, 0.25);
            assert_eq!((region.reach, region.size(), region.largest_travel()), (2.0 * reach, 0.25, 0.25));
            region.end[0] = 3.0;
            region.set_capsule(&metric, Configuration { q: &[1.0], norm: 1.0, reach }, (3.0, 0.1), 0.25);
            assert_eq!(region.reach, 2.0 * reach.max(0.1));
            let is_near = |x: f64, y: f64| x >= y && x <= y * (1.0 + 1e-13);
            assert!(is_near(region.size(), 2.0) && is_near(region.largest_travel(), 2.45));
        }
    }
}
