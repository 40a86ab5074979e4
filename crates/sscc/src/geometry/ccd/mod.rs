//! Continuous tests (CCD) of closed shapes whose corners move linearly, named `impact_shape_shape` (paper, section 7).
//!
//! Both shapes are convex hulls of at most three corners. Each corner moves along the straight line between its given f64
//! positions at t = 0 and at t = 1, exactly. Touching counts.
//!
//! **What "no" promises:** the shapes have no point in common at any t in [0, 1].
//! **How wrong a "yes" may be:** it comes with a time before which the shapes do not meet, and at that time their
//! distance is at most the given share of their size (no less than 6e-14, see [`impact_triangle_triangle`]).
//!
//! # The method
//!
//! Two convex shapes are disjoint when some direction separates them. The gap of two linearly moving corners along a
//! fixed direction is linear in t, along a direction that turns linearly it is quadratic. A polynomial is positive on an interval
//! if all its Bernstein coefficients there are. So one direction, or the two between which it turns, proves a whole interval of
//! time free for all pairs of corners, hence for the hulls: faces, edges and vertices at once ([`candidate_direction`]). A
//! direction perpendicular to two moving features is a polynomial in t of degree 1 to 3. It separates the shapes for as long as
//! these two features are closest, however narrow the gap is ([`feature_direction`]). The remaining task is to advance from t = 0
//! to 1 in as few intervals as possible ([`conservative_advancement`]; Mirtich 1996, *Impulse-based Dynamic Simulation of Rigid
//! Body Systems*).
//!
//! The usual tests are 6 of a vertex and a face and 9 of two edges, each by subdivision of (t, u, v) with inclusion
//! functions in Bernstein form (Wang et al. 2021, *A Large-Scale Benchmark and an Inclusion-Based Algorithm for
//! Continuous Collision Detection*). Here only t is subdivided: directions replace u and v. A pair that intersects all the
//! time, which has no event of a vertex or of two edges, is no special case.

mod bernstein;
mod bounded_float;
mod candidate_direction;
mod closest_points;
mod conservative_advancement;
mod dyadic;
mod feature_direction;
mod free_until;
mod impact_triangle_triangle;
mod moving_triangle;
mod number;
#[cfg(test)]
mod number_tests;

pub(crate) use free_until::free_until;
pub use impact_triangle_triangle::{impact_edge_edge, impact_triangle_triangle, impact_vertex_face};
pub use moving_triangle::MovingTriangle;
