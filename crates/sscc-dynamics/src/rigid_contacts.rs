//! Laws of rigid contacts: the gap that they keep in a step, and how they bounce.

use crate::WorldOptions;

/// Numbers that all rigid contacts of a world share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidContacts {
    /// Step (s).
    pub step: f64,
    /// Gap that resting bodies keep (model unit).
    pub rest_gap: f64,
    /// Share of the missing gap that a contact gains in each step.
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

/// Gap below which vertices become points on the ground, and up to which gaps recover, as a share of the gap that resting
/// bodies keep. Were the second one larger, a body that rocks would be lifted at each vertex on which it lands, and the
/// energy of this would keep it rocking.
const MIN_GAP: f64 = 0.5;

impl RigidContacts {
    /// Returns the numbers for a world with this skin.
    pub fn new(options: &WorldOptions, skin: f64) -> Self {
        Self {
            step: options.step,
            rest_gap: REST_GAP * skin,
            recovery: (options.contact.frequency * options.step).min(MAX_RECOVERY),
            restitution: options.contact.restitution(),
            min_bounce: (2.0 * options.gravity.length() * skin).sqrt(),
        }
    }

    /// Returns the minimum gap at the end of a step that begins with this gap.
    pub fn kept_gap(&self, gap: f64) -> f64 {
        gap.min(self.rest_gap)
    }

    /// Returns the gap below which vertices become points on the ground, and up to which gaps recover.
    pub fn min_gap(&self) -> f64 {
        MIN_GAP * self.rest_gap
    }

    /// Returns by how much a gap should grow in a step; 0 if it is large enough.
    pub fn recovery(&self, gap: f64) -> f64 {
        self.recovery * (self.min_gap() - gap).max(0.0)
    }

    /// Returns the velocity at which an impact with this velocity bounces; None if it does not.
    pub fn bounce(&self, approach: f64) -> Option<f64> {
        (approach > self.min_bounce).then_some(self.restitution * approach)
    }
}
