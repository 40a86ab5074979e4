//! The lowest eigenvectors of `K x = lambda M x`.

mod basis;
mod count;
pub(crate) mod dense;
mod lanczos;
#[cfg(test)]
pub(crate) mod lattice;
mod lowest;
mod shift;
mod space;
pub(crate) mod tall;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use lowest::{Lowest, fix_signs, lowest_modes};
