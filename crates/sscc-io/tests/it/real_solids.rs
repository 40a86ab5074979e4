//! Real volumetric meshes and reduced forces: their sizes and properties match known values.
use std::collections::{BTreeMap, BTreeSet};

use sscc_io::{read_mesh, read_reduced_forces, read_volume_mesh};
use sscc_solid::VolumeMesh;
use sscc_testing::models;

/// Volume of a tetrahedron, negative when it is inverted.
fn volume(mesh: &VolumeMesh, tet: [u32; 4]) -> f64 {
    let [a, b, c, d] = tet.map(|v| mesh.vertices()[v as usize]);
    (b - a).cross(c - a).dot(d - a) / 6.0
}

#[test]
fn real_solids_have_their_known_sizes() {
    let Some(folder) = models("real_solids_have_their_known_sizes") else { return };
    let bunny = read_volume_mesh(&folder.join("bunny_tet.mesh")).unwrap();
    assert_eq!((bunny.vertices().len(), bunny.tets().len(), bunny.surface().len()), (5_433, 34_055, 6_966));
    assert_eq!((bunny.materials().len(), bunny.element_material().len()), (1, 34_055));
    let dragon = read_volume_mesh(&folder.join("dragon_coarse_tet.veg")).unwrap();
    assert_eq!((dragon.vertices().len(), dragon.tets().len(), dragon.surface().len()), (197, 552, 0));
    let material = &dragon.materials()[0];
    let stated = material.stated;
    let values = (stated.density, stated.youngs_modulus, stated.poisson_ratio);
    assert_eq!((material.name.as_str(), values), ("defaultMaterial", (Some(1000.0), Some(1e9), Some(0.45))));
    assert!(dragon.element_material().iter().all(|m| *m == 0));
    assert_eq!(dragon.tets()[0], [0, 18, 2, 1]); // the line: 1 1 19 3 2
}

/// The tetrahedra of this file fill the convex hull of the bunny. The tetrahedra within its listed surface have the
/// volume that the triangle mesh encloses.
#[test]
fn the_listed_surface_encloses_the_bunny() {
    let Some(folder) = models("the_listed_surface_encloses_the_bunny") else { return };
    let bunny = read_volume_mesh(&folder.join("bunny_tet.mesh")).unwrap();
    let sorted = |mut face: [u32; 3]| {
        face.sort_unstable();
        face
    };
    let of_tet = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, b, d], [a, c, d], [b, c, d]].map(sorted);
    let mut faces = BTreeMap::<_, Vec<usize>>::new();
    for (i, tet) in bunny.tets().iter().enumerate() {
        of_tet(*tet).into_iter().for_each(|face| faces.entry(face).or_default().push(i));
    }
    let listed: BTreeSet<_> = bunny.surface().iter().copied().map(sorted).collect();
    assert!(listed.len() == 6_966 && listed.iter().all(|face| faces.contains_key(face)));
    assert!(faces.values().all(|tets| tets.len() <= 2));
    // Flood fill from the hull through all faces that are not listed.
    let mut outside = vec![false; bunny.tets().len()];
    let hull = |(face, tets): (&[u32; 3], &Vec<usize>)| tets.len() == 1 && !listed.contains(face);
    let mut next: Vec<_> = faces.iter().filter(|f| hull(*f)).map(|(_, tets)| tets[0]).collect();
    while let Some(tet) = next.pop() {
        if !std::mem::replace(&mut outside[tet], true) {
            let open = of_tet(bunny.tets()[tet]).into_iter().filter(|face| !listed.contains(face));
            next.extend(open.flat_map(|face| faces[&face].clone()));
        }
    }
    let volumes: Vec<_> = bunny.tets().iter().map(|tet| volume(&bunny, *tet)).collect();
    assert!(volumes.iter().all(|volume| *volume > 0.0));
    let inside: f64 = volumes.iter().zip(&outside).filter(|(_, outside)| !**outside).map(|(v, _)| v).sum();
    let mesh = read_mesh(&folder.join("bunny_6966_closed.off")).unwrap();
    let corners = mesh.faces().iter().map(|f| f.map(|v| mesh.rest_positions()[v as usize]));
    let enclosed: f64 = corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
    assert!((inside - enclosed).abs() < 1e-6 * enclosed, "{inside} {enclosed}");
    assert!(volumes.iter().sum::<f64>() > 1.6 * enclosed);
}

#[test]
fn reduced_forces_of_a_real_body() {
    let Some(folder) = models("reduced_forces_of_a_real_body") else { return };
    let forces = read_reduced_forces(&folder.join("vega_A/A.cub")).unwrap();
    let (r, linear, quadratic) = (forces.rank(), forces.linear().entries(), forces.quadratic());
    assert_eq!((r, linear.len(), quadratic.len(), forces.cubic().len()), (20, 400, 4200, 30_800));
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
    let scale = largest(linear);
    // Symmetric, and positive definite: Cholesky's diagonal stays above 0.
    let mut lower = linear.to_vec();
    for i in 0..r {
        for j in 0..=i {
            assert!((linear[i * r + j] - linear[j * r + i]).abs() < 1e-9 * scale, "{i} {j}");
            let sum: f64 = (0..j).map(|k| lower[i * r + k] * lower[j * r + k]).sum();
            let rest = lower[i * r + j] - sum;
            assert!(i != j || rest > 0.0, "{i}");
            lower[i * r + j] = if i == j { rest.sqrt() } else { rest / lower[j * r + j] };
        }
    }
    // The quadratic part is a gradient: the derivative of force i along j is that of force j along i.
    let columns = r * (r + 1) / 2;
    let at = |i: usize, j: usize| i * r - i * (i + 1) / 2 + j; // of q_i q_j, i <= j
    let twice = |force: usize, i: usize, j: usize| {
        let factor = if i == j { 2.0 } else { 1.0 };
        factor * quadratic[force * columns + at(i.min(j), i.max(j))]
    };
    let scale = largest(quadratic);
    for (i, j, k) in (0..r * r * r).map(|n| (n / r / r, n / r % r, n % r)) {
        assert!((twice(i, j, k) - twice(j, i, k)).abs() < 1e-9 * scale, "{i} {j} {k}");
    }
}
