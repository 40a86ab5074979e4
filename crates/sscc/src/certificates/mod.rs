//! Certificates: radii in q-space within which parts of a model provably do not collide with themselves (paper,
//! sections 4 and 5).
//!
//! `build/` computes them on the threads of this process, `remote/` by jobs for other processes; both give the same bits.

mod build;
mod certificates;
mod clamp;
mod compatibility;
mod digest;
mod local;
mod options;
mod pair_tree;
mod pair_tree_validation;
mod proof;
mod remote;
mod scope;
#[cfg(test)]
mod test_models;
#[cfg(test)]
mod tests;
mod validation;

pub use build::is_within_reach;
pub(crate) use build::{
    BoundedNodePair, NodeGroups, Precision, RadiusSearch, RadiusSearchContext, SearchGoal, coarse_cap,
};
pub use certificates::{CertificateParts, Certificates};
pub use compatibility::check_filter;
pub use digest::Digest;
pub(crate) use local::{EllipsoidBlocks, FactorScales, GRADIENT, MOST_MODES, PatchModel, gradient_len};
pub use local::{LocalBounds, LocalCertificates};
pub use options::{
    CertifyOptions, DEFAULT_BUDGET, DEFAULT_EPSILON, DEFAULT_LOCAL_BUDGET, DEFAULT_REACH, default_exceptions,
    is_reach,
};
pub use pair_tree::PairTree;
pub(crate) use pair_tree::{StoredPair, sibling_pairs};
pub use proof::Prover;
pub use remote::{BUILD, RunJobs, ShardWorker, compute_in_shards};
pub use scope::Scope;
