//! Random scenes run to their end without new energy, whatever stiffness, damping, step, orientation, speed and shape are.
//! The example `robustness` of `sscc-sim` runs more scenes.

use glam::{DMat3, DQuat, DVec3};
use sscc::{Modes, ReducedModel};
use sscc_dynamics::{Ground, Shape, Start, World, WorldOptions};
use sscc_solid::{Elasticity, MassProperties, Material, PartialMaterial, ReducedForces, Stiffness};

use crate::common::random_scene::{Random, RandomScene};
use crate::common::{block, certified, cubes, elastic, fork, octahedron};

/// Number of random scenes.
const SCENES: u64 = 7;

/// Number of steps of each scene.
const STEPS: usize = 200;

/// Bound of the energy plus the energy that contacts have dissipated, over the first energy: Newmark's method may add 2% of
/// the energy of the modes.
const MAX_ENERGY: f64 = 1.02;

/// Returns a random scene and its shape.
fn draw(random: &mut Random) -> (RandomScene, Shape) {
    loop {
        let scene = RandomScene::draw(random);
        let youngs_modulus = Some(scene.youngs);
        let material = Material::new(&PartialMaterial { youngs_modulus, ..PartialMaterial::default() });
        let (material, kind) = (material.unwrap(), (4.0 * random.unit()) as u32);
        let solid = match kind {
            0 => fork(4, 0.05, material),
            1 => block([4, 1, 1], 0.06, material),
            2 => block([3, 3, 1], 0.05, material),
            _ => cubes(&[[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [2, 1, 1]], 0.06, material),
        };
        let shape = elastic(&solid, 8, random.unit() < 0.8, &[]);
        if scene.resolves(shape.elasticity()) {
            return (scene, shape);
        }
    }
}

/// Runs a random scene. Returns its largest energy, plus the energy that contacts have dissipated, over the first energy.
fn run(seed: u64) -> f64 {
    let mut random = Random(seed);
    let (RandomScene { damping, options, .. }, shape) = draw(&mut random);
    let mut world = World::new(options).unwrap();
    let (radius, speed) = (shape.radius(), 12.0 * random.unit());
    for n in 0..2 {
        let start = Start {
            position: Some(DVec3::Y * radius * (1.05 + 2.2 * f64::from(n))),
            orientation: DQuat::from_scaled_axis(random.vector() * 3.0),
            velocity: DVec3::NEG_Y * speed * (1.0 + f64::from(n)) + random.vector() * speed * 0.3,
            spin: random.vector() * 10.0,
            damping,
            ..Start::default()
        };
        world.add(&shape, &start).unwrap();
    }
    world.check_start().unwrap();
    let (first, mut largest) = (world.energy(), 0.0_f64);
    for _ in 0..STEPS {
        world.advance(&mut ()).unwrap_or_else(|error| panic!("scene {seed}: {error}"));
        largest = largest.max(world.energy() + world.dissipated());
    }
    largest / first
}

#[test]
fn random_scenes_run_to_their_end_without_new_energy() {
    for seed in 0..SCENES {
        let largest = run(seed);
        assert!(largest < MAX_ENERGY, "scene {seed}: {largest} of the first energy");
    }
}

/// A heavy body falls on a vertex that a light mode moves. At rest the mode is soft, so corrections displace it far. But its
/// force grows with the cube of the displacement: if the heavy body moved on with its whole weight, the mode would have more
/// energy than the fall.
#[test]
fn corrected_bodies_get_no_more_potential_energy_than_they_had_energy() {
    let lowest = 3;
    let modes = Modes::from_matrix(6, 1, |row, _| f64::from(u8::from(row == 3 * lowest + 1))).unwrap();
    let model = ReducedModel::new(octahedron(0.1), modes).unwrap();
    let stiffness = Stiffness::from_diagonal(&[100.0]).unwrap();
    let forces = ReducedForces::new(stiffness, vec![0.0], vec![1e17]).unwrap();
    let inertia = DMat3::from_diagonal(DVec3::splat(4.0));
    let mass = MassProperties { mass: 1000.0, center: DVec3::ZERO, inertia };
    let certificates = certified(&model);
    let shape = Shape::new(model, certificates, Elasticity::Nonlinear(forces), mass).unwrap();
    let (gravity, ground) = (DVec3::ZERO, Some(Ground::default()));
    let options = WorldOptions { step: 1e-3, gravity, ground, ..WorldOptions::default() };
    let mut world = World::new(options).unwrap();
    let position = Some(DVec3::Y * 0.1005);
    world.add(&shape, &Start { position, velocity: DVec3::NEG_Y, ..Start::default() }).unwrap();
    let first = world.energy();
    assert!((first - 500.0).abs() < 1e-9, "{first}");
    let mut shortened = 0;
    for step in 0..20 {
        world.advance(&mut ()).unwrap();
        let energy = world.energy() + world.dissipated();
        assert!(energy < MAX_ENERGY * first, "step {step}: {energy} J");
        shortened += world.shortened_bodies();
    }
    assert!(shortened > 0);
}
