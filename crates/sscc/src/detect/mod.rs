//! The detector: broad phase, narrow phase and the methods that use no certificates.

pub(crate) mod adjacency;
pub(crate) mod ball;
pub(crate) mod bd_tree;
pub(crate) mod brute_force;
pub(crate) mod buckets;
pub(crate) mod coarse;
pub(crate) mod contour;
pub(crate) mod frame;
pub(crate) mod narrow_phase;
pub(crate) mod normal_cones;
pub(crate) mod packet;
pub(crate) mod positions;
pub(crate) mod quantization;
pub(crate) mod search;
pub(crate) mod separating_axis;
pub(crate) mod tables;
pub(crate) mod vertices;
pub(crate) mod volumes;
