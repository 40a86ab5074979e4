//! Test shapes built from few cubes.
#![allow(missing_docs)]

pub mod random_scene;
pub mod worlds;

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use sscc::{Certificates, CertifyOptions, Modes, ReducedModel, TriMesh};
use sscc_dynamics::Shape;
use sscc_modes::{energy_metric, linear_modes, nonlinear_modes};
use sscc_solid::{Elasticity, MassProperties, Material, PartialMaterial, Solid, Stiffness};

pub fn certified(model: &ReducedModel) -> Certificates {
    Certificates::compute(model, &CertifyOptions::default(), &()).unwrap()
}

/// Returns a rigid shape: its only mode has no displacement.
pub fn rigid(mesh: TriMesh, mass: f64) -> Shape {
    let p = mesh.rest_positions();
    let center = p.iter().sum::<DVec3>() / p.len() as f64;
    // Mass properties of equal point masses at the vertices.
    let mut inertia = DMat3::ZERO;
    for x in p.iter().map(|x| *x - center) {
        let outer = DMat3::from_cols(x * x.x, x * x.y, x * x.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(x.length_squared())) - outer) * (mass / p.len() as f64);
    }
    let modes = Modes::new(1, vec![DVec3::ZERO; p.len()]).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let certificates = certified(&model);
    let mass = MassProperties { mass, center, inertia };
    let elasticity = Elasticity::Linear(Stiffness::from_diagonal(&[1.0]).unwrap());
    Shape::new(model, certificates, elasticity, mass).unwrap()
}

/// Returns an octahedron with a vertex at the bottom.
pub fn octahedron(radius: f64) -> TriMesh {
    let positions = [DVec3::X, DVec3::Y, DVec3::Z].map(|x| [x * radius, -x * radius]).concat();
    let faces = (0..8).map(|n: u32| {
        let [x, y, z] = [n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2 & 1)];
        if n.count_ones().is_multiple_of(2) { [x, y, z] } else { [x, z, y] }
    });
    TriMesh::new(positions, faces.collect()).unwrap()
}

/// Returns a solid of cubes of the given size at points of a grid.
pub fn cubes(places: &[[i32; 3]], size: f64, material: Material) -> Solid {
    let mut numbers = BTreeMap::new();
    let mut vertices = Vec::new();
    let mut cubes = Vec::new();
    for place in places {
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        cubes.push(corners.map(|corner: [i32; 3]| {
            let at: [i32; 3] = std::array::from_fn(|n| place[n] + corner[n]);
            *numbers.entry(at).or_insert_with(|| {
                vertices.push(DVec3::from_array(at.map(f64::from)) * size);
                vertices.len() as u32 - 1
            })
        }));
    }
    Solid::uniform(vertices, Vec::new(), cubes, material).unwrap()
}

/// Returns a solid block of cubes.
pub fn block(counts: [i32; 3], size: f64, material: Material) -> Solid {
    let all =
        (0..counts[0]).flat_map(|x| (0..counts[1]).flat_map(move |y| (0..counts[2]).map(move |z| [x, y, z])));
    cubes(&all.collect::<Vec<_>>(), size, material)
}

/// Returns a solid with two parallel arms, one cube apart, joined at one end.
pub fn fork(arm: i32, size: f64, material: Material) -> Solid {
    let mut places = Vec::new();
    for y in 0..arm {
        places.extend([[0, y, 0], [2, y, 0]]);
    }
    places.push([1, 0, 0]);
    cubes(&places, size, material)
}

/// Returns the shape of a solid with its lowest modes; `fixed` lists the held vertices.
pub fn elastic(solid: &Solid, rank: usize, large: bool, fixed: &[u32]) -> Shape {
    let found =
        if large { nonlinear_modes(solid, fixed, rank, &()) } else { linear_modes(solid, fixed, rank, &()) };
    let found = found.unwrap();
    let boundary = solid.boundary().unwrap();
    let modes = boundary.on_surface(&found.modes).unwrap();
    let metric = energy_metric(&found.eigenvalues()).unwrap();
    let model = ReducedModel::with_metric(boundary.mesh, modes, metric).unwrap();
    let certificates = certified(&model);
    let moments = solid.mode_moments(&found.modes).unwrap();
    let shape = Shape::new(model, certificates, found.elasticity, solid.mass_properties()).unwrap();
    shape.with_moments(moments).unwrap()
}

/// Returns the material of soft rubber.
pub fn rubber() -> Material {
    Material::new(&PartialMaterial { youngs_modulus: Some(1e5), ..PartialMaterial::default() }).unwrap()
}

/// Returns the shape of a block of cubes without modes.
pub fn rigid_block(counts: [i32; 3], size: f64, mass: f64) -> Shape {
    rigid(block(counts, size, Material::default()).boundary().unwrap().mesh, mass)
}
