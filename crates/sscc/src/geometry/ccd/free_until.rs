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
