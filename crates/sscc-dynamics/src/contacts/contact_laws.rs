//! Laws of contacts: the numbers that all contacts of a world share, the gap that they keep in a step, and how they bounce.

use crate::{Ground, Response, WorldOptions};

/// Numbers that all contacts of a world share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactLaws {
    /// Step (s).
    pub step: f64,
    pub ground: Option<Ground>,
    /// Response of bodies to self-collisions.
    pub response: Response,
    /// Coulomb's coefficient of friction between bodies.
    pub friction: f64,
    /// Distance below which surfaces are in contact (model unit).
    pub skin: f64,
    /// Number of steps of collision after which the geometry of a soft contact is computed again.
    pub max_age: u32,
    /// Share of the difference between half the skin and the gap by which preloads of soft contacts change in a step.
    pub preload_rate: f64,
    /// Gap that resting bodies keep (model unit).
    pub rest_gap: f64,
    /// Share of the missing gap that a rigid contact gains in each step.
    recovery: f64,
    /// Coefficient of restitution.
    restitution: f64,
    /// Impacts slower than this do not bounce: the bounce would be lower than the skin.
    min_bounce: f64,
}

/// Maximum share of the missing gap that a contact gains in each step. In short steps it is the frequency of contacts times
/// the step, so that the velocity of recovery does not depend on the step.
const MAX_RECOVERY: f64 = 0.1;

/// Gap that resting bodies keep, in skins.
const REST_GAP: f64 = 0.5;

/// Factor on the gap that resting bodies keep. Vertices with a gap below the product become points on the ground, and
/// recovery widens gaps up to the product. With a larger factor, a rocking body would be lifted at each vertex on which it
/// lands, and the added energy would keep it rocking.
const MIN_GAP: f64 = 0.5;

/// Rate at which preloads adapt, as a share of the angular frequency of contacts. Resting bodies are held after a few
/// seconds, and impacts hardly change.
const PRELOAD_ADAPTATION: f64 = 1.0 / 300.0;

impl ContactLaws {
    /// Returns the numbers for a world with this skin.
    pub fn new(options: &WorldOptions, skin: f64) -> Self {
        let WorldOptions { step, contact, .. } = options;
        let period = 1.0 / (contact.frequency * step);
        Self {
            step: *step,
            ground: options.ground,
            response: options.response,
            friction: contact.friction,
            skin,
            max_age: f64::max(period, 2.0) as u32,
            preload_rate: (PRELOAD_ADAPTATION * contact.rate() * step).min(1.0),
            rest_gap: REST_GAP * skin,
            recovery: (contact.frequency * step).min(MAX_RECOVERY),
            restitution: contact.restitution(),
            min_bounce: (2.0 * options.gravity.length() * skin).sqrt(),
        }
    }

    /// Whether collisions within a body make contacts.
    pub fn act_within_bodies(&self) -> bool {
        matches!(self.response, Response::Contact | Response::Penalty)
    }

    /// Returns the minimum gap at the end of a step that begins with this gap.
    pub fn kept_gap(&self, gap: f64) -> f64 {
        gap.min(self.rest_gap)
    }

    /// Returns the gap below which vertices become points on the ground, and up to which gaps recover.
    pub fn min_gap(&self) -> f64 {
        MIN_GAP * self.rest_gap
    }

    /// Returns the length by which a gap should grow in a step; 0 if the gap is large enough.
    pub fn recovery(&self, gap: f64) -> f64 {
        self.recovery * (self.min_gap() - gap).max(0.0)
    }

    /// Returns the velocity at which an impact with this velocity bounces; None if it does not bounce.
    pub fn bounce(&self, approach: f64) -> Option<f64> {
        (approach > self.min_bounce).then_some(self.restitution * approach)
    }
}
