//! Reports of meshes without modes: the positions of each frame, with their colliding pairs and contact curves.

mod contact_segments;
mod node_pairs;
mod recorded_body;
mod recording;
mod report;

pub use report::MeshReport;
