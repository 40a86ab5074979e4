//! Computes how long two moving triangles provably stay apart if the motion of their corners is known up to a bound.

use super::candidate_direction::MovingPair;
use super::conservative_advancement::{Advance, advance_along_features, advance_by_rounded_directions};
use super::impact_triangle_triangle::is_separated_by_planes;
use super::moving_triangle::MovingTriangle;

/// Directions along features are followed only where the distance is more than this many times the slack: at smaller distances
/// they gain little before they fail by the slack.
const FEATURE_GAP: f64 = 32.0;

/// Returns a time up to which, itself included, the triangles have no point in common, for all corners whose distances along each
/// axis are within `slack` of those of the given ones. Infinite if they have none until t = 1; 0 if nothing is proven, not even
/// at t = 0. Near a contact it is close to the largest such time.
///
/// Every step is proven by a direction that separates the triangles by more than the slack and the rounding bound.
/// Unlike [`impact_triangle_triangle`](super::impact_triangle_triangle), this function does not decide pairs that are
/// closer than that. Directions along features are far slower than rounded ones: `steps` is the number of them left for
/// this and other pairs. If none is left, the time may be far from the largest one.
pub(crate) fn free_until(a: &MovingTriangle, b: &MovingTriangle, slack: f64, steps: &mut usize) -> f64 {
    let pair = MovingPair::with_slack(a, b, slack);
    if is_separated_by_planes(&pair) {
        return f64::INFINITY;
    }
    match advance_by_rounded_directions(&pair, 0.0) {
        Advance::Free => f64::INFINITY,
        Advance::Within(t) => t,
        Advance::Unknown(t) => {
            let time = advance_along_features([a, b], &pair, t, FEATURE_GAP * slack, steps);
            with_mutant!(time.unwrap_or(f64::INFINITY), SweepFeaturesNotFollowed, t)
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::impact_triangle_triangle::impact_triangle_triangle;
    use super::*;
    use crate::geometry::triangle_triangle::intersect_triangle_triangle;
    use crate::test_models::Random;

    /// Two copies of a triangle, one above the other, that rotate together and come closer. Beyond a time, one of them could
    /// reach the other within the slack.
    #[test]
    fn directions_along_features_leave_room_for_the_slack() {
        let random = &mut Random(31);
        let (mut advanced, mut stopped) = (0, 0);
        for case in 0..60 {
            let gap = 10.0_f64.powi(-3 - case % 3);
            let slack = gap * (0.3 + 0.2 * random.signed());
            let below = MovingTriangle {
                t0: [DVec3::ZERO, DVec3::X, DVec3::Y],
                t1: [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + random.vector() * 0.5),
            };
            let raised = |corners: [DVec3; 3], by: f64| corners.map(|p| p + DVec3::Z * by);
            let above = MovingTriangle { t0: raised(below.t0, gap), t1: raised(below.t1, 0.1 * gap) };
            let pair = MovingPair::with_slack(&below, &above, slack);
            let mut steps = 1000;
            let t = advance_along_features([&below, &above], &pair, 0.0, slack, &mut steps).unwrap_or(1.0);
            (advanced, stopped) = (advanced + i32::from(t > 0.1), stopped + i32::from(t < 1.0));
            for i in 0..=16 {
                let [a, b] = [&below, &above].map(|moving| moving.at(t * f64::from(i) / 16.0));
                for signs in 0..8 {
                    let sign = |axis: u32| if signs >> axis & 1 == 0 { slack } else { -slack };
                    let shift = DVec3::new(sign(0), sign(1), sign(2)) * (1.0 - 1e-9);
                    let [a, b] =
                        [MovingTriangle { t0: a, t1: a }, MovingTriangle { t0: b, t1: b.map(|p| p + shift) }];
                    assert_eq!(impact_triangle_triangle(&a, &b, 1e-12), None, "case {case}, {i}, {shift}");
                }
            }
        }
        assert!(advanced > 20 && stopped > 20, "{advanced} {stopped}");
    }

    #[test]
    fn without_steps_the_time_reached_is_returned() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let turned = [DVec3::ZERO, DVec3::new(0.8, 0.1, 0.5), DVec3::new(-0.2, 0.7, 0.6)];
        let below = MovingTriangle { t0: flat, t1: turned };
        let above = MovingTriangle {
            t0: flat.map(|p| p + DVec3::Z * 1e-10),
            t1: turned.map(|p| p + DVec3::Z * 1e-10),
        };
        let mut none = 0;
        let early = free_until(&below, &above, 1e-15, &mut none);
        let mut steps = 100;
        assert!(early > 0.0 && early < 0.1, "{early}");
        assert_eq!(free_until(&below, &above, 1e-15, &mut steps), f64::INFINITY);
        assert!((80..100).contains(&steps), "{steps}");
    }

    /// Up to the time found, one triangle may be off by the whole slack along each axis, in every direction, and so
    /// may all of its corners in directions of their own.
    #[test]
    fn corners_may_be_off_by_all_of_the_slack() {
        let random = &mut Random(3);
        let (mut bounded, mut tight) = (0, 0);
        for case in 0..400 {
            let place = random.vector();
            let mut triangle = |by: DVec3| [(); 3].map(|()| random.vector() + by);
            let a = MovingTriangle { t0: triangle(DVec3::ZERO), t1: triangle(DVec3::ZERO) };
            let b = MovingTriangle { t0: triangle(place * 5.0), t1: triangle(DVec3::ZERO) };
            let slack = [0.3, 1e-2, 1e-4][case % 3];
            let until = free_until(&a, &b, slack, &mut 1000).min(1.0);
            if until == 0.0 {
                continue;
            }
            bounded += usize::from(until < 1.0);
            // This is less than the slack by the rounding of interpolation.
            let off = slack * (1.0 - 1e-9);
            for share in [0.5, 0.9, 1.0] {
                let t = until * share;
                let (at_a, at_b) = (a.at(t), b.at(t));
                let mut ways: Vec<[DVec3; 3]> = (0..8)
                    .map(|i| DVec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { off } else { -off })))
                    .map(|way| [way; 3])
                    .collect();
                ways.extend((0..20).map(|_| [(); 3].map(|()| random.vector().signum() * off)));
                for way in &ways {
                    let moved = [0, 1, 2].map(|i| at_b[i] + way[i]);
                    assert!(!intersect_triangle_triangle(&at_a, &moved), "case {case} at {t}: {way:?}");
                }
                let farther = |way: &[DVec3; 3]| [0, 1, 2].map(|i| at_b[i] + way[i] * 1.5);
                tight += usize::from(
                    share == 1.0 && ways.iter().any(|way| intersect_triangle_triangle(&at_a, &farther(way))),
                );
            }
        }
        assert!(bounded > 50 && tight > 10, "{bounded} {tight}");
    }

    /// A point moves from above a face to beside one of its edges, below its plane: no direction of one pair of features separates
    /// the two all the time, and few steps are needed.
    #[test]
    fn the_closest_features_are_determined_again() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let face = MovingTriangle { t0: corners, t1: corners };
        let point = MovingTriangle::vertex(DVec3::new(0.4, 0.4, 0.1), DVec3::new(3.0, 3.0, -1.0));
        let pair = MovingPair::new(&face, &point);
        let mut steps = 1000;
        assert_eq!(advance_along_features([&face, &point], &pair, 0.0, 1e-12, &mut steps), None);
        assert!(steps > 900, "{steps}");
    }
}
