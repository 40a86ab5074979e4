//! Lattices of bodies with known volume and topology.

mod bodies;
mod models;
mod refusals;
mod separation;
mod volumes;

use std::collections::VecDeque;

use glam::DVec3;
use sscc::TriMesh;

use super::Lattice;
use super::copies::MIN_FILL;

fn lattice(mesh: &TriMesh, cells: Option<usize>) -> Lattice {
    let lattice = Lattice::around(mesh, cells, &()).unwrap_or_else(|error| panic!("{error}"));
    check(&lattice, mesh);
    lattice
}

/// Checks the properties of every lattice.
fn check(lattice: &Lattice, mesh: &TriMesh) {
    let Lattice { vertices, cubes, fill, spacing, interpolation, .. } = lattice;
    assert_eq!(cubes.len(), fill.len());
    assert!(fill.iter().flatten().all(|share| (MIN_FILL..=1.0).contains(share)));
    let size = vertices.iter().map(|p| p.length()).fold(0.0, f64::max);
    let tolerance = 1e-13 * size + 1e-12 * spacing;
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    for cube in cubes {
        let p = cube.map(|node| vertices[node as usize]);
        for (p_k, corner) in p.iter().zip(corners) {
            let expected = p[0] + *spacing * DVec3::from_array(corner.map(f64::from));
            assert!((*p_k - expected).length() <= tolerance, "not a cube");
        }
    }
    let mut used = 0;
    for node in cubes.iter().flatten() {
        assert!(*node <= used, "nodes are in order of first use");
        used = used.max(node + 1);
    }
    assert_eq!(used as usize, vertices.len());
    assert!(distances(lattice, 0).iter().all(|d| *d != u32::MAX), "one piece");

    let is_used = mesh.used_vertices();
    let linear = |p: DVec3| DVec3::new(p.y - 0.5 * p.z, 2.0 * p.x + p.y, p.x + 3.0 * p.z);
    let mapped = interpolation.apply(vertices);
    let field = interpolation.apply(&vertices.iter().map(|p| linear(*p)).collect::<Vec<_>>());
    for (v, p) in mesh.rest_positions().iter().enumerate() {
        let weights = interpolation.vertices[v].map(|(_, weight)| weight);
        let sum: f64 = weights.iter().sum();
        if is_used.binary_search(&(v as u32)).is_err() {
            assert_eq!(sum, 0.0);
            continue;
        }
        assert!(
            (sum - 1.0).abs() < 1e-15 * 8.0 && weights.iter().all(|w| (-1e-12..=1.0 + 1e-12).contains(w))
        );
        assert!((mapped[v] - *p).length() <= tolerance, "{} is not {p}", mapped[v]);
        assert!((field[v] - linear(*p)).length() <= 8.0 * tolerance);
    }
}

fn volume(lattice: &Lattice) -> f64 {
    lattice.fill.iter().flatten().sum::<f64>() * lattice.spacing.powi(3) / 8.0
}

fn mesh_volume(mesh: &TriMesh) -> f64 {
    let p = mesh.rest_positions();
    let origin = p[0];
    let of = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| p[v as usize] - origin);
        a.dot(b.cross(c)) / 6.0
    };
    mesh.faces().iter().map(of).sum()
}

/// Returns the number of cubes on the shortest path from a node to each other one.
fn distances(lattice: &Lattice, from: u32) -> Vec<u32> {
    let mut cubes_of = vec![Vec::new(); lattice.vertices.len()];
    for (cube, nodes) in lattice.cubes.iter().enumerate() {
        nodes.iter().for_each(|node| cubes_of[*node as usize].push(cube));
    }
    let mut distance = vec![u32::MAX; lattice.vertices.len()];
    distance[from as usize] = 0;
    let mut open = VecDeque::from([from]);
    while let Some(node) = open.pop_front() {
        for cube in &cubes_of[node as usize] {
            for other in lattice.cubes[*cube] {
                if distance[other as usize] == u32::MAX {
                    distance[other as usize] = distance[node as usize] + 1;
                    open.push_back(other);
                }
            }
        }
    }
    distance
}

/// Returns the number of cubes that share their cell with another one.
fn duplicates(lattice: &Lattice) -> usize {
    let place = |cube: &[u32; 8]| {
        let p = lattice.vertices[cube[0] as usize] - lattice.vertices[0];
        (p / lattice.spacing).round().to_array().map(|x| x as i64)
    };
    let mut places: Vec<_> = lattice.cubes.iter().map(place).collect();
    places.sort_unstable();
    places.chunk_by(|a, b| a == b).filter(|same| same.len() > 1).map(<[_]>::len).sum()
}
