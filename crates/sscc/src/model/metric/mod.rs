//! Metrics of q-space: how long a deformation is (paper, section 6).

mod defaults;
mod kind;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod metric;
mod norm;
mod range;
mod triangular;

pub use defaults::vertex_areas;
pub use kind::MetricKind;
pub use metric::Metric;
pub(crate) use range::check_scaled_modes;
