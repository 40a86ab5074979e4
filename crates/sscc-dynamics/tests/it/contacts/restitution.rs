//! Restitution of impacts.

use glam::DVec3;
use sscc_dynamics::{ContactOptions, Start, World, WorldOptions};
use sscc_solid::Material;

use crate::common::{block, octahedron, rigid};

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
