//! Options of a world and of its contacts.

use glam::DVec3;

use crate::{DynamicsError, Ground};

/// Options of contacts. Contacts only push, dissipate energy by restitution and friction, and never return more than they have
/// dissipated. Intersecting triangles make springs with dampers, whose stiffness follows from the effective mass and the
/// frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Frequency (Hz) of the effective mass on the spring, and rate at which contacts widen gaps that are too small.
    pub frequency: f64,
    /// Damping ratio. With 0 the contact is elastic; see [`ContactOptions::restitution`].
    pub damping: f64,
    /// Coulomb's coefficient of friction between bodies.
    pub friction: f64,
    /// Distance within which surfaces are in contact (model unit); bodies at rest keep half of it. None means a thousandth of the
    /// smallest body's radius.
    pub skin: Option<f64>,
    /// Maximum number of iterations of the solver of the springs at intersecting triangles.
    pub iterations: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self { frequency: 100.0, damping: 0.3, friction: 0.4, skin: None, iterations: 8 }
    }
}

impl ContactOptions {
    /// Returns the angular frequency (rad/s).
    pub fn rate(&self) -> f64 {
        std::f64::consts::TAU * self.frequency
    }

    /// Returns the coefficient of restitution for short steps: `exp(-zeta t)`, where t is the time, times the angular
    /// frequency, at which the force of spring and damper ends.
    pub fn restitution(&self) -> f64 {
        let zeta = self.damping;
        // x'' + 2 zeta x' + x = 0 from x = 0, x' = 1; the contact ends when 2 zeta x' + x = 0.
        if zeta < 1.0 {
            let d = (1.0 - zeta * zeta).sqrt();
            let t = libm::atan2(2.0 * zeta * d, 2.0 * zeta * zeta - 1.0) / d;
            libm::exp(-zeta * t)
        } else if zeta == 1.0 {
            libm::exp(-2.0)
        } else {
            let d = (zeta * zeta - 1.0).sqrt();
            // Rounding may carry the argument beyond 1.
            let t = libm::atanh((2.0 * zeta * d / (2.0 * zeta * zeta - 1.0)).min(1.0)) / d;
            libm::exp(-zeta * t)
        }
    }
}

/// Conditions under which bodies at rest sleep. Bodies sleep together with all bodies that they touch, when none of them has
/// moved for a while and one of them touches the ground or a held body. They wake when a moving body touches one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SleepOptions {
    /// Time without motion after which bodies sleep (s). If infinite, bodies never sleep.
    pub time: f64,
    /// Distance within which all points of a body stay in this time (model unit). None means 1/50 of the body's radius.
    pub distance: Option<f64>,
}

impl Default for SleepOptions {
    fn default() -> Self {
        Self { time: 0.5, distance: None }
    }
}

/// Response of bodies to self-collisions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Response {
    /// Contacts keep a body free of self-collisions: swept queries prove each step.
    #[default]
    Contact,
    /// Springs push colliding triangles apart (penalty contacts; paper, section 7). Fast impacts and loads penetrate.
    Penalty,
    /// q stays inside the ellipsoid that the certificate of the root proves free (paper, section 7). No detection is
    /// needed.
    Constrain,
    /// No response: bodies pass through themselves.
    Ignore,
}

/// Options of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldOptions {
    /// Time step (s).
    pub step: f64,
    /// Acceleration of gravity (model unit per s^2).
    pub gravity: DVec3,
    /// Ground plane, if any.
    pub ground: Option<Ground>,
    /// Options of contacts.
    pub contact: ContactOptions,
    /// Response of bodies to self-collisions.
    pub response: Response,
    /// Conditions under which bodies at rest sleep.
    pub sleep: SleepOptions,
}

impl Default for WorldOptions {
    /// Returns options with a time step of 1 ms, gravity of 9.81 m/s^2 along -y, and the ground at y = 0.
    fn default() -> Self {
        Self {
            step: 1e-3,
            gravity: DVec3::new(0.0, -9.81, 0.0),
            ground: Some(Ground::default()),
            contact: ContactOptions::default(),
            response: Response::default(),
            sleep: SleepOptions::default(),
        }
    }
}

impl WorldOptions {
    /// # Errors
    /// When a number is outside its range.
    pub(crate) fn check(&self) -> Result<(), DynamicsError> {
        if !(self.step.is_finite() && self.step > 0.0) {
            return Err(DynamicsError::Step { step: self.step });
        }
        let check = |what, value: f64, ok: bool, range| {
            if value.is_finite() && ok { Ok(()) } else { Err(DynamicsError::Option { what, value, range }) }
        };
        let (contact, positive, natural) = (self.contact, "positive and finite", "finite and at least 0");
        check("gravity", self.gravity.length(), true, "finite")?;
        check("the frequency of contacts", contact.frequency, contact.frequency > 0.0, positive)?;
        check("the damping of contacts", contact.damping, contact.damping >= 0.0, natural)?;
        check("friction", contact.friction, contact.friction >= 0.0, natural)?;
        let skin = contact.skin.unwrap_or(1.0);
        check("the skin", skin, skin > 0.0, positive)?;
        let iterations = contact.iterations as f64;
        check("the number of iterations", iterations, iterations >= 1.0, "at least 1")?;
        if self.sleep.time.is_nan() || self.sleep.time <= 0.0 {
            let (what, value) = ("the time until bodies sleep", self.sleep.time);
            return Err(DynamicsError::Option { what, value, range: "above 0; infinite: never" });
        }
        let distance = self.sleep.distance.unwrap_or(1.0);
        check("the distance of sleep", distance, distance > 0.0, positive)?;
        if let Some(ground) = self.ground {
            let length = ground.normal.length();
            check("the length of the ground's normal", length, (length - 1.0).abs() < 1e-9, "1")?;
            check("the ground's height", ground.height, true, "finite")?;
            check("the ground's friction", ground.friction, ground.friction >= 0.0, natural)?;
        }
        Ok(())
    }
}
