//! Queries: which pairs of triangles collide at q, or between two q, with traversals that certificates cull (paper,
//! Algorithm 1 and section 7).

mod approximate_cones;
mod batch;
mod certified_search;
mod certified_traversal;
mod configuration;
mod configuration_check;
mod context;
mod continuous;
mod discrete_between;
mod discrete_search;
#[cfg(test)]
mod exact_matrix;
mod kinetic;
mod local_claims;
mod local_inequality;
mod local_proofs;
mod local_scales;
mod local_tables;
mod method;
mod pair_hulls;
mod pair_tree_traversal;
mod proven_shares;
mod query;
mod region_rates;
mod resolve;
mod safe_scale;
mod search_group;
mod smallest_stretch;
mod statistics;
mod sweep;
mod swept_search;
mod valid_ball;

pub use kinetic::KineticQuery;
pub use method::Method;
pub use proven_shares::ProvenShares;
pub use query::Query;
pub use resolve::{FreeSamples, ResolveOptions, Resolved};
pub use search_group::Answer;
pub use statistics::{Proof, Statistics};
pub use sweep::{Sweep, SweepOutcome};
