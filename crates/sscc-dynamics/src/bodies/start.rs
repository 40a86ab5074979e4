//! Initial state and settings of a body.

use glam::{DQuat, DVec3};
use sscc::Method;

use crate::Damping;

/// How a body detects self-collisions. All exact methods find the same pairs, hence give the same motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detection {
    /// Certified discrete query ([`sscc::Query`]) in each step.
    #[default]
    Certified,
    /// Kinetic query ([`sscc::KineticQuery`]), which reuses safe distances of earlier steps.
    Kinetic,
    /// Discrete query with this method.
    Method(Method),
    /// No detection: the body can pass through itself.
    Off,
}

/// Initial state and settings of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Whether the body has rigid motion. A held body (false) keeps its pose, and its modes must be those of a held
    /// shape.
    pub is_free: bool,
    /// Position of the centre of mass (model unit). None means the position in the rest pose.
    pub position: Option<DVec3>,
    /// Rotation from axes of the rest pose to axes of the world.
    pub orientation: DQuat,
    /// Velocity of the centre of mass (model unit per s).
    pub velocity: DVec3,
    /// Angular velocity in axes of the world (rad/s).
    pub spin: DVec3,
    /// Initial q (r numbers). An empty list means zeros.
    pub q: Vec<f64>,
    /// Initial rate of q (r numbers, 1/s). An empty list means zeros.
    pub v: Vec<f64>,
    /// Damping of the modes.
    pub damping: Damping,
    /// Method of self-collision detection.
    pub detection: Detection,
}

impl Default for Start {
    fn default() -> Self {
        Self {
            is_free: true,
            position: None,
            orientation: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
            q: Vec::new(),
            v: Vec::new(),
            damping: Damping::default(),
            detection: Detection::default(),
        }
    }
}
