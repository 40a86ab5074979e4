//! Proven self-collision detection for reduced deformable models.

mod audit;
mod bounds;
mod certificates;
mod error;
pub mod hierarchy;
mod intersect;
pub mod limits;
mod mesh;
mod metric;
mod model;
mod modes;
mod progress;
mod query;

pub use audit::{AuditOptions, AuditReport, audit};
pub use certificates::{CertificateParts, Certificates, CertifyOptions, Digest, metric_names};
pub use error::Error;
pub use intersect::intersect_triangle_triangle;
pub use mesh::TriMesh;
pub use metric::{Metric, MetricKind, vertex_areas};
pub use model::ReducedModel;
pub use modes::{Modes, deformed_position};
pub use progress::Progress;
pub use query::{Method, Query, Statistics};
