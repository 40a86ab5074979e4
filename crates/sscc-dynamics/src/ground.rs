//! Ground plane of a world.

use glam::DVec3;

/// Ground plane. Its inside is the half-space `normal . x < height`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Unit normal, upwards.
    pub normal: DVec3,
    /// Value of `normal . x` on the plane (model unit).
    pub height: f64,
    /// Coulomb's coefficient of friction.
    pub friction: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Self { normal: DVec3::Y, height: 0.0, friction: 0.5 }
    }
}
