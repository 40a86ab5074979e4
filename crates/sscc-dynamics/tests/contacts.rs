//! Tests of contacts between bodies: no intersections at any step, sleep, and waking.
#![allow(clippy::unwrap_used)]

mod common;

use common::{block, elastic, octahedron, rigid};
use glam::{DQuat, DVec3};
use sscc::intersect_triangle_triangle;
use sscc_dynamics::{ContactOptions, Damping, Ground, Shape, SleepOptions, Start, World, WorldOptions};
use sscc_solid::{Material, PartialMaterial};

fn rubber() -> Material {
    Material::new(&PartialMaterial { youngs_modulus: Some(1e5), ..PartialMaterial::default() }).unwrap()
}

fn rigid_block(counts: [i32; 3], size: f64, mass: f64) -> Shape {
    rigid(block(counts, size, Material::default()).boundary().unwrap().mesh, mass)
}

/// The number of intersecting pairs of triangles of different bodies, by brute force.
fn intersections(world: &World) -> usize {
    let placed: Vec<Vec<[DVec3; 3]>> = world
        .bodies()
        .iter()
        .map(|body| {
            let model = body.shape().model();
            let x: Vec<DVec3> = model.positions(body.q()).unwrap();
            let faces = model.mesh().faces().iter();
            faces.map(|face| face.map(|v| body.pose().apply(x[v as usize]))).collect()
        })
        .collect();
    let mut count = 0;
    for b in 0..placed.len() {
        for a in 0..b {
            let meets =
                |x: &[DVec3; 3]| placed[b].iter().filter(|y| intersect_triangle_triangle(x, y)).count();
            count += placed[a].iter().map(meets).sum::<usize>();
        }
    }
    count
}

fn space() -> WorldOptions {
    WorldOptions { gravity: DVec3::ZERO, ground: None, ..WorldOptions::default() }
}

#[test]
fn a_fast_body_does_not_pass_through_a_thin_plate_in_one_step() {
    let (plate, ball) = (rigid_block([8, 1, 8], 0.01, 5.0), rigid(octahedron(0.02), 0.1));
    for (speed, damping) in [(20.0, 0.0), (90.0, 0.3), (400.0, 2.0)] {
        let contact = ContactOptions { damping, ..ContactOptions::default() };
        let mut world = World::new(WorldOptions { contact, ..space() }).unwrap();
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

/// A stack of three elastic blocks and a rigid one on top.
fn stack(blocks: &[Shape; 2]) -> World {
    let mut world = World::new(WorldOptions::default()).unwrap();
    for n in 0..4 {
        let start = Start {
            position: Some(DVec3::new(0.02 * f64::from(n), 0.11 + 0.22 * f64::from(n), -0.01 * f64::from(n))),
            orientation: DQuat::from_rotation_y(0.3 * f64::from(n)),
            damping: Damping { mass: 1.0, stiffness: 1e-3 },
            ..Start::default()
        };
        world.add(&blocks[usize::from(n == 3)], &start).unwrap();
    }
    world.check_start().unwrap();
    world
}

fn blocks() -> [Shape; 2] {
    [elastic(&block([2, 1, 2], 0.2, rubber()), 6, true, &[]), rigid_block([2, 1, 2], 0.2, 20.0)]
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

/// The lowest height of all vertices of a world.
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

#[test]
fn rolling_friction_stops_a_spin_on_smooth_ground() {
    let (shape, spin) = (rigid_block([2, 1, 2], 0.2, 3.0), 1.0);
    let ground = Some(Ground { friction: 0.0, ..Ground::default() });
    let mut world = World::new(WorldOptions { ground, ..WorldOptions::default() }).unwrap();
    let position = Some(DVec3::Y * 0.1003);
    world.add(&shape, &Start { position, spin: DVec3::Y * spin, ..Start::default() }).unwrap();
    let first = world.energy();
    // The torque is 0.05 times the weight times the radius.
    let slowing = 0.05 * shape.radius() * 3.0 * 9.81 / shape.mass().inertia.y_axis.y;
    let half = (0.5 * spin / slowing / 1e-3) as usize;
    for step in 0..3 * half {
        world.advance(&mut ()).unwrap();
        assert!(world.energy() + world.dissipated() <= first * (1.0 + 1e-9));
        if step + 1 == half {
            let share = world.bodies()[0].rigid().angular_velocity().y / spin;
            assert!((share - 0.5).abs() < 0.05, "{share}");
        }
    }
    assert!(world.bodies()[0].rigid().angular_velocity().length() < 1e-3 * spin);
}

#[test]
fn three_bodies_in_a_row_meet_in_one_step_and_keep_their_momentum() {
    // The gaps between the blocks are much smaller than the way of a step.
    let shape = rigid_block([1, 1, 1], 0.2, 2.0);
    let mut world = World::new(space()).unwrap();
    for (n, speed) in [30.0, 0.0, -40.0].into_iter().enumerate() {
        let position = Some(DVec3::X * (0.2001 * n as f64));
        world.add(&shape, &Start { position, velocity: DVec3::X * speed, ..Start::default() }).unwrap();
    }
    world.check_start().unwrap();
    let (energy, momentum) = (world.energy(), DVec3::X * -20.0);
    for _ in 0..30 {
        world.advance(&mut ()).unwrap();
        assert_eq!((intersections(&world), world.shortened_bodies()), (0, 0));
        assert!(world.energy() + world.dissipated() <= energy * (1.0 + 1e-12));
        let sum: DVec3 = world.bodies().iter().map(|body| body.rigid().momentum).sum();
        assert!((sum - momentum).length() < 1e-12 * 140.0, "{sum}");
    }
    let x: Vec<f64> = world.bodies().iter().map(|body| body.rigid().momentum.x).collect();
    assert!(x.is_sorted(), "no two bodies approach each other: {x:?}");
}

#[test]
fn bodies_without_support_never_sleep() {
    let blocks = blocks();
    let slow = DVec3::X * 1e-6;
    let mut world =
        World::new(WorldOptions { sleep: SleepOptions { time: 0.01, distance: None }, ..space() }).unwrap();
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
