//! Dynamics of reduced deformable models with self-collisions, collisions between bodies, ground contact and sound
//! (paper, section 7).
//!
//! - [`Shape`]: a model with certificates, elasticity, mass and material depth, shared by all bodies that use it;
//! - [`World`]: bodies, ground and contacts, advanced in fixed time steps. The crate reads no clock: a caller that
//!   measures time implements [`Observer`], whose method runs at the start of each phase of a step;
//! - [`State`]: the state of a world as plain numbers. A restored world continues with the same bits;
//! - [`SoundBank`]: sound of modes that contact impulses excite, computed sample by sample;
//! - [`LinearOscillator`], [`NonlinearOscillator`] and [`RigidMotion`]: the integrators of a body; [`ElasticEnergy`]:
//!   the polynomial whose gradient the nonlinear forces are.
//!
//! ```
//! use glam::DVec3;
//! use sscc::{Certificates, CertifyOptions, Modes, ReducedModel};
//! use sscc_dynamics::{Shape, Start, World, WorldOptions};
//! use sscc_modes::linear_modes;
//! use sscc_solid::{Material, Solid};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A cube with sides of 1 m and its six lowest modes. All vertices are on the boundary.
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
//! assert!(world.bodies()[0].rigid().position.y > 0.4); // the cube rests on the ground
//! # Ok(())
//! # }
//! ```
//!
//! # Guarantees
//!
//! - **Determinism.** A world has the same bits in every run and for any number of threads. It also has the same bits for
//!   every exact method of [`Detection`] and after a restart, except where triangles of a body pass each other within
//!   [`sscc::Impact::TOLERANCE`] without contact: there methods may differ in whether this is an impact, and so may kinetic
//!   detection after a restart.
//! - **Exact collisions.** Collisions within a body are those of [`sscc::Query`]. Collisions between bodies are those
//!   of the f64 positions [`Body::pose`] applied to `p + U q`, down to pairs of triangles.
//! - **Contacts never add energy**, up to rounding: they return at most the energy that they have dissipated
//!   ([`World::dissipated`]), for every stiffness and step. Linear modes and free flight conserve energy up to
//!   rounding; tumbling conserves it to second order in the step. Newmark's method may add 2% of the energy of nonlinear
//!   modes; steps that would add more, and steps without a solution, use a mean force that adds none, in shorter parts where
//!   no whole step has a solution.
//! - **No intersections** between bodies, within them ([`Response::Contact`]) and with the ground in any state, if there are
//!   none in the first state: swept queries prove each step.
//! - **Momenta** are conserved exactly between bodies and within them, except where a body moves only a part of its motion in
//!   a step.
//! - **Bodies at rest sleep** ([`SleepOptions`]), and cost nothing until a moving body touches them.
//!
//! # Limitations
//!
//! The motion of the frame exerts no force on q (no centrifugal forces), and deformation does not change the inertia. Bodies
//! that no correction keeps apart, or whose corrected end has more elastic energy than is available, move only a part of
//! their motion in a step, which conserves no angular momentum ([`World::shortened_bodies`]). Bodies that intersect
//! themselves or others at the start pass through until they are free.
//!
//! Units are those of the model: if the material is in SI units, times are seconds. The coordinates q are
//! mass-orthonormal, so generalised forces are accelerations of q.

mod bodies;
mod contacts;
mod error;
mod ground;
mod nearest_point;
mod options;
mod packed_rows;
mod sound;
mod state;
mod step;
#[cfg(test)]
mod test_shapes;
mod world;

pub use bodies::{
    Body, Damping, DepthField, Detection, ElasticEnergy, Evaluation, LinearOscillator, NewmarkBuffers,
    NonlinearOscillator, RigidMotion, Shape, SignedDistance, Start,
};
pub use contacts::BodyPairs;
pub use error::{DynamicsError, Obstacle};
pub use ground::Ground;
pub use options::{ContactOptions, Response, SleepOptions, WorldOptions};
pub use sound::{MATERIALS, SoundBank, SoundMaterial};
pub use state::State;
pub use step::{Counts, Impulse, Observer, Phase};
pub use world::World;
