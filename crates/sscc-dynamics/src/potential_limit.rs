//! Limit of the potential energy at the end of a step: contacts do not lift or bend bodies farther than their energy allows.
//!
//! A correction displaces the modes as linear forces would let them follow. Nonlinear forces may be far stiffer there, and
//! the elastic energy of the displaced end may exceed all the energy that the bodies have, so that no loss of velocity pays
//! for it. Such bodies move only a share of their way. The state at the beginning of the step is within the limit.

use rayon::prelude::*;

use crate::body::Body;
use crate::implicit_step::NewmarkBuffers;
use crate::step_buffers::StepBuffers;
use crate::{DynamicsError, Observer, World};

/// Bodies with too much potential energy move half of their way, at most so many times; then they keep their place.
const MAX_HALVINGS: u32 = 4;

/// Bound of the rounding errors of sums of energies, as a share of these.
const ENERGY_ROUNDING: f64 = 1e-9;

impl World {
    /// Moves corrected islands a share of their way until their potential energy is at most their energy without contacts,
    /// plus their energy budgets.
    pub(crate) fn limit_potential(
        &mut self,
        buffers: &mut StepBuffers,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        for halving in 0.. {
            self.find_excess(buffers);
            if !buffers.moves.contains(&true) {
                break;
            }
            let share = if halving < MAX_HALVINGS { 0.5 } else { 0.0 };
            for (body, _) in self.bodies.iter_mut().zip(&buffers.moves).filter(|(_, moves)| **moves) {
                body.shorten(share);
                self.shortened_bodies += 1;
            }
            self.find_impacts(buffers, observer)?;
            self.find_sinking(buffers, false)?;
            self.shorten(buffers, observer)?;
        }
        Ok(())
    }

    /// Selects the bodies of corrected islands whose potential energy is too large.
    fn find_excess(&mut self, buffers: &mut StepBuffers) {
        let StepBuffers { moves, energies, excess, .. } = buffers;
        moves.fill(false);
        if energies.iter().all(Option::is_none) {
            return;
        }
        let update = |newmark: &mut NewmarkBuffers, (body, before): (&mut Body, &Option<_>)| {
            if before.is_some() {
                body.update_forces(newmark);
            }
        };
        match &mut self.bodies[..] {
            [body] => update(&mut self.newmark, (body, &energies[0])),
            bodies => {
                bodies.par_iter_mut().zip(&*energies).for_each_init(NewmarkBuffers::default, update);
            }
        }
        let gravity = self.options.gravity;
        excess.clear();
        excess.resize(moves.len(), [0.0; 4]);
        for (n, body) in self.bodies.iter().enumerate() {
            let Some([start, trial]) = energies[n] else { continue };
            let potential = body.energy() - body.kinetic_energy() + body.potential(gravity);
            let island = &mut excess[self.islands.of(n)];
            let size = start.abs() + trial.abs() + potential.abs();
            let own = [potential - body.energy_budget, start, trial, size];
            island.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        for n in 0..moves.len() {
            let [needed, start, trial, size] = excess[self.islands.of(n)];
            moves[n] = energies[n].is_some() && needed > start.max(trial) + ENERGY_ROUNDING * size;
        }
    }
}
