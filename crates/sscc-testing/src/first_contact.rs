//! The first contact of two moving triangles in exact arithmetic: the slow oracle of tests and benches.
//!
//! Two hulls meet exactly when some of the corners of one and some of the other, at most five together, form a Radon
//! partition: their homogeneous coordinates have exactly one linear dependency, and it is positive on the one
//! side and negative on the other. One of five corners is stable, so when they first meet (after time 0) it is one of
//! at most four, which are then in one plane: the time is a root of a determinant of those corners. Where that
//! vanishes all the time, it is a root of a smaller one. So it is enough to try time 0 and all these roots.

use crate::partition::{corners, meet_at, minor, subsets};
use crate::polynomial::{Polynomial, Root};
use num_rational::BigRational;
use num_traits::Zero;
use sscc::MovingTriangle;

/// The exact time at which they first have a point in common, if they do in [0, 1]. Touching counts.
///
/// # Panics
/// When a corner is not finite.
pub fn first_contact(x: &MovingTriangle, y: &MovingTriangle) -> Option<Root> {
    let corners = corners(x, y);
    let start = Root::at(BigRational::zero());
    if meet_at(&corners, &start, 5) {
        return Some(start);
    }
    let mut polynomials: Vec<Polynomial> =
        subsets(6, 4).map(|set| minor(&corners, &set, &[0, 1, 2, 3])).collect();
    if polynomials.iter().any(Polynomial::is_zero) {
        for size in 2..4 {
            for set in subsets(6, size) {
                polynomials.extend(subsets(4, size).map(|rows| minor(&corners, &set, &rows)));
            }
        }
    }
    polynomials.sort();
    polynomials.dedup();
    let roots = polynomials.iter().filter(|p| !p.is_zero()).flat_map(Polynomial::roots);
    let mut first: Option<Root> = None;
    for root in roots {
        let earlier = first.as_ref().is_none_or(|first| root.lower() < first.lower());
        if earlier && meet_at(&corners, &root, 4) {
            first = Some(root);
        }
    }
    first
}
