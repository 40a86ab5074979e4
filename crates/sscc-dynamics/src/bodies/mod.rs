//! Bodies: the shapes that they share, their motion without contacts, and the detection of their self-collisions.
//!
//! No file in this folder uses other bodies, the ground or contacts.

mod body;
pub(crate) mod body_set;
pub(crate) mod change;
mod depth_field;
pub(crate) mod displacement;
pub(crate) mod kinematics;
mod oscillators;
mod pseudonormals;
mod rest;
mod rigid_motion;
pub(crate) mod root_constraint;
mod shape;
mod start;

pub use body::Body;
pub use depth_field::{DepthField, SignedDistance};
pub use oscillators::{
    Damping, ElasticEnergy, Evaluation, LinearOscillator, NewmarkBuffers, NonlinearOscillator,
};
pub use rigid_motion::RigidMotion;
pub use shape::Shape;
pub use start::{Detection, Start};
