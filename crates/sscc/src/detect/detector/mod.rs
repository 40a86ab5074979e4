//! The public detector for given positions: any deforming mesh, without modes.

mod against;
mod batch;
mod boxes;
mod clearance;
mod clearance_search;
mod common_ball;
mod components;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod detector;
mod detector_search;
mod enclosed;
mod facing;
mod given_motion;
mod nearest;
mod penetration;
mod shared_volume;
mod statistics;
mod surroundings;

pub use clearance::Clearance;
pub(crate) use clearance::near_pairs_of_model;
pub(crate) use detector::detector_of_model;
pub use detector::{Detector, detector_with_weld_classes};
pub use enclosed::Enclosed;
pub use penetration::{BodyPenetration, body_penetration};
pub use surroundings::surroundings_between_meshes;
