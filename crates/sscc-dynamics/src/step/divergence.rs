//! Check that a motion does not diverge: its kinetic energy is bounded by the energy of the start.

use glam::DVec3;

use crate::{Body, DynamicsError};

/// A motion diverges when its kinetic energy exceeds the available energy by this factor.
const MAX_ENERGY_RATIO: f64 = 4.0;

/// Bound of the rounding errors of a difference of potential energies, as a share of these. A body that returns to its first
/// height has no available energy.
const ENERGY_ROUNDING: f64 = 1e-9;

/// Total energies of all bodies at the start. They bound the kinetic energy of later steps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StartEnergy {
    energy: f64,
    potential: f64,
}

impl StartEnergy {
    /// Adds a body in its initial state.
    pub fn add(&mut self, body: &Body, gravity: DVec3) {
        self.energy += body.energy();
        self.potential += body.potential(gravity);
    }

    /// Checks that the motion does not diverge; `step` is the number of the step.
    pub fn check(&self, bodies: &[Body], gravity: DVec3, step: u64) -> Result<(), DynamicsError> {
        let (mut kinetic, mut potential, mut fastest) = (0.0, 0.0, (0, 0.0));
        for (n, body) in bodies.iter().enumerate() {
            let own = body.kinetic_energy();
            if own >= fastest.1 || !own.is_finite() {
                fastest = (n, own);
            }
            kinetic += own;
            potential += body.potential(gravity);
        }
        let available = self.energy + (self.potential - potential).max(0.0);
        let rounding = ENERGY_ROUNDING * (self.potential.abs() + potential.abs());
        if kinetic.is_finite() && kinetic <= MAX_ENERGY_RATIO * available + rounding {
            Ok(())
        } else {
            Err(DynamicsError::Diverged { step, body: fastest.0, energy: fastest.1 })
        }
    }
}
