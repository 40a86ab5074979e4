//! Plots of measurements: on a page and as SVG.

mod cost_over_time;
mod page;
mod svg;

pub use cost_over_time::cost_over_time;
pub use page::BenchPage;
pub use svg::{Line, SvgPlot, YAxis, stacked};
