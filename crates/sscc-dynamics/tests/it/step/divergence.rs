//! Motions that diverge or leave the range of numbers.

use glam::DVec3;
use sscc_dynamics::{Detection, DynamicsError, Ground, Start, World, WorldOptions};

use crate::common::worlds::shapes;

#[test]
fn a_diverging_motion_names_step_body_and_energy() {
    let shapes = shapes();
    let mut world = World::new(WorldOptions { ground: None, ..WorldOptions::default() }).unwrap();
    world.add(&shapes[0], &Start::default()).unwrap();
    let mut q = vec![0.0; 6];
    q[0] = 1e30;
    let far = Start { q, detection: Detection::Off, position: Some(DVec3::X * 9.0), ..Start::default() };
    world.add(&shapes[1], &far).unwrap();
    let error = (0..10).find_map(|_| world.advance(&mut ()).err()).unwrap();
    assert!(matches!(error, DynamicsError::Diverged { body: 1, .. }), "{error}");
    assert!(error.to_string().contains("body 1"));
}

/// No other body and no ground is near the body: a step needs none of its positions, but callers read its state.
#[test]
fn a_body_that_leaves_the_range_of_numbers_is_refused_in_that_step() {
    let shapes = shapes();
    for ground in [None, Some(Ground::default())] {
        let options = WorldOptions { ground, gravity: DVec3::ZERO, step: 1e-3, ..WorldOptions::default() };
        let mut world = World::new(options).unwrap();
        // 2^200 is about 1.607e60.
        let velocity = DVec3::new(0.0, 1e62, -1e61);
        let start = Start { position: Some(DVec3::Y), velocity, ..Start::default() };
        world.add(&shapes[0], &start).unwrap();
        for _ in 0..16 {
            world.advance(&mut ()).unwrap();
        }
        assert!(world.bodies()[0].rigid().position.y > 1.59e60);
        let error = world.advance(&mut ()).unwrap_err();
        assert!(matches!(error, DynamicsError::Core(sscc::Error::Option { value, .. }) if value > 1.6e60));
        assert_eq!(world.steps(), 16);
    }
}
