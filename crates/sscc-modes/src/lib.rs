//! Computes deformation modes, and provides example shapes.
//!
//! - [`polynomial_modes`]: displacements that are quadratic polynomials of the rest position (paper,
//!   section 7), for any surface, without a material or a solid mesh;
//! - [`diagonalize`]: modes rotated so that a given stiffness becomes diagonal (paper, section 6), after
//!   [`reduced_stiffness`], and before [`filter_eigenvalues`] and [`energy_metric`];
//! - [`EmbeddedSurface`], [`linear_modes`], [`nonlinear_modes`], [`polynomial_solid_modes`]: modes of elastic solids;
//! - [`static_configuration`] and [`DisplacementFit`]: q of a load, and of given displacements;
//! - [`pca_modes`]: the principal components of an animation;
//! - [`shapes`]: example meshes that are computed, so that no download is needed.
//!
//! A model in two lines, for a first try or a test:
//!
//! ```
//! use sscc::ReducedModel;
//! use sscc_modes::{polynomial_modes, shapes};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let spring = shapes::spring();
//! let modes = polynomial_modes(&spring)?;
//! let model = ReducedModel::new(spring, modes)?;
//! assert_eq!((model.mesh().faces().len(), model.rank()), (16_000, 24));
//! # Ok(())
//! # }
//! ```
//!
//! Modes from other programs do not need this crate: [`sscc::Modes`] takes any matrix. With the stiffness of the solid,
//! the example at [`diagonalize`] gives a model whose metric is strain energy.
//!
//! All results have the same bits on every machine: sums have a fixed order, and sines and cosines come from `libm`.
//! The exceptions are [`diagonalize`], [`pca_modes`], the modes of solids, [`stiffness_eigenvalues`],
//! [`natural_frequencies`] of coupled modes, [`static_configuration`] and [`DisplacementFit`], whose linear algebra
//! depends on the vector instructions of the processor.

mod body;
mod cancel;
mod diagonalize;
mod eigen;
mod elasticity;
mod embedded_surface;
mod embedding;
mod energy;
mod error;
mod frequencies;
mod interpolation;
mod lattice;
mod nonlinear;
mod orthonormal_basis;
mod outside;
mod pca;
mod polynomial;
pub mod shapes;
mod sparse;
mod statics;
mod stiffness;
mod vibration;

pub use diagonalize::{DiagonalModes, diagonalize, stiffness_eigenvalues};
pub use embedded_surface::EmbeddedSurface;
pub use energy::{DEFAULT_ELL, energy_metric, filter_eigenvalues};
pub use error::ModesError;
pub use frequencies::{mode_frequencies, natural_frequencies};
pub use outside::Outside;
pub use pca::{Pca, pca_modes};
pub use polynomial::polynomial_modes;
pub use statics::{DisplacementFit, FittedConfiguration, generalized_forces, static_configuration};
pub use stiffness::reduced_stiffness;
pub use vibration::{PolynomialModes, SolidModes, linear_modes, nonlinear_modes, polynomial_solid_modes};
