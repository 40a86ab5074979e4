//! Tests of states of every step: a world restored from one continues with the same bits.
#![allow(clippy::unwrap_used)]

mod common;

use common::{block, elastic, fork};
use glam::{DQuat, DVec3};
use sscc_dynamics::{ContactOptions, Damping, Ground, Start, World, WorldOptions};
use sscc_solid::{Material, PartialMaterial};

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

/// Arms of soft forks meet each other several times in a step.
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

/// Blocks on each other have contacts at the same features of several pairs of triangles, and little energy to part.
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
