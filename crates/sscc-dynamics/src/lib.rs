//! Dynamics of reduced deformable models (paper, section 7): how q and the rigid motion change with time.
//!
//! - [`LinearOscillator`]: linear modes, each one advanced exactly;
//! - [`NonlinearOscillator`]: reduced St. Venant-Kirchhoff forces, advanced by the implicit Newmark method;
//! - [`RigidMotion`]: position, orientation and momenta of a free body.
//!
//! All of them take fixed steps, and give the same bits in every run. Units are the model's: where the material is in SI
//! units, times are seconds. q are mass-orthonormal coordinates, so generalised forces are accelerations of q.

mod error;
mod linear;
mod nonlinear;
mod rigid;

pub use error::DynamicsError;
pub use linear::{Damping, LinearOscillator};
pub use nonlinear::NonlinearOscillator;
pub use rigid::RigidMotion;
