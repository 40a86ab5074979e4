//! Lattices have the volume of their surface.

use glam::{DQuat, DVec3};

use super::super::copies::MIN_FILL;
use super::bodies::{cuboid, inverted, joined, moved, sphere};
use super::{duplicates, lattice, mesh_volume, volume};
use crate::shapes::{hare, serpent, spring};

#[test]
fn boxes_have_their_volume() {
    let aligned = cuboid(DVec3::new(-1.0, 2.0, 0.0), DVec3::new(1.0, 3.3, 1.1));
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let tilted = moved(&aligned, |p| rotation * p);
    for mesh in [&aligned, &tilted, &inverted(&tilted)] {
        for cells in [None, Some(19), Some(20), Some(33)] {
            let lattice = lattice(mesh, cells);
            let error = volume(&lattice) / mesh_volume(mesh).abs() - 1.0;
            assert!(error.abs() < 0.005, "{cells:?}: {error}");
            assert_eq!(duplicates(&lattice), 0);
        }
        let count = lattice(mesh, None).cubes.len();
        assert!((18_000..22_000).contains(&count), "{count} cubes by default");
    }
    // Exact numbers of cubes and nodes.
    let one = lattice(&aligned, Some(1));
    assert_eq!((one.cubes.len(), one.vertices.len()), (1, 8));
    let many = lattice(&aligned, Some(20));
    assert_eq!(many.cubes.len(), 20 * 14 * 12);
    assert_eq!(many.vertices.len(), 21 * 15 * 13);
    assert!(many.fill.contains(&[1.0; 8]) && many.fill.iter().flatten().any(|f| *f > MIN_FILL));
}

#[test]
fn a_ball_and_a_hollow_ball_have_their_volume() {
    let ball = sphere(4);
    let shell = joined(&[ball.clone(), inverted(&moved(&ball, |p| 0.8 * p))]);
    for mesh in [&ball, &shell] {
        for cells in [Some(9), Some(30), None] {
            let lattice = lattice(mesh, cells);
            let error = volume(&lattice) / mesh_volume(mesh) - 1.0;
            assert!(error.abs() < 0.01, "{cells:?}: {error}");
            assert_eq!(duplicates(&lattice), 0);
        }
    }
}

#[test]
fn embedded_shapes_have_their_volume() {
    for (name, mesh) in [("spring", spring()), ("hare", hare()), ("serpent", serpent())] {
        for cells in [None, Some(60)] {
            let lattice = lattice(&mesh, cells);
            let error = volume(&lattice) / mesh_volume(&mesh) - 1.0;
            assert!(error.abs() < 0.005, "{name}, {cells:?}: {error}");
        }
    }
}

/// A moved and scaled shape has the same cubes.
#[test]
fn moved_and_scaled_shapes_have_the_same_cubes() {
    let mesh = hare();
    let plain = lattice(&mesh, Some(40));
    let places =
        [(1e-3, DVec3::ZERO), (1e3, DVec3::splat(1e3)), (0.7, DVec3::new(0.3, -2.0, 5.0)), (1e50, DVec3::X)];
    for (scale, offset) in places {
        let other = lattice(&moved(&mesh, |p| (p + offset) * scale), Some(40));
        assert!(other.cubes == plain.cubes, "{scale} {offset}");
        assert!((other.spacing / scale / plain.spacing - 1.0).abs() < 1e-10);
    }
}
