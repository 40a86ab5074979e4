//! Worlds that several tests use, and their measurements.

use glam::{DQuat, DVec3};
use sscc::intersect_triangle_triangle;
use sscc_dynamics::{Body, Damping, Detection, Shape, Start, World, WorldOptions};
use sscc_solid::Elasticity;

use crate::common::{block, elastic, fork, rigid_block, rubber};

/// Returns options of a world without gravity and ground.
pub fn space(step: f64) -> WorldOptions {
    WorldOptions { step, gravity: DVec3::ZERO, ground: None, ..WorldOptions::default() }
}

pub fn shapes() -> [Shape; 2] {
    [elastic(&block([2, 1, 2], 0.2, rubber()), 6, false, &[]), elastic(&fork(4, 0.1, rubber()), 6, true, &[])]
}

/// Returns a world of five bodies that fall onto each other.
pub fn heap(shapes: &[Shape; 2], detection: Detection) -> World {
    pile(shapes, detection, 0.35)
}

/// Returns a world of five bodies, each higher than the last by `rise`.
pub fn pile(shapes: &[Shape; 2], detection: Detection, rise: f64) -> World {
    let mut world = World::new(WorldOptions { step: 2e-3, ..WorldOptions::default() }).unwrap();
    for n in 0..5 {
        let start = Start {
            position: Some(DVec3::new(0.1 * f64::from(n % 2), 0.4 + rise * f64::from(n), 0.05)),
            orientation: DQuat::from_scaled_axis(DVec3::new(0.4, 0.9, 0.2) * f64::from(n)),
            damping: Damping { mass: 0.5, stiffness: 1e-3 },
            detection,
            ..Start::default()
        };
        world.add(&shapes[n as usize % 2], &start).unwrap();
    }
    world
}

pub fn blocks() -> [Shape; 2] {
    [elastic(&block([2, 1, 2], 0.2, rubber()), 6, true, &[]), rigid_block([2, 1, 2], 0.2, 20.0)]
}

/// Returns a world with a stack of three elastic blocks and a rigid one on top.
pub fn stack(blocks: &[Shape; 2]) -> World {
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

/// Returns a world with a fork whose two arms swing towards each other.
pub fn clapping(shape: &Shape, options: WorldOptions, damping: Damping) -> World {
    // Selects the mode that changes the distance of the tips most.
    let (p, modes) = (shape.model().mesh().rest_positions(), shape.model().modes());
    let tips = |x: f64| (0..p.len()).filter(move |v| p[*v].y > 0.59 && (p[*v].x - x).abs() < 1e-9);
    let close = |k: usize| -> f64 {
        let of = |x: f64| tips(x).map(|v| modes.of_vertex(v as u32)[k].x).sum::<f64>();
        of(0.1) - of(0.2)
    };
    let (mode, rate) =
        (0..modes.rank()).map(|k| (k, close(k))).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap();
    let mut v = vec![0.0; modes.rank()];
    v[mode] = rate.signum() * 0.6;
    let mut world = World::new(options).unwrap();
    world.add(shape, &Start { v, damping, position: Some(DVec3::Y), ..Start::default() }).unwrap();
    world.check_start().unwrap();
    world
}

pub fn momenta(world: &World) -> (DVec3, DVec3) {
    world.bodies().iter().fold((DVec3::ZERO, DVec3::ZERO), |(linear, angular), body| {
        let rigid = body.rigid();
        (linear + rigid.momentum, angular + rigid.angular_momentum + rigid.position.cross(rigid.momentum))
    })
}

pub fn eigenvalues(shape: &Shape) -> Vec<f64> {
    match shape.elasticity() {
        Elasticity::Linear(stiffness) => stiffness.diagonal().collect(),
        Elasticity::Nonlinear(_) => panic!("linear modes"),
    }
}

/// Returns the corners of all triangles of each body, in the world.
pub fn placed(world: &World) -> Vec<Vec<[DVec3; 3]>> {
    let corners = |body: &Body| {
        let model = body.shape().model();
        let x: Vec<DVec3> = model.positions(body.q()).unwrap();
        model.mesh().faces().iter().map(|face| face.map(|v| body.pose().apply(x[v as usize]))).collect()
    };
    world.bodies().iter().map(corners).collect()
}

/// Returns the number of intersecting pairs of triangles of different bodies, by brute force.
pub fn intersections(world: &World) -> usize {
    let placed = placed(world);
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
