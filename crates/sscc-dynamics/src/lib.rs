//! Dynamics of reduced deformable models (paper, section 7): bodies that fall, touch, hit themselves and each other,
//! and sound.
//!
//! - [`Shape`]: a model with certificates, elasticity, mass and material depth, shared by all bodies of its kind;
//! - [`World`]: bodies, ground and contacts, step by step. It knows no clock: an [`Observer`] is told when a phase of
//!   a step begins;
//! - [`State`]: all that changes, as plain numbers, to go on later with the same bits;
//! - [`SoundBank`]: modes that contact impulses strike, sample by sample;
//! - [`LinearOscillator`], [`NonlinearOscillator`] and [`RigidMotion`], of which bodies are made.
//!
//! ```
//! use glam::DVec3;
//! use sscc::{Certificates, CertifyOptions, Modes, ReducedModel};
//! use sscc_dynamics::{Shape, Start, World, WorldOptions};
//! use sscc_modes::linear_modes;
//! use sscc_solid::{Material, Solid};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A cube of a metre with its lowest vibrations; all its vertices are on the boundary.
//! let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
//! let vertices = corners.map(|corner| DVec3::from_array(corner.map(f64::from))).to_vec();
//! let solid = Solid::uniform(vertices, vec![], vec![[0, 1, 2, 3, 4, 5, 6, 7]], Material::default())?;
//! let found = linear_modes(&solid, &[], 6, &())?;
//! let model = ReducedModel::new(solid.boundary()?.mesh, found.modes)?;
//! let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
//! let shape = Shape::new(model, certificates, found.elasticity, solid.mass_properties())?;
//!
//! let mut world = World::new(WorldOptions::default())?;
//! world.add(&shape, &Start { position: Some(DVec3::Y), ..Start::default() })?;
//! world.check_start()?;
//! for _ in 0..400 {
//!     world.advance(&mut ())?;
//! }
//! assert!(world.bodies()[0].rigid().position.y > 0.4); // it lies on the ground, not in it
//! # Ok(())
//! # }
//! ```
//!
//! # What is promised
//!
//! - **The same bits** in every run, for any number of threads, for every exact method of [`Detection`], and after a
//!   restart.
//! - **Collisions are exact**: within a body those of [`sscc::Query`], between bodies those of the f64 positions
//!   [`Body::pose`] applied to `p + U q`, down to pairs of triangles.
//! - **Contacts never add energy**, up to rounding: they give back no more than they have taken
//!   ([`World::dissipated`]), whatever stiffness and step are. Linear modes and free flight keep it up to rounding,
//!   tumbling and Newmark's method to second order in the step.
//! - **Momenta are kept** exactly between bodies and within them.
//!
//! # Limitations
//!
//! The motion of the frame does not act on q (no centrifugal forces), and deformation does not change the inertia.
//! Contacts are found at the ends of steps: what moves farther in a step than it is thick passes through. A contact
//! pushes along the direction found when it began, where two bodies have interlocked that may be the wrong one.
//!
//! Units are the model's: where the material is in SI units, times are seconds. q are mass-orthonormal coordinates,
//! so generalised forces are accelerations of q.

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
mod near_ground;
mod nearest_point;
mod nonlinear;
mod normals;
mod options;
mod rigid;
mod shape;
mod solve;
mod sound;
mod state;
mod step;
mod world;

pub use body::{Body, Detection, Start};
pub use depth::{DepthField, SignedDistance};
pub use detect::BodyPairs;
pub use error::{DynamicsError, Obstacle};
pub use ground::Ground;
pub use linear::{Damping, LinearOscillator};
pub use materials::{MATERIALS, SoundMaterial};
pub use nonlinear::NonlinearOscillator;
pub use options::{ContactOptions, Response, WorldOptions};
pub use rigid::RigidMotion;
pub use shape::Shape;
pub use sound::SoundBank;
pub use state::State;
pub use step::{Counts, Impulse, Observer, Phase};
pub use world::World;
