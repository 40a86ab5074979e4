//! Local certificates: a node is proven free by its own strain, whatever the motion of the rest of the shape.
//!
//! `local_certificates` has the inequality and the numbers. `build` computes them: `patch_model` has the positions and modes
//! of the model in units of its size, `corner_gaps` the gaps between the corners of near leaves, `touching_nodes` the nodes that
//! share a vertex, `residual_ellipsoid` and `strain_search` the bound of one patch. `query/local_inequality.rs` evaluates them.
//! `validation` checks local certificates that come from a file.

mod build;
mod corner_gaps;
mod local_certificates;
mod patch;
mod patch_model;
mod residual_ellipsoid;
mod strain_search;
mod touching_nodes;
mod validation;
#[cfg(test)]
mod widest_gap;

pub(crate) use build::compute_local_certificates;
pub(crate) use local_certificates::{EllipsoidBlocks, GRADIENT, MOST_MODES, gradient_len};
pub use local_certificates::{LocalBounds, LocalCertificates};
pub(crate) use patch_model::{FactorScales, PatchModel};
