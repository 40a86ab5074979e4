//! Reduced models `x = p + U q`: the mesh at rest, its modes, the metric in which radii are measured, and the modes in
//! scaled coordinates (paper, sections 3 and 6).

mod mesh;
mod metric;
mod modes;
mod reduced_model;
pub(crate) mod rows;
mod scaled;

pub use mesh::TriMesh;
pub(crate) use metric::check_scaled_modes;
pub use metric::{Metric, MetricKind, vertex_areas};
pub use modes::{Modes, deformed_position};
pub use reduced_model::ReducedModel;
pub(crate) use scaled::{DOWN, GapError, ScaledModel, UP, direction, norm_up, quotient_down, radius};
