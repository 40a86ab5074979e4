//! Tests of worlds: collisions, errors, restart from a state, and determinism across threads.
#![allow(clippy::unwrap_used)]

mod common;

use common::{block, certified, elastic, fork, octahedron, rigid};
use glam::{DQuat, DVec3};
use sscc::{Modes, Pair, ReducedModel, TriMesh, intersect_triangle_triangle};
use sscc_dynamics::{
    ContactOptions, Damping, Detection, DynamicsError, Ground, Obstacle, Phase, Response, Shape, Start,
    World, WorldOptions,
};
use sscc_solid::{Elasticity, Material, PartialMaterial, Stiffness};

fn rubber() -> Material {
    Material::new(&PartialMaterial { youngs_modulus: Some(1e5), ..PartialMaterial::default() }).unwrap()
}

fn shapes() -> [Shape; 2] {
    [elastic(&block([2, 1, 2], 0.2, rubber()), 6, false, &[]), elastic(&fork(4, 0.1, rubber()), 6, true, &[])]
}

/// A world of five bodies that fall onto each other.
fn heap(shapes: &[Shape; 2], detection: Detection) -> World {
    pile(shapes, detection, 0.35)
}

/// A world of five bodies, each higher than the last by `rise`.
fn pile(shapes: &[Shape; 2], detection: Detection, rise: f64) -> World {
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

#[test]
fn pairs_between_bodies_equal_brute_force() {
    let shapes = shapes();
    // Bodies that begin in each other collide until they are apart; then they never meet again.
    let mut world = pile(&shapes, Detection::Certified, 0.2);
    let (mut met, mut apart) = (0, 0);
    for step in 0..700 {
        let placed: Vec<Vec<[DVec3; 3]>> = world
            .bodies()
            .iter()
            .map(|body| {
                let model = body.shape().model();
                let x: Vec<DVec3> = model.positions(body.q()).unwrap();
                let x: Vec<DVec3> = x.into_iter().map(|x| body.pose().apply(x)).collect();
                model.mesh().faces().iter().map(|face| face.map(|v| x[v as usize])).collect()
            })
            .collect();
        let counts = world.advance(&mut ()).unwrap();
        if step % 7 != 0 {
            continue;
        }
        let mut expected: Vec<([usize; 2], Vec<Pair>)> = Vec::new();
        for b in 0..placed.len() {
            for a in 0..b {
                let all = |i: usize| (0..placed[b].len()).map(move |j| (i, j));
                let meet =
                    |(i, j): &(usize, usize)| intersect_triangle_triangle(&placed[a][*i], &placed[b][*j]);
                let pairs: Vec<Pair> = (0..placed[a].len())
                    .flat_map(all)
                    .filter(meet)
                    .map(|(i, j)| (i as u32, j as u32))
                    .collect();
                if !pairs.is_empty() {
                    expected.push(([a, b], pairs));
                }
            }
        }
        expected.sort();
        let found: Vec<_> = world.inter_pairs().map(|met| (met.bodies, met.pairs.to_vec())).collect();
        assert_eq!(found, expected, "step {step}");
        assert_eq!(counts.inter_pairs, expected.iter().map(|(_, pairs)| pairs.len()).sum::<usize>());
        met += usize::from(!expected.is_empty());
        apart += usize::from(expected.is_empty());
    }
    assert!(met > 10 && apart > 10, "{met} {apart}");
}

#[test]
fn ground_contacts_equal_brute_force() {
    let shapes = shapes();
    for normal in [DVec3::Y, DVec3::new(0.6, 0.8, 0.0)] {
        let ground = Some(Ground { normal, height: -0.1, friction: 0.1 });
        let mut world = World::new(WorldOptions { ground, ..WorldOptions::default() }).unwrap();
        for (n, shape) in shapes.iter().enumerate() {
            let start = Start {
                position: Some(normal * 0.6 + DVec3::Z * n as f64),
                orientation: DQuat::from_rotation_x(0.4 + n as f64),
                spin: DVec3::new(2.0, 1.0, 3.0),
                v: vec![0.3; 6],
                ..Start::default()
            };
            world.add(shape, &start).unwrap();
        }
        let skin = world.skin();
        let (mut touching, mut above) = (0, 0);
        for step in 0..2000 {
            let mut expected = 0;
            for body in world.bodies() {
                let positions: Vec<DVec3> = body.shape().model().positions(body.q()).unwrap();
                let gap = |x: DVec3| normal.dot(body.pose().apply(x)) + 0.1;
                expected += positions.into_iter().filter(|x| gap(*x) < skin).count();
            }
            let found = world.advance(&mut ()).unwrap().ground;
            assert_eq!(found, expected, "step {step}");
            touching += usize::from(found > 0);
            above += usize::from(found == 0);
        }
        assert!(touching > 100 && above > 100, "{touching} {above}");
    }
}

#[test]
fn faces_that_touch_are_in_contact() {
    // Coplanar triangles, one with its normal up from below, one down from above.
    let triangle = |corners: [[f64; 3]; 3]| {
        let positions = corners.map(DVec3::from_array).to_vec();
        common::rigid(TriMesh::new(positions, vec![[0, 1, 2]]).unwrap(), 1.0)
    };
    let up = triangle([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    let down = triangle([[0.1, 0.0, 0.1], [0.9, 0.0, 0.1], [0.1, 0.0, 0.9]]);
    let options = WorldOptions { ground: None, gravity: DVec3::ZERO, ..WorldOptions::default() };
    let mut world = World::new(options).unwrap();
    world.add(&up, &Start::default()).unwrap();
    world.add(&down, &Start::default()).unwrap();
    let counts = world.advance(&mut ()).unwrap();
    assert_eq!((counts.inter_pairs, counts.contacts), (1, 1));
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

#[test]
fn bodies_that_penetrate_at_the_start_are_refused() {
    let shapes = shapes();
    let with = |starts: &[Start]| {
        let mut world = World::new(WorldOptions::default()).unwrap();
        for start in starts {
            world.add(&shapes[0], start).unwrap();
        }
        world.check_start()
    };
    let at = |x: f64, y: f64| Start { position: Some(DVec3::new(x, y, 0.0)), ..Start::default() };
    assert_eq!(with(&[at(0.0, 0.2), at(0.5, 0.2)]), Ok(()));
    let error = with(&[at(0.0, 0.2), at(0.3, 0.25)]).unwrap_err();
    assert!(matches!(error, DynamicsError::Interpenetration { body: 1, what: Obstacle::Body(0), .. }));
    assert!(error.to_string().starts_with("body 1 (counted from 0) begins in body 0"), "{error}");
    let error = with(&[at(0.0, 0.5), at(5.0, 0.05)]).unwrap_err();
    assert!(matches!(error, DynamicsError::Interpenetration { body: 1, what: Obstacle::Ground, .. }));
    // A folded body.
    let r = shapes[1].model().rank();
    let folded = (0..r).flat_map(|k| [-1.0, 1.0].map(|s| (k, s))).find_map(|(k, s)| {
        let mut q = vec![0.0; r];
        q[k] = s * 0.3 / shapes[1].reach()[k];
        let mut query = sscc::Query::new(shapes[1].model(), shapes[1].certificates()).unwrap();
        query.first(&q).unwrap().map(|_| q)
    });
    let start = Start { q: folded.unwrap(), ..Start::default() };
    let check_start = |response| {
        let mut world =
            World::new(WorldOptions { ground: None, response, ..WorldOptions::default() }).unwrap();
        world.add(&shapes[1], &start).unwrap();
        world.check_start()
    };
    let error = check_start(Response::Contact).unwrap_err();
    assert!(matches!(error, DynamicsError::Interpenetration { body: 0, what: Obstacle::Itself, .. }));
    // Bodies without a contact response may begin in self-collision.
    assert_eq!(
        (check_start(Response::Ignore).is_ok(), check_start(Response::Constrain).is_ok()),
        (true, true)
    );
}

#[test]
fn invalid_options_and_starts_are_refused() {
    let shapes = shapes();
    let refused = |options: WorldOptions| World::new(options).err().map(|error| error.to_string());
    let fine = WorldOptions::default();
    let contact = ContactOptions::default();
    let ground = Ground::default();
    assert_eq!(refused(fine), None);
    for wrong in [
        WorldOptions { step: 0.0, ..fine },
        WorldOptions { step: f64::NAN, ..fine },
        WorldOptions { gravity: DVec3::NAN, ..fine },
        WorldOptions { contact: ContactOptions { frequency: 0.0, ..contact }, ..fine },
        WorldOptions { contact: ContactOptions { damping: -0.1, ..contact }, ..fine },
        WorldOptions { contact: ContactOptions { friction: f64::INFINITY, ..contact }, ..fine },
        WorldOptions { contact: ContactOptions { skin: Some(0.0), ..contact }, ..fine },
        WorldOptions { contact: ContactOptions { iterations: 0, ..contact }, ..fine },
        WorldOptions { ground: Some(Ground { normal: DVec3::ONE, ..ground }), ..fine },
        WorldOptions { ground: Some(Ground { height: f64::NAN, ..ground }), ..fine },
        WorldOptions { ground: Some(Ground { friction: -1.0, ..ground }), ..fine },
    ] {
        let error = refused(wrong).unwrap();
        assert!(!error.contains('\n') && error.contains("must"), "{error}");
    }
    let mut world = World::new(fine).unwrap();
    for wrong in [
        Start { position: Some(DVec3::INFINITY), ..Start::default() },
        Start { velocity: DVec3::NAN, ..Start::default() },
        Start { spin: DVec3::X * 1.01 / fine.step, ..Start::default() },
        Start { orientation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Start::default() },
        Start { q: vec![0.0], ..Start::default() },
        Start { v: vec![f64::NAN; 6], ..Start::default() },
        Start { damping: Damping { mass: -1.0, stiffness: 0.0 }, ..Start::default() },
    ] {
        assert!(world.add(&shapes[0], &wrong).is_err(), "{wrong:?}");
    }
    assert!(world.bodies().is_empty());
}

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

/// A body that no other one and no ground is near: a step needs none of its positions, but its state is given to others.
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
        assert_eq!(error, DynamicsError::Core(sscc::Error::CoordinatesRange));
        assert_eq!(world.steps(), 16);
    }
}

#[test]
fn phases_come_in_order_and_quiet_steps_allocate_nothing() {
    let shapes = shapes();
    let mut world = World::new(WorldOptions::default()).unwrap();
    let high =
        Start { position: Some(DVec3::Y * 50.0), velocity: DVec3::X, spin: DVec3::Z, ..Start::default() };
    world.add(&shapes[0], &high).unwrap();
    let mut phases = Vec::new();
    world.advance(&mut |phase: Phase| phases.push(phase)).unwrap();
    use Phase::{Contacts, Done, Dynamics, Ground, InterObject, SelfCollision};
    assert_eq!(phases, [SelfCollision, InterObject, Ground, Contacts, Dynamics, Done]);
    let allocations = allocation_counter::measure(|| {
        for _ in 0..500 {
            world.advance(&mut ()).unwrap();
        }
    });
    assert_eq!(allocations.count_total, 0);
}

/// The integrator advances linear modes independently, so their stiffness must be diagonal.
#[test]
fn coupled_linear_modes_are_refused() {
    let mesh = octahedron(1.0);
    let modes = Modes::from_matrix(6, 2, |row, k| f64::from(u8::from(row % 5 == k))).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let (certificates, mass) = (certified(&model), *rigid(octahedron(1.0), 1.0).mass());
    let with = |entries: [f64; 4]| {
        let elasticity = Elasticity::Linear(Stiffness::new(2, entries.to_vec()).unwrap());
        Shape::new(model.clone(), certificates.clone(), elasticity, mass)
    };
    assert!(with([1.0, 1e-13, 1e-13, 2.0]).is_ok());
    assert_eq!(with([1.0, 0.5, 0.5, 2.0]).unwrap_err(), DynamicsError::Coupled);
}
