//! Conservative advancement through time: each step is proven free by a direction that separates the two triangles
//! during the whole step.
//!
//! Directions are tried from the cheapest to the most precise. One that stays, or turns linearly, and is evaluated with
//! rounded numbers ([`separation`](super::separation)), settles nearly all pairs in a few steps. Thin sheets that turn
//! together need more: a direction that follows two features is exact for as long as these two are closest, and signs of
//! gaps along it are decided exactly where rounding leaves them undecided ([`feature`](super::feature)). The number of
//! steps then depends on how often the closest features change, and only by its logarithm on how narrow the gap is.

use super::closest_points::Closest;
use super::feature::farther_than;
use super::moving_triangle::MovingTriangle;
use super::separation::Separation;

/// Steps by rounded directions. Of the published queries that planes do not settle, at tolerances from 0 to 1e-3, three
/// in four take one or two, the longest 83.
const STEPS: usize = 128;

/// Steps tried along features. Of 60,000 narrow pairs (as in `tests/impact_tolerance.rs`) none took more than 179.
const FEATURE_STEPS: usize = 10_000;

/// Smaller tolerances (2^-44, about 6e-14) count as this one: gaps along rounded directions have a rounding bound of up to
/// 1.5e-14 of the size.
const FINEST: f64 = f64::from_bits((1023 - 44) << 52);

/// Shorter steps cannot be represented near t = 1.
const SHORTEST: f64 = f64::EPSILON / 16.0;

/// Where a turning direction fails, it is tried next for this many times what the one that stays gained.
const AHEAD: f64 = 4.0;

/// The direction that stays converges while each step leaves less than this share of the distance. Trying a turning one
/// at each step, too, a query of the dragon at 10% evaluated 1.7 times as many closest points.
const CONVERGES: f64 = 0.25;

/// Where the steps by rounded directions end.
enum Advance {
    /// There is no contact until t = 1.
    Free,
    /// At this time the distance is within the tolerance; before it there is no contact.
    Within(f64),
    /// There is no contact until this time, and better directions are needed to tell more.
    Unknown(f64),
}

/// The time from which the distance of two triangles that do not meet at t = 0 is within `tolerance` times their size:
/// never later than their first contact. None if they provably never meet.
pub(super) fn advance(
    x: &MovingTriangle,
    y: &MovingTriangle,
    pair: &Separation,
    tolerance: f64,
) -> Option<f64> {
    let tolerance = tolerance.max(right_or!(FINEST, ToleranceBelowRounding, 0.0)) * pair.size();
    match advance_by_rounded_directions(pair, tolerance) {
        Advance::Free => None,
        Advance::Within(t) => Some(t),
        Advance::Unknown(t) => {
            right_or!(advance_along_features(x, y, pair, t, tolerance), FeaturesNotFollowed, Some(t))
        }
    }
}

/// Towards a contact the direction of the closest points, kept as it is, converges as Newton's method does; along a
/// narrow gap that turns only a direction that turns, too, advances far. It is tried where the first does not bring the two
/// much closer.
fn advance_by_rounded_directions(pair: &Separation, tolerance: f64) -> Advance {
    let (mut t, mut step) = (0.0, 1.0);
    let mut here = Closest::at(pair, t);
    let mut converges = true;
    for _ in 0..STEPS {
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
                let there = Closest::at(pair, next);
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
            if step < SHORTEST {
                break;
            }
        }
        converges = false;
        if until > t {
            t = until;
            let distance = here.distance;
            here = Closest::at(pair, t);
            converges = here.distance < CONVERGES * distance;
        }
    }
    Advance::Unknown(t)
}

/// Advances from `t` by directions that follow the closest features. The tolerance is a length.
///
/// One direction is followed, with steps that double, until it fails; then the closest features are determined again.
/// Where it fails at once, even for the shortest step, the same direction without turning advances by no less than the
/// time in which the fastest vertices close the gap, up to the rounding bound of gaps.
#[cold]
fn advance_along_features(
    x: &MovingTriangle,
    y: &MovingTriangle,
    pair: &Separation,
    mut t: f64,
    tolerance: f64,
) -> Option<f64> {
    let mut step = 1.0 - t;
    let mut tries = 0;
    while tries < FEATURE_STEPS {
        let Some(direction) = farther_than(tolerance, x, y, t) else { return Some(t) };
        let until = pair.along(direction.vector).map_or(t, |kept| kept.separates_until(t));
        if until >= 1.0 {
            return None;
        }
        if until <= t {
            // The gap is within the rounding bound of gaps: tolerances are larger than that.
            break;
        }
        let start = t;
        while t == start && t + step > until && tries < FEATURE_STEPS {
            let mut next = f64::min(t + step, 1.0);
            while direction.separates(x, y, t, next) {
                if next >= 1.0 {
                    return None;
                }
                t = next;
                step *= 2.0;
                next = f64::min(t + step, 1.0);
                tries += 1;
            }
            step *= 0.5;
            tries += 1;
        }
        if t == start {
            t = until;
            step = AHEAD * (until - start);
        }
    }
    Some(t)
}
