//! Queries: which pairs of triangles collide at q, or between two q, with traversals that certificates cull (paper,
//! Algorithm 1 and section 7).

mod affine_modes;
mod approximate_cones;
mod batch;
mod capsule_motion;
mod certified_search;
mod certified_traversal;
mod clearance;
mod configuration;
mod configuration_check;
mod configuration_search;
mod context;
mod continuous;
mod discrete_between;
#[cfg(test)]
mod exact_matrix;
mod hulls;
mod kinetic;
mod local_claims;
mod local_inequality;
mod local_proofs;
mod local_scales;
mod local_tables;
mod method;
mod near_search;
mod pair_hulls;
mod pair_tree_traversal;
mod proven_shares;
mod query;
mod region_rates;
mod resolve;
mod safe_scale;
mod smallest_stretch;
mod sweep;
mod valid_ball;
mod widened_motion;

pub use kinetic::KineticQuery;
pub use method::Method;
pub use proven_shares::ProvenShares;
pub use query::Query;
pub use resolve::{FreeSamples, ResolveOptions, Resolved};
pub use sweep::{
    ModeRange, Sweep, SweepOutcome, WeightInterval, WeightIntervals, WeightSample, largest_depth,
};
