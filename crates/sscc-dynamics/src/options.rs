//! What holds for a whole world.

use glam::DVec3;

use crate::{DynamicsError, Ground};

/// How contacts answer. Each is a spring with a damper that only pushes, as stiff as the masses that meet there ask
/// for: what counts is how fast it is. Contacts take energy, by damping and friction, and never give more than all
/// have taken before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Frequency (Hz) of a mass on the spring: a contact lasts about half a period, and what comes with a speed v is
    /// pressed in by about `v / (2 pi frequency)`.
    pub frequency: f64,
    /// Damping ratio. 0: as much comes back as came; see [`ContactOptions::restitution`].
    pub damping: f64,
    /// Coulomb's coefficient of friction between bodies.
    pub friction: f64,
    /// How far what was in contact is kept apart (model unit); none: a thousandth of the smallest body's radius. What
    /// rests is held by a spring within this distance, hence free of collisions while `frequency` is not too low: it
    /// must hold the weight, `(2 pi frequency)^2 skin` well above that of gravity.
    pub skin: Option<f64>,
    /// Rounds of the iteration that finds impulses, at most.
    pub rounds: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self { frequency: 100.0, damping: 0.3, friction: 0.4, skin: None, rounds: 8 }
    }
}

impl ContactOptions {
    /// Angular frequency (1/s).
    pub fn rate(&self) -> f64 {
        std::f64::consts::TAU * self.frequency
    }

    /// The share of its speed with which a mass leaves a contact, when steps are short: `exp(-zeta t)`, where t is
    /// the time, times the angular frequency, after which spring and damper together no longer push.
    pub fn restitution(&self) -> f64 {
        let zeta = self.damping;
        // x'' + 2 zeta x' + x = 0 from x = 0, x' = 1: the force 2 zeta x' + x ends.
        if zeta < 1.0 {
            let d = (1.0 - zeta * zeta).sqrt();
            let t = libm::atan2(2.0 * zeta * d, 2.0 * zeta * zeta - 1.0) / d;
            libm::exp(-zeta * t)
        } else if zeta == 1.0 {
            libm::exp(-2.0)
        } else {
            let d = (zeta * zeta - 1.0).sqrt();
            let t = libm::atanh(2.0 * zeta * d / (2.0 * zeta * zeta - 1.0)) / d;
            libm::exp(-zeta * t)
        }
    }
}

/// What becomes of bodies that would collide with themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Response {
    /// Colliding triangles push each other out.
    #[default]
    Contact,
    /// q is kept inside the ellipsoid that the root's certificate proves free (paper, section 7): nothing has to be
    /// detected.
    Constrain,
    /// Nothing: bodies pass through themselves.
    Ignore,
}

/// What holds for a whole world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldOptions {
    /// Time of a step (s).
    pub step: f64,
    /// Acceleration (model unit per s^2).
    pub gravity: DVec3,
    /// If there is one.
    pub ground: Option<Ground>,
    /// How contacts answer.
    pub contact: ContactOptions,
    /// What becomes of bodies that would collide with themselves.
    pub response: Response,
}

impl Default for WorldOptions {
    /// Steps of a millisecond, weight of 9.81 m/s^2 along -y, the ground at y = 0.
    fn default() -> Self {
        Self {
            step: 1e-3,
            gravity: DVec3::new(0.0, -9.81, 0.0),
            ground: Some(Ground::default()),
            contact: ContactOptions::default(),
            response: Response::default(),
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
        let least = |what, value: f64, ok: bool, range| {
            if value.is_finite() && ok { Ok(()) } else { Err(DynamicsError::Option { what, value, range }) }
        };
        let (contact, positive, natural) = (self.contact, "positive and finite", "finite and at least 0");
        least("gravity", self.gravity.length(), true, "finite")?;
        least("the frequency of contacts", contact.frequency, contact.frequency > 0.0, positive)?;
        least("the damping of contacts", contact.damping, contact.damping >= 0.0, natural)?;
        least("friction", contact.friction, contact.friction >= 0.0, natural)?;
        let skin = contact.skin.unwrap_or(1.0);
        least("the skin", skin, skin > 0.0, positive)?;
        let rounds = contact.rounds as f64;
        least("the number of rounds", rounds, rounds >= 1.0, "at least 1")?;
        if let Some(ground) = self.ground {
            let length = ground.normal.length();
            least("the length of the ground's normal", length, (length - 1.0).abs() < 1e-9, "1")?;
            least("the ground's height", ground.height, true, "finite")?;
            least("the ground's friction", ground.friction, ground.friction >= 0.0, natural)?;
        }
        Ok(())
    }
}
