//! States: a world restored from one continues with the same bits.

use glam::{DQuat, DVec3};
use sscc_dynamics::{ContactOptions, Damping, Detection, DynamicsError, Ground, Start, World, WorldOptions};
use sscc_solid::{Material, PartialMaterial};

use crate::common::worlds::{heap, shapes};
use crate::common::{block, elastic, fork};

fn material(youngs_modulus: f64) -> Material {
    Material::new(&PartialMaterial { youngs_modulus: Some(youngs_modulus), ..PartialMaterial::default() })
        .unwrap()
}

/// Restores each state of a world in another one, and compares the next step. Returns the number of impulses.
fn compare_each_step(make: impl Fn() -> World, steps: usize) -> usize {
    let (mut world, mut other, mut impulses) = (make(), make(), 0);
    for step in 0..steps {
        other.restore(&world.state()).unwrap_or_else(|error| panic!("step {step}: {error}"));
        let (counts, others) = (world.advance(&mut ()).unwrap(), other.advance(&mut ()).unwrap());
        assert_eq!(counts, others, "step {step}");
        assert!(world.state() == other.state(), "step {step}");
        impulses += world.impulses().len();
    }
    impulses
}

/// The arms of soft forks meet each other several times in a step.
#[test]
fn states_with_contacts_within_bodies_can_be_restored() {
    let shapes = [
        elastic(&block([2, 1, 2], 0.2, material(1e5)), 6, false, &[]),
        elastic(&fork(4, 0.1, material(4e3)), 8, true, &[]),
    ];
    let make = || {
        let mut world = World::new(WorldOptions { step: 2e-3, ..WorldOptions::default() }).unwrap();
        for n in 0..5 {
            let start = Start {
                position: Some(DVec3::new(0.1 * f64::from(n % 2), 0.4 + 0.35 * f64::from(n), 0.05)),
                orientation: DQuat::from_scaled_axis(DVec3::new(0.4, 0.9, 0.2) * f64::from(n)),
                velocity: DVec3::NEG_Y,
                damping: Damping { mass: 0.5, stiffness: 1e-3 },
                ..Start::default()
            };
            world.add(&shapes[n as usize % 2], &start).unwrap();
        }
        world
    };
    assert!(compare_each_step(make, 300) > 100);
}

/// Blocks on each other have contacts at the same features of several pairs of triangles, and little energy to separate.
#[test]
fn states_with_duplicate_contacts_can_be_restored() {
    let held = elastic(&block([4, 1, 4], 0.1, material(1e6)), 6, false, &[0, 1, 2, 3]);
    let block = elastic(&block([2, 1, 2], 0.1, material(1e6)), 6, false, &[]);
    let contact = ContactOptions { damping: 0.0, friction: 0.0, ..ContactOptions::default() };
    let ground = Some(Ground { height: -1.0, ..Ground::default() });
    let options = WorldOptions { contact, step: 1e-4, ground, ..WorldOptions::default() };
    let make = || {
        let mut world = World::new(options).unwrap();
        world.add(&held, &Start { is_free: false, ..Start::default() }).unwrap();
        let gap = 0.05 * 1e-3 * block.radius();
        let center = held.mass().center;
        for n in 0..3 {
            let height = 0.1 + gap + f64::from(n) * (0.1 + gap);
            let start = Start {
                position: Some(center + DVec3::new(0.013 * f64::from(n), height, 0.007)),
                orientation: DQuat::from_rotation_y(0.1 * f64::from(n)),
                damping: Damping { mass: 0.5, stiffness: 1e-4 },
                ..Start::default()
            };
            world.add(&block, &start).unwrap();
        }
        world
    };
    assert!(compare_each_step(make, 400) > 1000);
}

#[test]
fn states_are_the_same_after_a_restart_and_for_any_number_of_threads() {
    let shapes = shapes();
    let run = |threads: usize, detection: Detection, stop: Option<usize>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut world, mut impulses) = (heap(&shapes, detection), 0);
            for step in 0..500 {
                if stop == Some(step) {
                    let state = world.state();
                    world = heap(&shapes, detection);
                    world.restore(&state).unwrap();
                    assert_eq!(world.state(), state);
                }
                world.advance(&mut ()).unwrap();
                impulses += world.impulses().len();
            }
            (world.state(), world.energy().to_bits(), impulses, world.impulses().to_vec())
        })
    };
    let expected = run(1, Detection::Certified, None);
    assert!(expected.2 > 1000, "impulses: {}", expected.2);
    assert!(run(2, Detection::Certified, None) == expected);
    assert!(run(1, Detection::Kinetic, None) == expected);
    for step in [1, 100, 333, 480] {
        assert!(run(2, Detection::Certified, Some(step)) == expected, "stopped at {step}");
    }
}

#[test]
fn states_of_other_worlds_are_refused() {
    let shapes = shapes();
    let mut world = heap(&shapes, Detection::Off);
    let in_contact = (0..1000).find(|_| world.advance(&mut ()).unwrap().contacts > 0);
    assert!(in_contact.is_some());
    let state = world.state();
    let other = heap(&shapes, Detection::Off).state();
    assert!(state.numbers.len() > other.numbers.len(), "there are contacts");
    for wrong in [f64::NAN, -1.0, 0.5, 1e9] {
        for at in other.numbers.len()..other.numbers.len() + 4 {
            let mut damaged = state.clone();
            damaged.numbers[at] = wrong;
            assert!(matches!(world.restore(&damaged), Err(DynamicsError::State { .. })), "{wrong} at {at}");
        }
    }
    for length in 0..state.numbers.len() {
        let mut damaged = state.clone();
        damaged.numbers.truncate(length);
        // A state with fewer contacts is valid.
        let whole = length >= other.numbers.len() && (length - other.numbers.len()).is_multiple_of(23);
        assert_eq!(world.restore(&damaged).is_ok(), whole, "{length}");
    }
    // Invalid states: a negative energy budget, an orientation that is not normalized, contacts out of order or
    // duplicated.
    let modes = shapes[0].model().rank();
    let contact = &state.numbers[other.numbers.len()..][..23];
    let mut earlier = contact.to_vec();
    earlier[2] = 0.0; // the first triangle of the first body
    let with = |change: &dyn Fn(&mut Vec<f64>)| {
        let mut damaged = state.clone();
        change(&mut damaged.numbers);
        damaged
    };
    for damaged in [
        with(&|numbers| numbers[2 * modes + 24] = -1e-3),
        with(&|numbers| numbers[2 * modes + 13] = 1e300),
        with(&|numbers| numbers[2 * modes + 3] += 1.0),
        with(&|numbers| numbers.extend(contact)),
        with(&|numbers| numbers.extend(&earlier)),
    ] {
        assert!(matches!(world.restore(&damaged), Err(DynamicsError::State { .. })));
    }
    world.restore(&state).unwrap();
    assert_eq!(world.state(), state);
}
