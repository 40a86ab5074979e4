//! Tests of motion against closed forms and conservation laws.
#![allow(clippy::unwrap_used)]

mod common;

use common::{block, elastic, fork, octahedron, rigid};
use glam::{DQuat, DVec3};
use sscc_dynamics::{
    ContactOptions, Damping, Detection, Ground, Response, Shape, Start, World, WorldOptions,
};
use sscc_solid::{Elasticity, Material, PartialMaterial};

fn rubber() -> Material {
    Material::new(&PartialMaterial { youngs_modulus: Some(1e5), ..PartialMaterial::default() }).unwrap()
}

/// A world without gravity and ground.
fn space(step: f64) -> WorldOptions {
    WorldOptions { step, gravity: DVec3::ZERO, ground: None, ..WorldOptions::default() }
}

fn momenta(world: &World) -> (DVec3, DVec3) {
    world.bodies().iter().fold((DVec3::ZERO, DVec3::ZERO), |(linear, angular), body| {
        let rigid = body.rigid();
        (linear + rigid.momentum, angular + rigid.angular_momentum + rigid.position.cross(rigid.momentum))
    })
}

fn eigenvalues(shape: &Shape) -> Vec<f64> {
    match shape.elasticity() {
        Elasticity::Linear(stiffness) => stiffness.diagonal().collect(),
        Elasticity::Nonlinear(_) => panic!("linear modes"),
    }
}

#[test]
fn a_free_body_vibrates_at_its_frequencies_and_keeps_its_energy() {
    let shape = elastic(&block([4, 1, 1], 0.1, rubber()), 6, false, &[]);
    for mode in 0..6 {
        let mut q = vec![0.0; 6];
        q[mode] = 1e-3;
        let mut world = World::new(space(1e-3)).unwrap();
        let spin = DVec3::new(0.5, 1.0, -0.3);
        world.add(&shape, &Start { q, spin, velocity: DVec3::X, ..Start::default() }).unwrap();
        let energy = world.energy();
        let (mut crossings, mut last) = (Vec::new(), 1e-3);
        for _ in 0..10_000 {
            world.advance(&mut ()).unwrap();
            assert!((world.energy() / energy - 1.0).abs() < 1e-3);
            let now = world.bodies()[0].q()[mode];
            if last > 0.0 && now <= 0.0 {
                crossings.push(world.time() - 1e-3 * now / (now - last));
            }
            last = now;
        }
        let [first, end] = [crossings[0], crossings[crossings.len() - 1]];
        let measured = (crossings.len() - 1) as f64 / (end - first);
        let expected = eigenvalues(&shape)[mode].sqrt() / std::f64::consts::TAU;
        assert!((measured / expected - 1.0).abs() < 1e-3, "mode {mode}: {measured} Hz, not {expected}");
    }
}

#[test]
fn a_large_vibration_keeps_its_energy_within_bounds() {
    let shape = elastic(&block([6, 1, 1], 0.1, rubber()), 8, true, &[]);
    let mut q = vec![0.0; 8];
    q[0] = 0.1 / shape.reach()[0];
    let mut world = World::new(space(1e-3)).unwrap();
    world.add(&shape, &Start { q, detection: Detection::Off, ..Start::default() }).unwrap();
    let energy = world.energy();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..10_000 {
        world.advance(&mut ()).unwrap();
        let share = world.energy() / energy;
        (least, most) = (least.min(share), most.max(share));
    }
    assert!(least > 0.9 && most < 1.1, "{least} to {most}");
}

#[test]
fn colliding_bodies_conserve_momenta() {
    for large in [false, true] {
        let shape = elastic(&block([3, 2, 1], 0.1, rubber()), 6, large, &[]);
        let contact = ContactOptions { friction: 0.7, ..ContactOptions::default() };
        let mut world = World::new(WorldOptions { contact, ..space(1e-3) }).unwrap();
        let near = DVec3::new(0.2, 0.25, 0.05);
        let still = Start { position: Some(DVec3::ZERO), spin: DVec3::Z, ..Start::default() };
        world.add(&shape, &still).unwrap();
        let coming = Start {
            position: Some(near),
            velocity: DVec3::new(-1.0, -1.5, 0.1),
            orientation: DQuat::from_rotation_x(0.4),
            ..Start::default()
        };
        world.add(&shape, &coming).unwrap();
        world.check_start().unwrap();
        let (linear, angular) = momenta(&world);
        let before: Vec<DVec3> = world.bodies().iter().map(|body| body.rigid().momentum).collect();
        let energy = world.energy();
        let (mut contacts, mut most) = (0, 0.0_f64);
        for _ in 0..1500 {
            let counts = world.advance(&mut ()).unwrap();
            assert_eq!(counts.inter_pairs, 0, "bodies that begin apart never intersect");
            contacts += counts.contacts;
            most = most.max(world.energy());
            let now = momenta(&world);
            assert!((now.0 - linear).length() < 1e-12 * linear.length());
            assert!((now.1 - angular).length() < 1e-12 * (angular.length() + linear.length()));
        }
        assert!(contacts > 3, "{contacts}");
        for (body, before) in world.bodies().iter().zip(&before) {
            assert!((body.rigid().momentum - *before).length() > 0.1 * before.length(), "no impact");
        }
        // The energy of Newmark's method oscillates where forces are nonlinear.
        assert!(most <= energy * if large { 1.002 } else { 1.0 + 1e-9 }, "{energy} to {most}");
        assert!(world.dissipated() > 0.02 * energy, "{} of {energy}", world.dissipated());
        let apart = world.bodies()[1].rigid().position - world.bodies()[0].rigid().position;
        assert!(apart.length() > 0.5, "distance at the end: {apart}");
    }
}

/// A world with a fork whose two arms swing towards each other.
fn clapping(shape: &Shape, options: WorldOptions, damping: Damping) -> World {
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

#[test]
fn a_ball_bounces_with_the_coefficient_of_restitution() {
    let shape = rigid(octahedron(0.5), 2.0);
    for damping in [0.0, 0.1, 0.3, 1.0, 2.0] {
        let contact =
            ContactOptions { damping, frequency: 200.0, skin: Some(1e-3), ..ContactOptions::default() };
        let mut world = World::new(WorldOptions { step: 1e-5, contact, ..WorldOptions::default() }).unwrap();
        world.add(&shape, &Start { position: Some(DVec3::Y * 1.5), ..Start::default() }).unwrap();
        let (mut top, mut touched) = (0.0_f64, 0);
        for _ in 0..100_000 {
            touched += world.advance(&mut ()).unwrap().ground;
            let rigid = world.bodies()[0].rigid();
            if touched > 0 && rigid.momentum.y > 0.0 {
                top = top.max(rigid.position.y);
            }
        }
        // The ball falls 1 m, less the skin in which contacts begin.
        let bounce = (top - 0.501) / 0.999;
        let expected = contact.restitution().powi(2);
        assert!((bounce - expected).abs() < 0.01, "damping {damping}: {bounce}, not {expected}");
    }
}

#[test]
fn distant_resting_bodies_change_no_bounce() {
    let ball = rigid(octahedron(0.5), 2.0);
    let block = rigid(block([8, 1, 8], 0.1, Material::default()).boundary().unwrap().mesh, 3.0);
    let contact = ContactOptions { damping: 0.1, skin: Some(1e-3), ..ContactOptions::default() };
    let heights = |blocks: usize| {
        let mut world = World::new(WorldOptions { step: 2e-4, contact, ..WorldOptions::default() }).unwrap();
        world.add(&ball, &Start { position: Some(DVec3::Y), ..Start::default() }).unwrap();
        for n in 0..blocks {
            let position = Some(DVec3::new(100.0, 0.0501, 10.0 * n as f64));
            world.add(&block, &Start { position, ..Start::default() }).unwrap();
        }
        let mut touched = 0;
        let mut height = || {
            touched += world.advance(&mut ()).unwrap().ground;
            world.bodies()[0].rigid().position.y
        };
        let heights: Vec<f64> = (0..5000).map(|_| height()).collect();
        // A rigid contact bounces in one step or two; a spring would touch for half of its period.
        assert!(touched > 3 + 1000 * blocks, "{touched}");
        heights
    };
    let (alone, beside) = (heights(0), heights(3));
    let off = alone.iter().zip(beside).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3, "{off}");
}

#[test]
fn the_sliding_distance_follows_from_friction() {
    let shape = rigid(block([1, 1, 1], 0.4, Material::default()).boundary().unwrap().mesh, 3.0);
    let (speed, friction) = (2.0, 0.4);
    let ground = Some(Ground { friction, ..Ground::default() });
    for (step, velocity) in [(1e-3, DVec3::X), (1e-4, DVec3::new(0.6, 0.0, -0.8)), (4e-3, DVec3::Z)] {
        let mut world = World::new(WorldOptions { step, ground, ..WorldOptions::default() }).unwrap();
        let from = DVec3::new(0.0, 0.2 + world.options().contact.skin.unwrap_or(3e-4), 0.0);
        world
            .add(&shape, &Start { position: Some(from), velocity: velocity * speed, ..Start::default() })
            .unwrap();
        for _ in 0..(1.5 / step) as usize {
            world.advance(&mut ()).unwrap();
        }
        let rigid = world.bodies()[0].rigid();
        let distance = (rigid.position - from).dot(velocity);
        let expected = speed * speed / (2.0 * friction * 9.81);
        assert!((distance / expected - 1.0).abs() < 0.02, "step {step}: {distance}, not {expected}");
        assert!(rigid.momentum.length() < 0.05 * step / 1e-3 && rigid.position.y > 0.2, "{rigid:?}");
    }
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

#[test]
fn a_held_body_sags_to_its_static_deflection() {
    let solid = block([5, 1, 1], 0.1, rubber());
    let fixed: Vec<u32> =
        (0..solid.vertices().len() as u32).filter(|v| solid.vertices()[*v as usize].x == 0.0).collect();
    let shape = elastic(&solid, 5, false, &fixed);
    let mut world = World::new(WorldOptions { ground: None, ..WorldOptions::default() }).unwrap();
    let damping = Damping { mass: 5.0, stiffness: 0.0 };
    world.add(&shape, &Start { is_free: false, damping, ..Start::default() }).unwrap();
    let place = world.bodies()[0].rigid().position;
    for _ in 0..20_000 {
        world.advance(&mut ()).unwrap();
    }
    let body = &world.bodies()[0];
    assert_eq!(body.rigid().position, place);
    for ((q, moment), lambda) in body.q().iter().zip(shape.moments()).zip(eigenvalues(&shape)) {
        let expected = moment.y * -9.81 / lambda;
        assert!((q - expected).abs() < 1e-6 * (1.0 + expected.abs()), "{q}, not {expected}");
    }
    let sag = shape.model().positions(body.q()).unwrap().iter().map(|x| x.y).fold(f64::INFINITY, f64::min);
    assert!(sag < -0.005, "{sag}");
}

#[test]
fn a_constrained_body_stays_within_the_root_radius() {
    let shape = elastic(&fork(6, 0.1, rubber()), 8, false, &[]);
    let options = WorldOptions { response: Response::Constrain, ..space(1e-3) };
    let mut world = clapping(&shape, options, Damping::default());
    let certificates = shape.certificates();
    let (mut most, mut energy) = (0.0_f64, world.energy());
    for _ in 0..3000 {
        world.advance(&mut ()).unwrap();
        let norm = certificates.norm(world.bodies()[0].q());
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
