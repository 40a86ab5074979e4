//! Contacts of bodies with themselves.

use sscc_dynamics::{Damping, Response, WorldOptions};

use crate::common::worlds::{clapping, momenta, space};
use crate::common::{elastic, fork, rubber};

#[test]
fn penalties_within_a_body_conserve_momenta_and_end() {
    for large in [false, true] {
        let shape = elastic(&fork(6, 0.1, rubber()), 8, large, &[]);
        let damping = Damping { mass: 0.3, stiffness: 1e-4 };
        let options = WorldOptions { response: Response::Penalty, ..space(1e-3) };
        let mut world = clapping(&shape, options, damping);
        let (energy, before) = (world.energy(), momenta(&world));
        let (mut colliding, mut last) = (0, usize::MAX);
        for _ in 0..20_000 {
            let counts = world.advance(&mut ()).unwrap();
            colliding += counts.self_colliding;
            last = counts.self_pairs;
            assert!(world.energy() + world.dissipated() <= energy * if large { 1.002 } else { 1.0 + 1e-9 });
        }
        assert_eq!(momenta(&world), before, "impulses within a body do not change its momenta");
        assert!(colliding > 3, "colliding steps: {colliding}");
        assert_eq!(last, 0, "pairs at the end");
        assert!(world.energy() < 0.01 * energy, "{} of {energy}", world.energy());
        assert!(world.dissipated() > 0.01 * energy);
    }
}

#[test]
fn a_body_that_begins_free_of_self_collisions_stays_free() {
    for large in [false, true] {
        let shape = elastic(&fork(6, 0.1, rubber()), 8, large, &[]);
        let damping = Damping { mass: 0.3, stiffness: 1e-4 };
        let mut world = clapping(&shape, space(1e-3), damping);
        let (energy, before) = (world.energy(), momenta(&world));
        let mut query = sscc::Query::new(shape.model(), shape.certificates()).unwrap();
        let (mut held, mut impulses) = (0, 0);
        for step in 0..20_000 {
            let counts = world.advance(&mut ()).unwrap();
            assert_eq!(
                (counts.self_pairs, query.count(world.bodies()[0].q()).unwrap()),
                (0, 0),
                "step {step}"
            );
            assert!(world.energy() + world.dissipated() <= energy * if large { 1.002 } else { 1.0 + 1e-9 });
            held += world.shortened_bodies();
            impulses += world.impulses().len();
        }
        assert_eq!(momenta(&world), before, "impulses within a body do not change its momenta");
        assert!(impulses > 3 && held == 0, "{impulses} impulses, {held} shortened steps");
        assert!(world.energy() < 0.01 * energy, "{} of {energy}", world.energy());
    }
}
