//! Sleep and waking.

use glam::DVec3;
use sscc_dynamics::{SleepOptions, Start, World, WorldOptions};

use crate::common::worlds::{blocks, intersections, space, stack};

#[test]
fn a_stack_falls_asleep_and_wakes_when_hit() {
    let blocks = blocks();
    let mut world = stack(&blocks);
    let mut asleep_at = None;
    for step in 0..8000 {
        world.advance(&mut ()).unwrap();
        if world.bodies().iter().all(|body| body.is_asleep()) {
            asleep_at = Some(step);
            break;
        }
    }
    assert!(asleep_at.is_some(), "no sleep");
    let heights: Vec<f64> = world.bodies().iter().map(|body| body.rigid().position.y).collect();
    assert!(heights.windows(2).all(|y| y[1] - y[0] > 0.19), "{heights:?}");
    assert!(world.bodies().iter().all(|body| body.kinetic_energy() == 0.0));
    // Sleeping bodies keep their bits, and their steps detect nothing new.
    let state = world.state();
    for _ in 0..100 {
        let counts = world.advance(&mut ()).unwrap();
        assert!(counts.contacts > 0 && counts.ground > 0, "{counts:?}");
    }
    assert_eq!(world.state().numbers, state.numbers);
    // A body that falls onto the stack wakes all of it.
    let above = DVec3::new(0.05, heights[3] + 0.4, 0.0);
    world.add(&blocks[1], &Start { position: Some(above), ..Start::default() }).unwrap();
    let woken = (0..1000).find(|_| {
        world.advance(&mut ()).unwrap();
        !world.bodies()[0].is_asleep()
    });
    assert!(woken.is_some_and(|step| step > 100), "{woken:?}");
    assert_eq!(intersections(&world), 0);
    assert!(world.bodies().iter().all(|body| !body.is_asleep()), "islands wake together");
}

#[test]
fn bodies_without_support_never_sleep() {
    let blocks = blocks();
    let slow = DVec3::X * 1e-6;
    let mut world =
        World::new(WorldOptions { sleep: SleepOptions { time: 0.01, distance: None }, ..space(1e-3) })
            .unwrap();
    world.add(&blocks[1], &Start { velocity: slow, ..Start::default() }).unwrap();
    for _ in 0..1000 {
        world.advance(&mut ()).unwrap();
    }
    assert!((world.bodies()[0].rigid().momentum / 20.0 - slow).length() < 1e-18);
}

#[test]
fn a_sleeping_stack_continues_from_its_state_with_the_same_bits() {
    let blocks = blocks();
    let run = |stop: Option<usize>| {
        let mut world = stack(&blocks);
        for step in 0..2500 {
            if stop == Some(step) {
                let state = world.state();
                world = stack(&blocks);
                world.restore(&state).unwrap();
                assert_eq!(world.state(), state);
            }
            world.advance(&mut ()).unwrap();
        }
        world.state()
    };
    let whole = run(None);
    for step in [150, 900, 2400] {
        assert!(run(Some(step)) == whole, "stopped at {step}");
    }
}
