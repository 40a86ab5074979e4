//! Where deformation modes come from, and shapes to try them on.
//!
//! - [`polynomial_modes`]: displacements that are quadratic polynomials of the rest position (paper,
//!   section 7), for any surface, without a material or a solid mesh;
//! - [`shapes`]: example meshes made in code, so that nothing has to be downloaded.
//!
//! Everything here gives the same bits on every machine: sums have a fixed order, and sines and
//! cosines come from `libm`, not from the platform.

mod error;
mod orthonormal;
mod polynomial;
pub mod shapes;

pub use error::ModesError;
pub use polynomial::polynomial_modes;
