//! Worlds: their options, their start, and the phases of their steps.

use glam::{DQuat, DVec3};
use sscc_dynamics::{
    ContactOptions, Damping, DynamicsError, Ground, Obstacle, Phase, Response, Start, World, WorldOptions,
};

use crate::common::worlds::shapes;

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
    assert!(error.to_string().ends_with(": move it, or deform it less"), "{error}");
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
    assert!(error.to_string().ends_with(" pairs of triangles): deform it less"), "{error}");
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
    let friction = ContactOptions { friction: -1e300, ..contact };
    let error = refused(WorldOptions { contact: friction, ..fine }).unwrap();
    assert!(error.contains("friction") && error.contains(" is -1e300: it must be "), "{error}");
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
