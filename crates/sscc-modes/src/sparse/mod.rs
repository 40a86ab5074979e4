//! Sparse symmetric matrices, their factors, and their lowest eigenvectors.

mod block;
mod dissection;
mod factor;
mod lanczos;
mod lowest;

pub(crate) use block::{BlockSparse, FIXED};
pub(crate) use factor::{Cholesky, Symbolic};
pub(crate) use lowest::{Lowest, Pencil, fix_signs, lowest_modes};
