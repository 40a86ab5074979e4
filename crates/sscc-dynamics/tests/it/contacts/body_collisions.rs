//! Collisions between bodies, and their momenta.

use glam::{DQuat, DVec3};
use sscc::{Pair, TriMesh, intersect_triangle_triangle};
use sscc_dynamics::{ContactOptions, Detection, Start, World, WorldOptions};

use crate::common::worlds::{intersections, momenta, pile, placed, shapes, space};
use crate::common::{block, elastic, rigid, rigid_block, rubber};

#[test]
fn pairs_between_bodies_equal_brute_force() {
    let shapes = shapes();
    // Bodies that intersect at the start collide until they are apart; then they never meet again.
    let mut world = pile(&shapes, Detection::Certified, 0.2);
    let (mut met, mut apart) = (0, 0);
    for step in 0..700 {
        let placed = placed(&world);
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
fn faces_that_touch_are_in_contact() {
    // Coplanar triangles, one with its normal up from below, one down from above.
    let triangle = |corners: [[f64; 3]; 3]| {
        let positions = corners.map(DVec3::from_array).to_vec();
        rigid(TriMesh::new(positions, vec![[0, 1, 2]]).unwrap(), 1.0)
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

#[test]
fn three_bodies_in_a_row_meet_in_one_step_and_keep_their_momentum() {
    // The gaps between the blocks are much smaller than the displacement in a step.
    let shape = rigid_block([1, 1, 1], 0.2, 2.0);
    let mut world = World::new(space(1e-3)).unwrap();
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
