//! Dynamics of reduced deformable models (paper, section 7): how q and the rigid motion change with time.
//!
//! - [`LinearOscillator`]: linear modes, each one advanced exactly;
//! - [`NonlinearOscillator`]: reduced St. Venant-Kirchhoff forces, advanced by the implicit Newmark method;
//! - [`RigidMotion`]: position, orientation and momenta of a free body.
//!
//! All of them take fixed steps, and give the same bits in every run. Units are the model's: where the material is in SI
//! units, times are seconds. q are mass-orthonormal coordinates, so generalised forces are accelerations of q.

mod body;
mod constrain;
mod contact;
mod contacts;
mod crossing;
mod depth;
mod detect;
mod error;
mod ground;
mod linear;
mod materials;
mod nearest;
mod nonlinear;
mod options;
mod rigid;
mod shape;
mod solve;
mod sound;
mod state;
mod world;

pub use body::{Body, Detection, Start};
pub use depth::DepthField;
pub use error::{DynamicsError, Obstacle};
pub use ground::Ground;
pub use linear::{Damping, LinearOscillator};
pub use materials::{MATERIALS, SoundMaterial};
pub use nonlinear::NonlinearOscillator;
pub use options::{ContactOptions, Response, WorldOptions};
pub use rigid::RigidMotion;
pub use shape::{Elasticity, Shape};
pub use sound::SoundBank;
pub use state::State;
pub use world::{Counts, Impulse, Observer, Phase, World};
