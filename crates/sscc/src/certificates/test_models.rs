//! Models for the tests of certificates.

use glam::DVec3;

use crate::{Modes, ReducedModel, TriMesh};

/// Returns a strip of 2 x `quads` triangles bent to an open ring, with smooth modes, under which its ends and its
/// middle collide.
pub(super) fn ring(quads: usize, rank: usize, seed: f64) -> ReducedModel {
    let angle = |i: usize| 5.6 * i as f64 / quads as f64;
    let positions: Vec<DVec3> = (0..=quads)
        .flat_map(|i| [0.0, 0.4].map(|y| DVec3::new(angle(i).cos(), y + 0.1 * angle(i), angle(i).sin())))
        .collect();
    let faces =
        (0..quads as u32).map(|i| 2 * i).flat_map(|i| [[i, i + 1, i + 2], [i + 1, i + 3, i + 2]]).collect();
    let mode = |p: &DVec3, k: usize| {
        let (a, b) = (seed + k as f64, seed * 0.7 + 2.0 * k as f64);
        DVec3::new(
            p.x * a.sin() + p.z * p.x * b.cos(),
            p.x * p.z * a.cos(),
            p.z * b.sin() + p.x * p.x * a.cos(),
        )
    };
    let displacements = positions.iter().flat_map(|p| (0..rank).map(move |k| mode(p, k))).collect();
    let mesh = TriMesh::new(positions, faces).unwrap();
    ReducedModel::new(mesh, Modes::new(rank, displacements).unwrap()).unwrap()
}
