//! Continuous tests of closed shapes whose corners move on straight lines, named `impact_shape_shape`.
//!
//! Both shapes are convex hulls of at most three corners, and each corner moves linearly from where it is at t = 0
//! to where it is at t = 1; the way between the given `f64` positions is meant exactly. Touching counts.
//!
//! **What "no" promises:** the shapes have no point in common at any t in [0, 1]. Never a miss.
//! **How wrong a "yes" may be:** it comes with a time before which the shapes do not meet, and at that time their
//! distance is at most the given share of their size (no less than 6e-14, see [`impact_triangle_triangle`]).
//!
//! # The method
//!
//! Two convex shapes are apart when some direction separates them. While the corners move linearly, the gap of two
//! corners along a fixed direction is linear in t; along a direction that turns linearly, too, it is quadratic. A
//! linear or quadratic polynomial is positive on an interval where its Bernstein coefficients there are. So a single
//! direction, or the two between which it turns, proves a whole interval of time free, for all pairs of corners, hence
//! for the hulls: faces, edges and vertices at once ([`separation`]). A direction that is perpendicular to two moving
//! features is a polynomial of t of degree 1 to 3, and proves as much for as long as these two are closest, however narrow
//! the gap is ([`feature`]). What remains is to advance from t = 0 to 1 in as few intervals as possible ([`conservative_advancement`]).
//!
//! The usual tests, 6 of a vertex and a face and 9 of two edges, each by subdivision of (t, u, v) (Wang et al. 2021,
//! *A Large-Scale Benchmark and an Inclusion-Based Algorithm for Continuous Collision Detection*), share the idea:
//! inclusion, in Bernstein form, on parts of the domain. Here only t is subdivided, because directions do what u and v
//! do there; and a pair that is pierced all the way, which has no event of a vertex or of two edges, is no special
//! case.

mod closest_points;
mod conservative_advancement;
mod feature;
mod moving_triangle;
mod number;
mod separation;
mod time_of_impact;

pub use moving_triangle::MovingTriangle;
pub use time_of_impact::{impact_edge_edge, impact_triangle_triangle, impact_vertex_face};
