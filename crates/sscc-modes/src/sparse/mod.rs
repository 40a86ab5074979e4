//! Sparse symmetric matrices with 3 rows for each vertex, and their factors.

mod block;
mod dissection;
mod factor;
mod inertia;

pub(crate) use block::{BlockSparse, FIXED};
pub(crate) use factor::{Analysis, Cholesky};
pub(crate) use inertia::count_negative_eigenvalues;
