//! Recovery of gaps: the points of a contact that are nearer than they should be move apart slowly, while the energy budgets of
//! their bodies allow it.

use crate::World;
use crate::step_buffers::StepBuffers;

impl World {
    /// Sets the minimum gap at the end of this step of all rigid contacts and points on the ground.
    pub(crate) fn recover_gaps(&mut self, buffers: &mut StepBuffers) {
        let rigid = self.rigid_contacts;
        // The force of a contact at rest: half of its impulse displaces the end of a step, the other half acts there.
        let cost = |normal_impulse: f64, gap: f64| 2.0 * normal_impulse / rigid.step * rigid.recovery(gap);
        let islands = &mut buffers.recovery;
        islands.clear();
        islands.resize(self.bodies.len(), [0.0; 2]);
        for (n, (body, ground)) in self.bodies.iter().zip(&self.ground_contacts).enumerate() {
            let island = &mut islands[self.islands.of(n)];
            island[0] += ground.points.iter().map(|one| cost(one.normal_impulse, one.gap)).sum::<f64>();
            island[1] += body.energy_budget;
        }
        for contact in self.contacts.list.iter().filter(|contact| contact.is_rigid_constraint()) {
            islands[self.islands.of(contact.bodies[0] as usize)][0] +=
                cost(contact.normal_impulse, contact.gap);
        }
        let share = |[cost, budget]: [f64; 2]| if cost > budget { budget / cost } else { 1.0 };
        let min_gap = |normal_impulse: f64, gap: f64, island: [f64; 2]| {
            // The cost of a contact without a load is unknown.
            let grows = if normal_impulse > 0.0 { share(island) } else { 0.0 };
            rigid.kept_gap(gap) + grows * rigid.recovery(gap)
        };
        for (n, ground) in self.ground_contacts.iter_mut().enumerate() {
            let island = islands[self.islands.of(n)];
            for one in &mut ground.points {
                one.min_gap = min_gap(one.normal_impulse, one.gap, island);
            }
        }
        for contact in self.contacts.list.iter_mut().filter(|contact| contact.is_rigid_constraint()) {
            let island = islands[self.islands.of(contact.bodies[0] as usize)];
            contact.min_gap = min_gap(contact.normal_impulse, contact.gap, island);
        }
    }
}
