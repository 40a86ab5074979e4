//! Lattices keep separate parts apart and connected parts together.

use glam::{DQuat, DVec3};
use sscc::TriMesh;

use super::super::Lattice;
use super::bodies::{cuboid, cut_ring, folded_plate, mesh, moved, sphere};
use super::{distances, duplicates, lattice, mesh_volume, volume};
use crate::shapes::spring;

/// Returns the number of cubes on the shortest path from a surface vertex to each other one.
fn surface_distances(lattice: &Lattice, from: usize) -> Vec<u32> {
    let of_node = distances(lattice, lattice.interpolation.vertices[from][0].0);
    lattice.interpolation.vertices.iter().map(|of| of_node[of[0].0 as usize]).collect()
}

fn rotated(of: &TriMesh) -> TriMesh {
    let rotation = DQuat::from_axis_angle(DVec3::new(0.3, -1.0, 0.4).normalize(), 1.1);
    moved(of, |p| rotation * p)
}

/// The path through cubes between the ends of a nearly closed ring is as long as the ring.
#[test]
fn ends_of_a_nearly_closed_ring_stay_separate() {
    for gap in [1e-3, 1e-6, 1e-9, 1e-14] {
        for ring in [cut_ring(gap), rotated(&cut_ring(gap))] {
            for cells in [Some(12), Some(40), None] {
                let lattice = lattice(&ring, cells);
                let last = ring.rest_positions().len() - 1;
                for start in 0..4 {
                    let steps = surface_distances(&lattice, start)[last];
                    // The shortest path follows the inside of the ring in diagonal steps.
                    let shortest = std::f64::consts::TAU * 0.7 / (lattice.spacing * 3_f64.sqrt());
                    assert!(
                        f64::from(steps) >= 0.9 * shortest - 2.0,
                        "{gap} {cells:?}: {steps} < {shortest}"
                    );
                }
                let error = volume(&lattice) / mesh_volume(&ring) - 1.0;
                assert!(error.abs() < 0.03, "{gap} {cells:?}: {error}");
                // By default a wide gap may lie between two layers of cubes.
                assert!(duplicates(&lattice) > 0 || cells.is_none() && gap == 1e-3, "{gap} {cells:?}");
            }
        }
    }
}

/// All layers of a folded plate lie in the same cells, but the path through cubes is as long as the plate.
#[test]
fn layers_of_a_folded_plate_stay_separate() {
    for height in [0.02, 1e-3, 1e-7] {
        let plate = folded_plate(12, height);
        for plate in [plate.clone(), rotated(&plate)] {
            let lattice = lattice(&plate, Some(9));
            let last = plate.rest_positions().len() - 4;
            let steps = surface_distances(&lattice, 0)[last];
            // The path has diagonal steps, and both cubes at a fold may belong to both layers.
            let shortest = 12.0 * (1.0 / (lattice.spacing * 3_f64.sqrt()) - 2.0);
            assert!(f64::from(steps) >= shortest && shortest > 20.0, "{height}: {steps} < {shortest}");
            let copies = duplicates(&lattice) as f64 / lattice.cubes.len() as f64;
            assert!(copies > 0.9, "{height}: {copies}");
            let error = volume(&lattice) / mesh_volume(&plate).abs() - 1.0;
            // Lines a quarter of a cell apart sample the outline; MIN_FILL gives the thickness of thinner plates.
            assert!(height < 0.01 || error.abs() < 0.1, "{height}: {error}");
        }
    }
}

/// A closed ring has no duplicate cells.
#[test]
fn a_closed_ring_has_no_duplicate_cells() {
    let cut = cut_ring(0.0);
    let count = cut.rest_positions().len() as u32 - 4;
    let faces = cut.faces()[4..].iter().map(|face| face.map(|v| v % count)).collect();
    let ring = mesh(cut.rest_positions()[..count as usize].to_vec(), faces);
    let lattice = lattice(&ring, Some(40));
    assert_eq!(duplicates(&lattice), 0);
    assert!(surface_distances(&lattice, 0)[count as usize - 4] <= 1);
}

/// Coils of the spring are a tube radius (0.03) apart, less than a cell, and stay separate.
#[test]
fn coils_of_a_spring_stay_separate() {
    let spring = spring();
    let rings: Vec<DVec3> =
        spring.rest_positions().chunks_exact(16).map(|ring| ring.iter().sum::<DVec3>() / 16.0).collect();
    let steps: Vec<f64> =
        (0..rings.len()).map(|i| (rings[i] - rings[(i + 1) % rings.len()]).length()).collect();
    let whole: f64 = steps.iter().sum();
    for cells in [12, 20, 30, 60] {
        let lattice = lattice(&spring, Some(cells));
        let mut along: f64 = 0.0;
        let distances = surface_distances(&lattice, 0);
        for (ring, step) in steps.iter().enumerate() {
            let distance = along.min(whole - along);
            // Paths pass cubes diagonally, and the inside of the bent tube is shorter than its centreline.
            let passed = f64::from(distances[16 * ring] + 2) * lattice.spacing * 3_f64.sqrt();
            assert!(
                passed > 0.7 * distance,
                "{cells}: ring {ring} is {distance} away, but only {passed} through cubes"
            );
            along += step;
        }
    }
}

/// Plates much thinner than cells are one piece, and both sides share cubes.
#[test]
fn plates_thinner_than_cells_are_one_piece() {
    for thickness in [0.1, 1e-3, 1e-8] {
        let slab = cuboid(DVec3::ZERO, DVec3::new(2.0, 1.5, thickness));
        for (plate, cells) in [(slab.clone(), Some(20)), (rotated(&slab), Some(20)), (rotated(&slab), None)] {
            let lattice = lattice(&plate, cells);
            assert_eq!(duplicates(&lattice), 0, "{thickness} {cells:?}");
        }
    }
}

/// The surface connects a rod that is thinner than the distance of the lines.
#[test]
fn a_needle_thinner_than_the_distance_of_lines_is_one_piece() {
    for width in [0.05, 1e-3, 1e-6] {
        let needle = cuboid(DVec3::ZERO, DVec3::new(2.0, width, 0.7 * width));
        for (needle, cells) in [(needle.clone(), 20), (rotated(&needle), 20), (rotated(&needle), 7)] {
            assert_eq!(duplicates(&lattice(&needle, Some(cells))), 0);
        }
    }
}

/// An unused vertex does not change the lattice and does not move.
#[test]
fn unused_vertices_do_not_change_the_lattice() {
    let ball = sphere(3);
    let mut positions = ball.rest_positions().to_vec();
    positions.push(DVec3::splat(1e9));
    let with = lattice(&mesh(positions, ball.faces().to_vec()), Some(10));
    assert_eq!(with.cubes, lattice(&ball, Some(10)).cubes);
    assert_eq!(with.interpolation.apply(&with.vertices).last(), Some(&DVec3::ZERO));
}

#[test]
fn surfaces_split_along_seams_have_the_same_lattice() {
    let whole = sphere(3);
    let apart = whole.faces().iter().flatten().map(|v| whole.rest_positions()[*v as usize]).collect();
    let split = mesh(apart, (0..whole.faces().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect());
    let (of_whole, of_split) = (lattice(&whole, Some(12)), lattice(&split, Some(12)));
    assert!(of_split.is_split && !of_whole.is_split);
    assert_eq!((&of_split.vertices, &of_split.cubes), (&of_whole.vertices, &of_whole.cubes));
    for (at, v) in whole.faces().iter().flatten().enumerate() {
        assert_eq!(of_split.interpolation.vertices[at], of_whole.interpolation.vertices[*v as usize]);
    }
}
