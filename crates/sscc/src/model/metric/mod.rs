//! Metrics of q-space, which define the length of a deformation (paper, section 6).

mod defaults;
mod kind;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod metric;
mod norm;
mod scaled_modes_check;
mod triangular;

pub use defaults::vertex_areas;
pub use kind::MetricKind;
pub use metric::Metric;
pub use scaled_modes_check::check_metric;
pub(crate) use scaled_modes_check::check_scaled_modes;
