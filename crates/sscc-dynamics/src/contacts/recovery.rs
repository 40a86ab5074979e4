//! Recovery of gaps: where the gap of a contact is too small, its points move apart slowly, while the energy budgets of their
//! bodies allow it.

use super::world_contacts::WorldContacts;
use crate::Body;

impl WorldContacts {
    /// Sets the minimum gap at the end of this step of all rigid contacts and points on the ground.
    pub fn recover_gaps(&mut self, bodies: &[Body]) {
        let Self { laws, islands, recovery, .. } = self;
        // The force of a contact at rest: half of its impulse displaces the end of a step, the other half acts there.
        let cost = |normal_impulse: f64, gap: f64| 2.0 * normal_impulse / laws.step * laws.recovery(gap);
        recovery.reset(bodies.len(), [0.0; 2]);
        for (n, (body, ground)) in bodies.iter().zip(&self.ground).enumerate() {
            let island = &mut recovery[islands.of(n)];
            island[0] += ground.points.iter().map(|one| cost(one.normal_impulse, one.gap)).sum::<f64>();
            island[1] += body.energy_budget;
        }
        for contact in self.triangles.list.iter().filter(|contact| contact.is_rigid_constraint()) {
            recovery[islands.of(contact.bodies[0] as usize)][0] += cost(contact.normal_impulse, contact.gap);
        }
        let share = |[cost, budget]: [f64; 2]| if cost > budget { budget / cost } else { 1.0 };
        let min_gap = |normal_impulse: f64, gap: f64, island: [f64; 2]| {
            // The cost of a contact without a load is unknown.
            let grows = if normal_impulse > 0.0 { share(island) } else { 0.0 };
            laws.kept_gap(gap) + grows * laws.recovery(gap)
        };
        for (n, ground) in self.ground.iter_mut().enumerate() {
            let island = recovery[islands.of(n)];
            for one in &mut ground.points {
                one.min_gap = min_gap(one.normal_impulse, one.gap, island);
            }
        }
        for contact in self.triangles.list.iter_mut().filter(|contact| contact.is_rigid_constraint()) {
            let island = recovery[islands.of(contact.bodies[0] as usize)];
            contact.min_gap = min_gap(contact.normal_impulse, contact.gap, island);
        }
    }
}
