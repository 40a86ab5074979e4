//! Reports of simulations.

mod playback;
mod plots;
mod report;

pub use report::simulation_report;
