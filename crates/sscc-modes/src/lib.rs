//! Where deformation modes come from, and shapes to try them on.
//!
//! - [`polynomial_modes`]: displacements that are quadratic polynomials of the rest position (paper,
//!   section 7), for any surface, without a material or a solid mesh;
//! - [`filter_eigenvalues`] and [`energy_metric`]: weights of modes from their stiffness (paper, section 6);
//! - [`shapes`]: example meshes made in code, so that nothing has to be downloaded.
//!
//! Everything here gives the same bits on every machine: sums have a fixed order, and sines and
//! cosines come from `libm`, not from the platform.

mod energy;
mod error;
mod orthonormal;
mod polynomial;
pub mod shapes;

pub use energy::{DEFAULT_ELL, energy_metric, filter_eigenvalues};
pub use error::ModesError;
pub use polynomial::polynomial_modes;
