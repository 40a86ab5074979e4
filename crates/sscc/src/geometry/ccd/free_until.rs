//! How long two moving triangles provably stay apart where the motion of their corners is known up to a bound.

use super::candidate_direction::MovingPair;
use super::conservative_advancement::{Advance, advance_by_rounded_directions};
use super::impact_triangle_triangle::is_separated_by_planes;
use super::moving_triangle::MovingTriangle;

/// A time up to which, itself included, the triangles have no point in common, for all corners whose distances along each
/// axis are within `slack` of those of the given ones. Infinite: until t = 1. 0: nothing is proven, not even at t = 0. Near a
/// contact it is close to the largest such time.
///
/// Every step is proven by a direction that separates the triangles by more than the slack and the rounding bound. Unlike
/// [`impact_triangle_triangle`](super::impact_triangle_triangle), it does not decide what is closer than that.
pub(crate) fn free_until(a: &MovingTriangle, b: &MovingTriangle, slack: f64) -> f64 {
    let pair = MovingPair::with_slack(a, b, slack);
    if is_separated_by_planes(&pair) {
        return f64::INFINITY;
    }
    match advance_by_rounded_directions(&pair, 0.0) {
        Advance::Free => f64::INFINITY,
        Advance::Within(t) | Advance::Unknown(t) => t,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::triangle_triangle::intersect_triangle_triangle;
    use crate::test_models::Random;

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
            let until = free_until(&a, &b, slack).min(1.0);
            if until == 0.0 {
                continue;
            }
            bounded += usize::from(until < 1.0);
            // Less by the rounding of interpolation.
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
}
