//! The public detector for given positions: any deforming mesh, without modes.

mod against;
mod batch;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod detector;
mod detector_search;
mod given_motion;
mod statistics;

pub use detector::{Detector, detector_with_weld_classes};
