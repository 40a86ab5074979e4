//! Conservative advancement of two moving triangles through time: a separating direction proves each step free (Mirtich
//! 1996).
//!
//! Directions are tried from the cheapest to the most precise. A direction that is fixed, or turns linearly, evaluated
//! with rounded numbers ([`candidate_direction`](super::candidate_direction)), decides nearly all pairs in a few steps. Thin
//! sheets that rotate together need more: a direction that follows two features is exact for as long as these two are closest,
//! and exact numbers decide the signs of gaps along it where rounding does not ([`feature_direction`](super::feature_direction)).
//! The number of steps then depends on how often the closest features change, and only logarithmically on how narrow the gap is.
//! Limits of steps: docs/notes/exact-tests.md#steps-of-conservative-advancement.

use super::candidate_direction::MovingPair;
use super::closest_points::ClosestPoints;
use super::feature_direction::find_gap_above;
use super::moving_triangle::MovingTriangle;

/// Maximum number of steps by rounded directions.
const MAX_STEPS: usize = 128;

/// Maximum number of steps along features in one continuous test.
const MAX_FEATURE_STEPS: usize = 10_000;

/// Smaller tolerances count as this one, 2^-44 (about 6e-14): gaps along rounded directions have a rounding bound of up
/// to 1.5e-14 of the size.
const MIN_TOLERANCE: f64 = f64::from_bits((1023 - 44) << 52);

/// The shortest step: shorter ones cannot be represented near t = 1.
const MIN_STEP: f64 = f64::EPSILON / 16.0;

/// If a turning direction fails, the next step is at most this many times the step of the fixed direction.
const AHEAD: f64 = 4.0;

/// The fixed direction converges while each step reduces the distance to less than this share of it. A turning direction is tried
/// only if the fixed one does not converge.
const CONVERGES: f64 = 0.25;

/// The result of the steps by rounded directions.
pub(super) enum Advance {
    /// There is no contact until t = 1.
    Free,
    /// At this time the distance is within the tolerance; before it there is no contact.
    Within(f64),
    /// There is no contact before this time, and more precise directions must decide the rest.
    Unknown(f64),
}

/// Returns a time that is never later than the first contact of two triangles that do not meet at t = 0. Their distance
/// at this time is within `tolerance` times their size, unless the limit of steps ended the advancement. None if they
/// provably do not meet until t = 1.
pub(super) fn advance(
    a: &MovingTriangle,
    b: &MovingTriangle,
    pair: &MovingPair,
    tolerance: f64,
) -> Option<f64> {
    let tolerance = tolerance.max(with_mutant!(MIN_TOLERANCE, ToleranceBelowRounding, 0.0)) * pair.size();
    match advance_by_rounded_directions(pair, tolerance) {
        Advance::Free => None,
        Advance::Within(t) => Some(t),
        Advance::Unknown(t) => {
            let mut steps = MAX_FEATURE_STEPS;
            let time = advance_along_features([a, b], pair, t, tolerance, &mut steps);
            with_mutant!(time, FeaturesNotFollowed, Some(t))
        }
    }
}

/// Advances by rounded directions. Near a contact, the fixed direction of the closest points converges like Newton's method.
/// Along a narrow gap that turns, only a turning direction advances far; it is tried when the fixed one does not bring the
/// triangles much closer.
pub(super) fn advance_by_rounded_directions(pair: &MovingPair, tolerance: f64) -> Advance {
    let (mut t, mut step) = (0.0, 1.0);
    let mut here = ClosestPoints::at(pair, t);
    let mut converges = true;
    for _ in 0..MAX_STEPS {
        if here.distance <= tolerance {
            return Advance::Within(t);
        }
        let Some(direction) = here.direction else { break };
        let until = direction.separates_until(t);
        if until >= 1.0 {
            return Advance::Free;
        }
        if !converges {
            let next = f64::min(t + step, 1.0);
            if next > t {
                let there = ClosestPoints::at(pair, next);
                if there.direction.is_some_and(|to| direction.separates_turning(t, &to, next)) {
                    if next >= 1.0 {
                        return Advance::Free;
                    }
                    (t, here) = (next, there);
                    step *= 2.0;
                    continue;
                }
            }
            step *= 0.5;
            if until > t {
                step = step.min(AHEAD * (until - t));
            }
            if step < MIN_STEP {
                break;
            }
        }
        converges = false;
        if until > t {
            t = until;
            let distance = here.distance;
            here = ClosestPoints::at(pair, t);
            converges = here.distance < CONVERGES * distance;
        }
    }
    Advance::Unknown(t)
}

/// Advances from `t` by directions that follow the closest features. The tolerance is a length. Returns the time
/// reached; None if there is no contact until t = 1.
///
/// Follows one feature direction with doubling steps until it fails, then determines the closest features again. If
/// even the shortest step fails, the fixed direction still advances by the time in which the fastest vertices could
/// close the gap, up to its rounding bound.
///
/// Every step is proven for corners within the slack of the pair, too. `steps` is the number of steps left for this and other
/// pairs: if none is left, the time reached is returned.
#[cold]
pub(super) fn advance_along_features(
    [a, b]: [&MovingTriangle; 2],
    pair: &MovingPair,
    mut t: f64,
    tolerance: f64,
    steps: &mut usize,
) -> Option<f64> {
    let mut step = 1.0 - t;
    while *steps > 0 {
        *steps -= 1;
        let Some(direction) = find_gap_above(tolerance, a, b, t) else { return Some(t) };
        let until = pair.along(direction.vector).map_or(t, |fixed| fixed.separates_until(t));
        if until >= 1.0 {
            return None;
        }
        if until <= t {
            // The gap is within its rounding bound, hence within the tolerance, which is larger; or within the slack.
            break;
        }
        let start = t;
        while t == start && t + step > until && *steps > 0 {
            let mut next = f64::min(t + step, 1.0);
            while direction.separates([a, b], pair.slack(), [t, next]) {
                if next >= 1.0 {
                    return None;
                }
                t = next;
                step *= 2.0;
                next = f64::min(t + step, 1.0);
                *steps = steps.saturating_sub(1);
            }
            step *= 0.5;
            *steps = steps.saturating_sub(1);
        }
        if t == start {
            t = until;
            step = AHEAD * (until - start);
        }
    }
    Some(t)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::distance_triangle_triangle;
    use crate::test_models::Random;

    /// A point is above a face by less than the rounding bound of the gap along its normal: no step follows.
    #[test]
    fn a_gap_within_its_rounding_ends_the_search_along_features() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let face = MovingTriangle { t0: corners, t1: corners };
        let point = MovingTriangle::vertex(DVec3::new(0.25, 0.25, 1e-16), DVec3::new(0.25, 0.25, -1.0));
        let mut steps = 100;
        let pair = MovingPair::new(&face, &point);
        assert_eq!(advance_along_features([&face, &point], &pair, 0.0, 0.0, &mut steps), Some(0.0));
        assert_eq!(steps, 99);
    }

    /// Two triangles whose distance is above the tolerance have a gap above it along the direction of two features, so that no
    /// search ends at the start.
    #[test]
    fn features_separate_triangles_at_rest() {
        let random = &mut Random(8);
        let mut tried = 0;
        while tried < 200 {
            let [a, b] = [1.0, 2.5].map(|size| {
                let place = if size > 1.0 { random.vector() * size } else { DVec3::ZERO };
                let corners = [(); 3].map(|()| place + random.vector());
                MovingTriangle { t0: corners, t1: corners }
            });
            let distance = distance_triangle_triangle(&a.t0, &b.t0);
            if distance < 0.01 {
                continue;
            }
            tried += 1;
            let (pair, mut steps) = (MovingPair::new(&a, &b), 100);
            let found = advance_along_features([&a, &b], &pair, 0.0, 0.99 * distance, &mut steps);
            assert_eq!(found, None, "{tried}: {distance}");
        }
    }
}
