//! The model: a mesh at rest, its modes, the metric of q-space, and the modes in scaled coordinates (paper, sections 3
//! and 6).

mod mesh;
mod metric;
pub(crate) mod mode_rows;
mod modes;
mod reduced_model;
mod required_gap;
pub(crate) mod rounding;
mod rounding_bound;
mod scaled_model;
mod weight_limit;

pub use mesh::TriMesh;
pub(crate) use metric::check_scaled_modes;
pub use metric::{Metric, MetricKind, check_metric, vertex_areas};
pub use modes::{Modes, deformed_position};
pub use reduced_model::ReducedModel;
pub(crate) use rounding_bound::{LeastGap, RoundingBound, scale_direction};
pub(crate) use scaled_model::ScaledModel;
