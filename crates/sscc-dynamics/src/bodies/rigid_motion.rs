//! Rigid motion of a free body (floating frame).

use glam::{DMat3, DQuat, DVec3};
use sscc_solid::MassProperties;

use crate::DynamicsError;

/// Position, orientation and momenta of a body. The inertia is that of the rest pose, which small deformations change
/// little.
///
/// Forces act as impulses between steps. During a step the body moves freely and both momenta are constant.
#[derive(Clone, Copy, Debug)]
pub struct RigidMotion {
    properties: MassProperties,
    inverse: DMat3,
    /// Position of the centre of mass (model unit).
    pub position: DVec3,
    /// Rotation from axes of the rest pose to axes of the world.
    pub orientation: DQuat,
    /// Linear momentum.
    pub momentum: DVec3,
    /// Angular momentum about the centre of mass, in axes of the world.
    pub angular_momentum: DVec3,
}

/// Maximum number of iterations for the angular velocity at the middle of a step. Each iteration multiplies the error
/// by about the angle of the step.
const MAX_ITERATIONS: usize = 20;

impl RigidMotion {
    /// Creates the motion of a body at rest in its rest pose.
    ///
    /// # Errors
    /// When mass or inertia are not positive and finite.
    pub fn new(properties: MassProperties) -> Result<Self, DynamicsError> {
        let MassProperties { mass, center, inertia } = properties;
        let inverse = inertia.inverse();
        // The inertia is positive definite if its leading minors are positive (Sylvester).
        let [x, y, _] = [inertia.x_axis, inertia.y_axis, inertia.z_axis];
        let minors = [x.x, x.x * y.y - x.y * y.x, inertia.determinant()];
        let min_minor = minors.into_iter().fold(f64::INFINITY, f64::min);
        let is_valid = |x: f64| x.is_finite() && x > 0.0;
        if !is_valid(mass) || !minors.into_iter().all(is_valid) || !inverse.is_finite() || !center.is_finite()
        {
            return Err(DynamicsError::Mass { mass, inertia: min_minor });
        }
        Ok(Self {
            properties,
            inverse,
            position: center,
            orientation: DQuat::IDENTITY,
            momentum: DVec3::ZERO,
            angular_momentum: DVec3::ZERO,
        })
    }

    /// Returns the velocity of the point at `arm` from the centre of mass (axes of the world).
    pub(crate) fn velocity_at(&self, arm: DVec3) -> DVec3 {
        self.momentum / self.properties.mass + self.angular_velocity().cross(arm)
    }

    /// Returns the angular velocity (rad/s), in axes of the world.
    pub fn angular_velocity(&self) -> DVec3 {
        self.spin(self.orientation)
    }

    /// Returns the inverse of the inertia tensor, in axes of the rest pose.
    pub(crate) fn inverse_inertia(&self) -> DMat3 {
        self.inverse
    }

    /// Returns the inertia tensor, in axes of the world.
    pub(crate) fn inertia(&self) -> DMat3 {
        let rotation = DMat3::from_quat(self.orientation);
        rotation * self.properties.inertia * rotation.transpose()
    }

    /// Returns the angular velocity (rad/s, axes of the world) at an orientation.
    fn spin(&self, orientation: DQuat) -> DVec3 {
        orientation * (self.inverse * (orientation.inverse() * self.angular_momentum))
    }

    /// Advances free motion by h seconds. The rotation uses the angular velocity at the midpoint of the step, which
    /// conserves energy to second order, without drift.
    pub fn advance(&mut self, h: f64) {
        self.position += self.momentum * (h / self.properties.mass);
        let mut spin = self.angular_velocity();
        for _ in 0..MAX_ITERATIONS {
            let middle = DQuat::from_scaled_axis(spin * (h / 2.0)) * self.orientation;
            let next = self.spin(middle);
            if (next - spin).length() <= 1e-15 * next.length() {
                break;
            }
            spin = next;
        }
        self.orientation = (DQuat::from_scaled_axis(spin * h) * self.orientation).normalize();
    }

    /// Returns the kinetic energy of the rigid motion.
    pub fn energy(&self) -> f64 {
        let linear = self.momentum.length_squared() / (2.0 * self.properties.mass);
        linear + self.angular_momentum.dot(self.angular_velocity()) / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn top() -> RigidMotion {
        let inertia =
            DMat3::from_cols(DVec3::new(1.0, 0.1, 0.0), DVec3::new(0.1, 2.0, 0.2), DVec3::new(0.0, 0.2, 2.5));
        RigidMotion::new(MassProperties { mass: 3.0, center: DVec3::new(1.0, 2.0, 3.0), inertia }).unwrap()
    }

    #[test]
    fn a_tumbling_body_keeps_momenta_and_energy() {
        let mut body = top();
        body.momentum = DVec3::new(1.0, -2.0, 0.5);
        body.angular_momentum = DVec3::new(2.3, 4.5, -1.9); // near the middle axis: it tumbles
        let (momentum, angular, energy) = (body.momentum, body.angular_momentum, body.energy());
        let mut max_change = 0.0_f64;
        for _ in 0..10_000 {
            body.advance(1e-2);
            max_change = max_change.max((body.orientation * DVec3::Y - DVec3::Y).length());
            assert!((body.energy() / energy - 1.0).abs() < 1e-3);
        }
        assert_eq!((body.momentum, body.angular_momentum), (momentum, angular));
        let expected = DVec3::new(1.0, 2.0, 3.0) + momentum / 3.0 * 100.0;
        assert!((body.position - expected).length() < 1e-9);
        assert!(max_change > 1.5, "{max_change}");
    }

    #[test]
    fn a_spinning_body_turns_at_its_rate() {
        let mut body = top();
        let inertia = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.5));
        body = RigidMotion::new(MassProperties { inertia, ..body.properties }).unwrap();
        body.angular_momentum = DVec3::Z * 2.5;
        for _ in 0..1000 {
            body.advance(1e-3);
        }
        let p = body.orientation * DVec3::X; // one radian about z
        assert!((p - DVec3::new(libm::cos(1.0), libm::sin(1.0), 0.0)).length() < 1e-12);
        assert!((body.angular_velocity() - DVec3::Z).length() < 1e-12);
    }

    #[test]
    fn invalid_mass_properties_are_refused() {
        let valid = top().properties;
        let flat = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0));
        for wrong in [
            MassProperties { mass: 0.0, ..valid },
            MassProperties { mass: f64::NAN, ..valid },
            MassProperties { inertia: flat, ..valid },
            MassProperties { inertia: -valid.inertia, ..valid },
        ] {
            assert!(matches!(RigidMotion::new(wrong), Err(DynamicsError::Mass { .. })));
        }
    }
}
