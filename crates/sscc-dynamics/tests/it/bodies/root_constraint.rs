//! Bodies that stay in the ellipsoid of the root's certificate.

use sscc_dynamics::{Damping, Response, WorldOptions};

use crate::common::worlds::{clapping, space};
use crate::common::{elastic, fork, rubber};

#[test]
fn a_constrained_body_stays_within_the_root_radius() {
    let shape = elastic(&fork(6, 0.1, rubber()), 8, false, &[]);
    let options = WorldOptions { response: Response::Constrain, ..space(1e-3) };
    let mut world = clapping(&shape, options, Damping::default());
    let certificates = shape.certificates();
    let (mut most, mut energy) = (0.0_f64, world.energy());
    for _ in 0..3000 {
        world.advance(&mut ()).unwrap();
        let norm = certificates.norm(world.bodies()[0].q()).unwrap();
        assert!(norm < certificates.root_radius());
        most = most.max(norm);
        assert!(world.energy() <= energy * (1.0 + 1e-12));
        energy = world.energy();
    }
    assert!(most > 0.99 * certificates.root_radius());
}

#[test]
fn a_constrained_body_continues_from_its_state_with_the_same_bits() {
    let shape = elastic(&fork(6, 0.1, rubber()), 8, true, &[]);
    let options = WorldOptions { response: Response::Constrain, ..space(1e-3) };
    let run = |stop: Option<usize>| {
        let mut world = clapping(&shape, options, Damping::default());
        for step in 0..400 {
            if stop == Some(step) {
                let state = world.state();
                world = clapping(&shape, options, Damping::default());
                world.restore(&state).unwrap();
            }
            world.advance(&mut ()).unwrap();
        }
        world.state()
    };
    let whole = run(None);
    for step in (1..400).step_by(37) {
        assert!(run(Some(step)) == whole, "stopped at {step}");
    }
}
