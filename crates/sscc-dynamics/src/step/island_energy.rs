//! Energy of corrections: energy budgets of the bodies of an island pay for the energy that a correction adds to the island.
//!
//! Damping may dissipate energy in the motion without contacts. A correction that prevents this motion also prevents that
//! loss, and contacts have then added no energy. So a correction adds only the energy above both the energy at the beginning
//! of the step and the energy at its end without the correction, and dissipates only the energy below both.

use glam::{DMat3, DVec3};

use crate::Body;
use crate::contacts::islands::Island;
use crate::contacts::world_contacts::WorldContacts;

/// Charges the change of energy by the corrections of this step to energy budgets. Velocities are scaled down where
/// the budgets are too small. `before` holds the energies of each corrected body at the beginning of the step and at its
/// end without the correction. The nonlinear forces of these bodies have been evaluated at their q.
pub(crate) fn limit_energy(
    bodies: &mut [Body],
    contacts: &mut WorldContacts,
    gravity: DVec3,
    before: &[Option<[f64; 2]>],
) {
    let WorldContacts { islands, ground, .. } = contacts;
    let mut corrected: Vec<(Island, usize)> =
        (0..before.len()).filter(|n| before[*n].is_some()).map(|n| (islands.of(n), n)).collect();
    corrected.sort_unstable();
    for island in corrected.chunk_by(|a, b| a.0 == b.0) {
        let members: Vec<usize> = island.iter().map(|(_, n)| *n).collect();
        let all = || members.iter().copied();
        let [start, trial] = [0, 1].map(|k| all().filter_map(|n| before[n]).map(|both| both[k]).sum::<f64>());
        let budget: f64 = all().map(|n| bodies[n].energy_budget).sum();
        let now: f64 = all().map(|n| bodies[n].energy() + bodies[n].potential(gravity)).sum();
        let mut work = (now - start.max(trial)).max(0.0) + (now - start.min(trial)).min(0.0);
        if work > budget {
            let is_held = all().any(|n| !bodies[n].is_free() || !ground[n].points.is_empty());
            work -= remove_kinetic_energy(bodies, &members, work - budget, !is_held);
        }
        let count = members.len() as f64;
        for n in all() {
            // Added energy is paid by the bodies in proportion to their budgets; dissipated energy is shared equally.
            let own = &mut bodies[n].energy_budget;
            let share = if work <= 0.0 {
                1.0 / count
            } else if budget > 0.0 {
                *own / budget
            } else {
                0.0
            };
            *own = (*own - work * share).max(0.0);
        }
    }
}

/// Removes an amount of kinetic energy from bodies, as far as they have it. If `keeps_momenta`, their total momentum
/// and angular momentum stay unless more energy is removed than their relative motion has. Returns the energy removed.
fn remove_kinetic_energy(bodies: &mut [Body], members: &[usize], amount: f64, keeps_momenta: bool) -> f64 {
    let mut removed = 0.0;
    if keeps_momenta {
        removed = scale(bodies, members, amount, common_motion(bodies, members));
    }
    if removed < amount {
        removed += scale(bodies, members, amount - removed, CommonMotion::default());
    }
    removed
}

/// Motion of several bodies as one rigid body.
#[derive(Clone, Copy, Debug, Default)]
struct CommonMotion {
    center: DVec3,
    velocity: DVec3,
    angular_velocity: DVec3,
}

/// Returns the rigid motion with the momenta of all bodies together.
fn common_motion(bodies: &[Body], members: &[usize]) -> CommonMotion {
    let all = || members.iter().map(|n| (&bodies[*n].rigid, bodies[*n].shape().mass().mass));
    let mass: f64 = all().map(|(_, mass)| mass).sum();
    let center = all().map(|(rigid, mass)| rigid.position * mass).sum::<DVec3>() / mass;
    let velocity = all().map(|(rigid, _)| rigid.momentum).sum::<DVec3>() / mass;
    let (mut inertia, mut angular) = (DMat3::ZERO, DVec3::ZERO);
    for (rigid, mass) in all() {
        let arm = rigid.position - center;
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        inertia +=
            rigid.inertia() + (DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer) * mass;
        angular += rigid.angular_momentum + arm.cross(rigid.momentum);
    }
    CommonMotion { center, velocity, angular_velocity: inertia.inverse() * angular }
}

/// Scales the velocities relative to a common motion, so that they lose this amount of kinetic energy, or all of it.
/// Returns the energy removed.
fn scale(bodies: &mut [Body], members: &[usize], amount: f64, common: CommonMotion) -> f64 {
    let kinetic = |bodies: &[Body]| -> f64 { members.iter().map(|n| bodies[*n].kinetic_energy()).sum() };
    let before = kinetic(bodies);
    let of = |body: &Body| {
        let (rigid, mass) = (&body.rigid, body.shape().mass().mass);
        let velocity = common.velocity + common.angular_velocity.cross(rigid.position - common.center);
        (velocity * mass, rigid.inertia() * common.angular_velocity)
    };
    let shared: f64 = members
        .iter()
        .map(|n| {
            let body = &bodies[*n];
            let (momentum, angular) = of(body);
            (momentum.length_squared() / body.shape().mass().mass + angular.dot(common.angular_velocity))
                / 2.0
        })
        .sum();
    let own = before - shared;
    let factor = if own > amount { (1.0 - amount / own).sqrt() } else { 0.0 };
    for n in members {
        let body = &mut bodies[*n];
        let (momentum, angular) = of(body);
        let rigid = &mut body.rigid;
        rigid.momentum = momentum + (rigid.momentum - momentum) * factor;
        rigid.angular_momentum = angular + (rigid.angular_momentum - angular) * factor;
        body.v.iter_mut().for_each(|v| *v *= factor);
    }
    before - kinetic(bodies)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_shapes::tetrahedron;
    use crate::{Start, WorldOptions};

    fn momenta(bodies: &[Body]) -> [DVec3; 2] {
        let linear = bodies.iter().map(|body| body.rigid.momentum).sum();
        let own = |body: &Body| body.rigid.angular_momentum + body.rigid.position.cross(body.rigid.momentum);
        [linear, bodies.iter().map(own).sum()]
    }

    #[test]
    fn removed_energy_is_that_of_relative_motion_first() {
        let shape = tetrahedron(vec![DVec3::ZERO; 4], &[1.0]);
        let mut bodies = Vec::new();
        for n in 0..3 {
            let x = f64::from(n);
            let start = Start {
                position: Some(DVec3::new(2.0 * x, x * x, -x)),
                velocity: DVec3::new(1.0, -x, 0.5 * x),
                spin: DVec3::new(0.3, x, -0.2 * x * x),
                v: vec![0.7 - x],
                ..Start::default()
            };
            bodies.push(Body::new(&shape, &start, &WorldOptions::default(), None).unwrap());
        }
        let members = [0, 1, 2];
        let kinetic = |bodies: &[Body]| -> f64 { bodies.iter().map(Body::kinetic_energy).sum() };
        let (before, first) = (momenta(&bodies), kinetic(&bodies));
        let removed = remove_kinetic_energy(&mut bodies, &members, 0.5, true);
        assert!((removed - 0.5).abs() < 1e-12 && (first - kinetic(&bodies) - 0.5).abs() < 1e-12);
        let after = momenta(&bodies);
        for n in 0..2 {
            assert!((after[n] - before[n]).length() < 1e-12 * (1.0 + before[n].length()), "{n}");
        }
        // If more is removed than the bodies have, all of them stop.
        let left = kinetic(&bodies);
        let removed = remove_kinetic_energy(&mut bodies, &members, 2.0 * first, true);
        assert!((removed - left).abs() < 1e-12 * left && kinetic(&bodies) < 1e-12 * left);
    }
}
