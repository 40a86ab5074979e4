//! Items that only the other crates of this project need: **a user need not read this module.**
//!
//! - Readers and writers of files: the contents of [`Certificates`](crate::Certificates) and of groups of triangles.
//! - Clusters: certificates computed by many processes, as jobs and results ([`compute_in_shards`]).
//! - The command, the page and benches: the hierarchy, defaults and checks of options, the shares of a shape that each kind of
//!   certificate proves ([`ProvenShares`]), where and how deep triangles intersect ([`contact_curves`]).
//! - Dynamics: queries between shapes in the world ([`PosedShape`], [`SweptShape`]).
//! - Several crates: AABBs, areas, disjoint sets, pseudo-random numbers, numbers in messages, vertices at equal positions, and exact
//!   tests of simplices that share vertices or move.
//!
//! These items change more often than those at the root.

pub use crate::certificates::{
    BUILD, CertificateParts, DEFAULT_BUDGET, DEFAULT_EPSILON, DEFAULT_LOCAL_BUDGET, DEFAULT_REACH, Digest,
    LocalBounds, LocalCertificates, PairTree, Prover, RunJobs, Scope, ShardWorker, check_filter,
    compute_in_shards, default_exceptions, is_reach, is_within_reach,
};
pub use crate::curves::{
    ContactCurve, ContactCurves, CurvePoint, MeshFeature, PairContact, Surface, contact_curves,
    contact_curves_between,
};
pub use crate::detect::{
    BodyPenetration, body_penetration, detector_with_weld_classes, surroundings_between_meshes,
};
pub use crate::disjoint_sets::DisjointSets;
pub use crate::error::short_number;
pub use crate::filter::{GroupTable, check_continuous, check_models, weld_classes_of_positions};
pub use crate::geometry::{
    Aabb, Feature, Intersection, IntersectionPoint, Penetration, impact_edge_edge, impact_vertex_face,
    intersect_shared_edge_pair, intersect_shared_vertex_pair, intersection_triangle_triangle, orient2d,
    penetration_triangle_triangle,
};
pub use crate::hierarchy::{Hierarchy, Node};
pub use crate::model::{check_metric, vertex_areas};
pub use crate::posed::{Pose, PosedShape, SweptShape};
pub use crate::query::{ProvenShares, largest_depth};
pub use crate::random::{next_bits, next_uniform};
