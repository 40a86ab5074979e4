//! Moving hulls: convex bounding volumes of nodes that follow q without touching vertices.
//!
//! An AABB around a bent, rotated part is mostly empty. A moving hull is the convex hull of a few points of the node,
//! moved by the affine map that fits the node's modes best, and widened by a radius that covers all deviations. It costs
//! O(r) for each node, as a BD-tree AABB does. Two nodes are separate if one plane separates their hulls by more than the
//! sum of both radii.
//!
//! About the centre q0 let `p'_v = p_v + U_v q0` and `y = q - q0`. A node has a centre c, offsets `d_v = p'_v - c`, and
//! modes `U_v = A + G d_v + E_v`, with an affine map for each mode. Its core points D_i are some of the offsets, and
//! `eps` is an upper bound of the distance of any d_v from their hull. At y, with `F = I + G(y)`:
//!
//! ```text
//! X_i = c + A y + F D_i,    R = |F| eps + max_v |E_v y| + error
//! ```
//!
//! Every vertex lies within R of the hull of the X_i: `d_v = sum_i l_i D_i + delta` with convex weights and `|delta| <=
//! eps`, so `x_v = sum_i l_i X_i + F delta + E_v y`. `residuals` bounds `|E_v y|`, `hull_motion` the error of single
//! precision and of the computed shape. Between two configurations, a plane that separates the hulls at both ends
//! separates the motion on straight lines, because each position there is a convex combination of positions at the ends.
//!
//! The plane may be found by any method, in any precision ([`separation`]). Only the last comparison must be safe.

mod core_points;
mod hull_motion;
mod moved_hulls;
mod node_hull;
mod node_hulls;
mod residuals;
mod separation;
#[cfg(test)]
mod tests;

pub(crate) use moved_hulls::MovedHulls;
pub(crate) use node_hulls::NodeHulls;
