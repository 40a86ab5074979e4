//! Laws of rigid contacts: the gap that they keep in a step, and how they bounce.

use crate::WorldOptions;

/// Numbers that all rigid contacts of a world share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidContacts {
    /// Step (s).
    pub step: f64,
    /// Gap that resting bodies keep (model unit).
    pub rest_gap: f64,
    /// Coefficient of restitution.
    restitution: f64,
    /// Impacts slower than this do not bounce: the bounce would be lower than the skin.
    min_bounce: f64,
}

/// Share of the missing gap that a contact gains in each step.
const RECOVERY: f64 = 0.1;

/// Gap that resting bodies keep, in skins.
const REST_GAP: f64 = 0.5;

impl RigidContacts {
    /// Returns the numbers for a world with this skin.
    pub fn new(options: &WorldOptions, skin: f64) -> Self {
        Self {
            step: options.step,
            rest_gap: REST_GAP * skin,
            restitution: options.contact.restitution(),
            min_bounce: (2.0 * options.gravity.length() * skin).sqrt(),
        }
    }

    /// Returns the minimum gap at the end of a step that begins with this gap. Smaller gaps grow slowly.
    pub fn kept_gap(&self, gap: f64) -> f64 {
        if gap > self.rest_gap { self.rest_gap } else { gap + RECOVERY * (self.rest_gap - gap) }
    }

    /// Returns the velocity at which an impact with this velocity bounces; None if it does not.
    pub fn bounce(&self, approach: f64) -> Option<f64> {
        (approach > self.min_bounce).then_some(self.restitution * approach)
    }
}
