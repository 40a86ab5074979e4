//! The lowest eigenvectors of `K x = lambda M x`.

mod basis;
mod count;
pub(crate) mod dense;
mod lanczos;
#[cfg(test)]
pub(crate) mod lattice;
mod lowest_modes;
mod shift;
mod space;
pub(crate) mod tall_matrix;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use lowest_modes::{LowestModes, fix_signs, lowest_modes};
