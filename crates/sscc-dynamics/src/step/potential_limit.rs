//! Limit of the potential energy at the end of a step: contacts do not lift or bend bodies farther than their energy allows.
//!
//! A correction displaces the modes as linear forces would let them follow. Nonlinear forces may be far stiffer there. The
//! elastic energy of the displaced end may then exceed all the energy that the bodies have, so that no loss of velocity pays
//! for it. Such bodies move only a part of their motion. The state at the beginning of the step is within the limit, up to
//! rounding.

use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::body_set::BodySet;
use crate::contacts::islands::{Islands, PerIsland};
use crate::{Body, NewmarkBuffers};

/// Bound of the rounding errors of sums of energies, as a share of these.
const ENERGY_ROUNDING: f64 = 1e-9;

/// Limit of the potential energy of corrected islands: at most their energy without contacts, plus their energy budgets.
#[derive(Clone, Debug, Default)]
pub(crate) struct PotentialLimit {
    /// For each island: potential energy at the end of the step less energy budgets, total energies at the beginning and at
    /// the end without contacts, and the sum of the absolute values of all energies.
    sums: PerIsland<[f64; 4]>,
    newmark: NewmarkBuffers,
}

impl PotentialLimit {
    /// Selects the bodies of corrected islands whose potential energy is too large. `before` holds the energies of each
    /// corrected body at the beginning of the step and at its end without the correction.
    pub fn find_excess(
        &mut self,
        bodies: &mut [Body],
        islands: &mut Islands,
        gravity: DVec3,
        before: &[Option<[f64; 2]>],
        selected: &mut BodySet,
    ) {
        selected.clear(bodies.len());
        if before.iter().all(Option::is_none) {
            return;
        }
        let update = |newmark: &mut NewmarkBuffers, (body, before): (&mut Body, &Option<_>)| {
            if before.is_some() {
                body.update_forces(newmark);
            }
        };
        match &mut *bodies {
            [body] => update(&mut self.newmark, (body, &before[0])),
            bodies => {
                bodies.par_iter_mut().zip(before).for_each_init(NewmarkBuffers::default, update);
            }
        }
        self.sums.reset(bodies.len(), [0.0; 4]);
        for (n, body) in bodies.iter().enumerate() {
            let Some([start, trial]) = before[n] else { continue };
            let potential = body.elastic_energy() + body.potential(gravity);
            let size = start.abs() + trial.abs() + potential.abs();
            let own = [potential - body.energy_budget, start, trial, size];
            self.sums[islands.of(n)].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        selected.set(before.iter().enumerate().map(|(n, before)| {
            let [needed, start, trial, size] = self.sums[islands.of(n)];
            before.is_some() && needed > start.max(trial) + ENERGY_ROUNDING * size
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_shapes::tetrahedron;
    use crate::{Start, WorldOptions};

    /// The elastic energy is 1.5. The difference between the whole and the kinetic energy is 2, because the whole energy is rounded
    /// to a multiple of 2.
    #[test]
    fn the_potential_energy_of_fast_bodies_is_exact() {
        let shape = tetrahedron(vec![DVec3::ZERO; 4], &[3.0]);
        let start = Start { q: vec![1.0], v: vec![2.0_f64.powi(27)], ..Start::default() };
        let mut bodies = [Body::new(&shape, &start, &WorldOptions::default(), None).unwrap()];
        assert_eq!(bodies[0].energy() - bodies[0].kinetic_energy(), 2.0);
        let (mut islands, mut selected) = (Islands::default(), BodySet::default());
        islands.reset(1);
        for (energy, is_excess) in [(1.5, false), (1.4, true)] {
            let before = [Some([energy; 2])];
            PotentialLimit::default().find_excess(
                &mut bodies,
                &mut islands,
                DVec3::ZERO,
                &before,
                &mut selected,
            );
            assert_eq!(!selected.is_empty(), is_excess, "{energy}");
        }
    }
}
