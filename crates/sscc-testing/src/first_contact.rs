//! First contact of two moving triangles in exact arithmetic: a slow oracle for tests and benches.
//!
//! Two hulls meet exactly when some corners of one and some of the other, at most five in all, form a Radon partition:
//! their homogeneous coordinates have exactly one linear dependency, which is positive on one side and negative on the
//! other. A partition of five corners is stable under small motions. So a first contact after time 0 has a partition of
//! at most four corners, which are then in one plane, and its time is a root of a determinant of these corners. If that
//! determinant vanishes at all times, the time is a root of a smaller one. The oracle therefore tries time 0 and all
//! these roots.

use crate::partition::{Minors, subsets};
use crate::polynomial::{Polynomial, Root};
use num_rational::BigRational;
use num_traits::Zero;
use sscc::MovingTriangle;

/// Returns the exact time in [0, 1] at which the triangles first have a common point; None if they have none. Touching counts.
///
/// # Panics
/// When a corner is not finite.
pub fn first_contact(x: &MovingTriangle, y: &MovingTriangle) -> Option<Root> {
    let minors = Minors::new(x, y);
    let start = Root::at(BigRational::zero());
    if minors.meet_at(&start, 5) {
        return Some(start);
    }
    let mut polynomials: Vec<&Polynomial> = subsets(6, 4).map(|set| minors.of(set, 0b1111)).collect();
    if polynomials.iter().any(|p| p.is_zero()) {
        for size in 2..4 {
            for set in subsets(6, size) {
                polynomials.extend(subsets(4, size).map(|rows| minors.of(set, rows)));
            }
        }
    }
    polynomials.sort();
    polynomials.dedup();
    let roots = polynomials.iter().filter(|p| !p.is_zero()).flat_map(|p| p.roots());
    let mut first: Option<Root> = None;
    for root in roots {
        let earlier = first.as_ref().is_none_or(|first| root.lower() < first.lower());
        if earlier && minors.meet_at(&root, 4) {
            first = Some(root);
        }
    }
    first
}
