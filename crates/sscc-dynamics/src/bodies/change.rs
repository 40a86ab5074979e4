//! Change of the motion of a body in a step.

use glam::DVec3;

/// Impulse on a body, and the change of its rigid motion.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Change {
    /// Change of the momentum.
    pub impulse: DVec3,
    /// Change of the angular momentum.
    pub angular_impulse: DVec3,
    /// Change of the velocity of the centre of mass.
    pub velocity: DVec3,
    /// Change of the angular velocity (axes of the world).
    pub angular_velocity: DVec3,
}
