//! Collision detection without certificates: finds the colliding triangles of a deforming mesh.
//!
//! The broad phase ([`search`], [`traversal`]) descends pairs of nodes by their bounding volumes ([`node_volumes`]),
//! down to buckets of at most 64 triangles ([`buckets`]), whose boxes are compared eight at a time ([`aabb8`]). Volumes
//! are computed for the nodes that a traversal visits (the BD-tree, James and Pai 2004), or all are refitted at once.
//! The discrete narrow phase ([`narrow_phase`]) is exact. The source of vertex positions is a static parameter
//! ([`vertex_motion`]).
//!
//! The methods without certificates (traditional, BD-tree, normal cones, brute force) are here. The traversals that use
//! certificates are in `query/`; they use the same tests of nodes and buckets.

pub(crate) mod aabb8;
mod adjacency_masks;
pub(crate) mod answer;
mod bd_tree;
pub(crate) mod broad_phase;
mod brute_force;
pub(crate) mod bucket_pair;
pub(crate) mod buckets;
mod candidates;
mod coarse_positions;
mod coarse_vertices;
mod colliding_pairs;
pub(crate) mod context;
mod contour_test;
mod detector;
mod exact_positions;
pub(crate) mod f32_frame;
mod frame_map;
pub(crate) mod layout;
mod moving_modes;
pub(crate) mod narrow_phase;
mod node_boundaries;
pub(crate) mod node_volumes;
pub(crate) mod normal_cones;
mod quantization;
pub(crate) mod search;
mod traversal;

pub(crate) mod vertex_motion;
mod vertex_store;

pub use answer::{Answer, Proof, Statistics};
pub(crate) use colliding_pairs::colliding_pairs;
pub use detector::{
    BodyPenetration, Clearance, Detector, Enclosed, body_penetration, detector_with_weld_classes,
    surroundings_between_meshes,
};
pub(crate) use detector::{detector_of_model, near_pairs_of_model};
pub use narrow_phase::{Impact, NearPair};
