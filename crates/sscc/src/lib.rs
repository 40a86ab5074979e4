//! Proven self-collision detection for reduced deformable models.

mod error;
mod intersect;
pub mod limits;
mod mesh;
mod metric;
mod model;
mod modes;

pub use error::Error;
pub use intersect::intersect_triangle_triangle;
pub use mesh::TriMesh;
pub use metric::{Metric, MetricKind, vertex_areas};
pub use model::ReducedModel;
pub use modes::{Modes, deformed_position};
