//! Vibrations against closed forms.

use glam::DVec3;
use sscc_dynamics::{Damping, Detection, Start, World, WorldOptions};

use crate::common::worlds::{eigenvalues, space};
use crate::common::{block, elastic, rubber};

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
