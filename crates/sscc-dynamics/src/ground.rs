//! The ground: a plane.

use glam::DVec3;

/// A plane that nothing passes; inside is where `normal . x < height`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Upwards, of length 1.
    pub normal: DVec3,
    /// `normal . x` on the plane (model unit).
    pub height: f64,
    /// Coulomb's coefficient of friction.
    pub friction: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Self { normal: DVec3::Y, height: 0.0, friction: 0.5 }
    }
}
