//! Tests that no step ends with intersections.

use glam::{DQuat, DVec3};
use sscc_dynamics::{ContactOptions, Damping, Start, World, WorldOptions};
use sscc_solid::{Material, PartialMaterial};

use crate::common::worlds::{blocks, intersections, space, stack};
use crate::common::{block, elastic, octahedron, rigid, rigid_block, rubber};

#[test]
fn a_fast_body_does_not_pass_through_a_thin_plate_in_one_step() {
    let (plate, ball) = (rigid_block([8, 1, 8], 0.01, 5.0), rigid(octahedron(0.02), 0.1));
    for (speed, damping) in [(20.0, 0.0), (90.0, 0.3), (400.0, 2.0)] {
        let contact = ContactOptions { damping, ..ContactOptions::default() };
        let mut world = World::new(WorldOptions { contact, ..space(1e-3) }).unwrap();
        world.add(&plate, &Start { position: Some(DVec3::ZERO), ..Start::default() }).unwrap();
        let start = Start {
            position: Some(DVec3::new(0.013, 0.2, 0.007)),
            velocity: -DVec3::Y * speed,
            ..Start::default()
        };
        world.add(&ball, &start).unwrap();
        world.check_start().unwrap();
        let (energy, momentum) = (world.energy(), DVec3::Y * (-0.1 * speed));
        for _ in 0..40 {
            world.advance(&mut ()).unwrap();
            assert_eq!(intersections(&world), 0);
            assert!(world.energy() <= energy * (1.0 + 1e-12));
        }
        let [plate, ball] = [0, 1].map(|n| world.bodies()[n].rigid());
        assert!(ball.position.y > plate.position.y, "speed {speed}: {ball:?}");
        assert!((plate.momentum + ball.momentum - momentum).length() < 1e-9 * momentum.length());
        // Newton's restitution along the line through both centres, up to the rotation of the plate.
        let parting = (ball.momentum / 0.1 - plate.momentum / 5.0).y / speed;
        assert!(parting < contact.restitution() + 1e-9 && parting > 0.0, "speed {speed}: {parting}");
    }
}

#[test]
fn a_stack_never_intersects_and_gains_no_energy() {
    let blocks = blocks();
    let mut world = stack(&blocks);
    let first = world.energy();
    for step in 0..1500 {
        world.advance(&mut ()).unwrap();
        if step % 10 == 0 || world.shortened_bodies() > 0 {
            assert_eq!(intersections(&world), 0, "step {step}");
            assert!(world.energy() <= first * (1.0 + 1e-9), "step {step}");
        }
    }
    let heights: Vec<f64> = world.bodies().iter().map(|body| body.rigid().position.y).collect();
    assert!(heights.windows(2).all(|y| y[1] - y[0] > 0.19), "{heights:?}");
}

#[test]
fn a_stack_comes_to_rest_without_interpenetration_and_gains_no_energy() {
    let solid = block([2, 1, 2], 0.2, rubber());
    let (linear, large) = (elastic(&solid, 6, false, &[]), elastic(&solid, 6, true, &[]));
    let mut world = World::new(WorldOptions::default()).unwrap();
    for (n, shape) in [&linear, &large, &linear].into_iter().enumerate() {
        let start = Start {
            position: Some(DVec3::new(0.02 * n as f64, 0.11 + 0.22 * n as f64, -0.01 * n as f64)),
            orientation: DQuat::from_rotation_y(0.3 * n as f64),
            damping: Damping { mass: 1.0, stiffness: 1e-3 },
            ..Start::default()
        };
        world.add(shape, &start).unwrap();
    }
    world.check_start().unwrap();
    let first = world.energy();
    let (mut highest, mut met) = (first, 0);
    for _ in 0..6000 {
        met += world.advance(&mut ()).unwrap().contacts;
        highest = highest.max(world.energy() + world.dissipated());
    }
    assert!(met > 100, "{met}");
    assert!(highest <= first * (1.0 + 1e-3), "{first} to {highest}");
    let counts = world.advance(&mut ()).unwrap();
    assert_eq!((counts.self_pairs, counts.inter_pairs), (0, 0), "at rest");
    assert!(counts.contacts > 0 && counts.ground > 0, "{counts:?}");
    let kinetic: f64 = world.bodies().iter().map(|body| body.kinetic_energy()).sum();
    assert!(kinetic < 1e-4 * first, "{kinetic}");
    for body in world.bodies() {
        for x in body.shape().model().positions(body.q()).unwrap() {
            assert!(body.pose().apply(x).y > 0.0);
        }
    }
    let places: Vec<DVec3> = world.bodies().iter().map(|body| body.rigid().position).collect();
    assert!(places[2].y > 0.48, "the top body has not fallen: {places:?}");
}

/// Returns the lowest height of all vertices of a world.
fn lowest(world: &World) -> f64 {
    let heights = world.bodies().iter().flat_map(|body| {
        let positions = body.shape().model().positions(body.q()).unwrap();
        positions.into_iter().map(|x| body.pose().apply(x).y).collect::<Vec<_>>()
    });
    heights.fold(f64::INFINITY, f64::min)
}

#[test]
fn no_vertex_sinks_into_the_ground_however_fast_and_heavy() {
    let soft = Material::new(&PartialMaterial { youngs_modulus: Some(1e4), ..PartialMaterial::default() });
    let shapes = [
        elastic(&block([3, 2, 2], 0.1, soft.unwrap()), 10, true, &[]),
        elastic(&block([3, 2, 2], 0.1, rubber()), 10, false, &[]),
        rigid_block([2, 1, 2], 0.2, 5.0),
    ];
    for (n, shape) in shapes.iter().enumerate() {
        for speed in [0.0, 3.0, 30.0] {
            let mut world = World::new(WorldOptions::default()).unwrap();
            let start = Start {
                position: Some(DVec3::Y * 0.5),
                orientation: DQuat::from_scaled_axis(DVec3::new(0.4, 0.9, 0.2)),
                velocity: DVec3::new(0.5, -speed, 0.0),
                spin: DVec3::new(1.0, 2.0, -1.0) * speed,
                damping: Damping { mass: 0.5, stiffness: 1e-3 },
                ..Start::default()
            };
            world.add(shape, &start).unwrap();
            world.check_start().unwrap();
            let first = world.energy();
            let mut touched = 0;
            for step in 0..1500 {
                world.advance(&mut ()).unwrap();
                touched += world.impulses().len();
                let lowest = lowest(&world);
                assert!(lowest >= 0.0, "shape {n}, speed {speed}, step {step}: {lowest}");
                // The energy of Newmark's method oscillates where forces are nonlinear.
                let most = first * if n == 0 { 1.002 } else { 1.0 + 1e-9 };
                assert!(world.energy() <= most, "shape {n}, speed {speed}, step {step}: {first}");
            }
            assert!(touched > 0, "shape {n}, speed {speed}: {touched}");
        }
    }
}
