//! Which q are measured, and the weight of each in a mean.

mod blocks;
mod directions;
mod strata;

pub use blocks::{blocks, evenly_spread};
pub use directions::{directions, half_diagonal, largest_displacement, scaled, unit_displacements};
pub use strata::{Counts, Strata, Stratum, weighted_mean};
