//! Where deformation modes come from, and shapes to try them on.
//!
//! - [`polynomial_modes`]: displacements that are quadratic polynomials of the rest position (paper,
//!   section 7), for any surface, without a material or a solid mesh;
//! - [`diagonalize`]: modes rotated so that a given stiffness becomes diagonal (paper, section 6), with
//!   [`reduced_stiffness`] before it, and [`filter_eigenvalues`] and [`energy_metric`] after it;
//! - [`shapes`]: example meshes made in code, so that nothing has to be downloaded.
//!
//! Everything here gives the same bits on every machine: sums have a fixed order, and sines and
//! cosines come from `libm`, not from the platform. The exception is [`diagonalize`]: its eigenvectors are
//! rounded as the vector instructions of the processor do.

mod diagonalize;
mod energy;
mod error;
mod orthonormal;
mod polynomial;
pub mod shapes;
mod stiffness;

pub use diagonalize::{Diagonalized, diagonalize};
pub use energy::{DEFAULT_ELL, energy_metric, filter_eigenvalues};
pub use error::ModesError;
pub use polynomial::polynomial_modes;
pub use stiffness::reduced_stiffness;
