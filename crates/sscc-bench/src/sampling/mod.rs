//! Chooses the measured q, and their weights in means.

mod blocks;
mod directions;
mod strata;

pub use blocks::{blocks, evenly_spread};
pub use directions::{directions, half_diagonal, largest_displacement, scaled, unit_displacements};
pub use strata::{Counts, Strata, Stratum, weighted_mean, weighted_median};
