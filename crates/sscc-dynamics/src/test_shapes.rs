//! Shapes for tests.

use glam::{DMat3, DVec3};
use sscc::{Certificates, CertifyOptions, Modes, ReducedModel, TriMesh};
use sscc_solid::{Elasticity, MassProperties, Stiffness};

use crate::Shape;

/// Returns a tetrahedron with linear forces. `modes` has the displacements of each of the four vertices by all modes (4 r
/// vectors), and `stiffness` an eigenvalue for each mode.
pub(crate) fn tetrahedron(modes: Vec<DVec3>, stiffness: &[f64]) -> Shape {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mesh = TriMesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(stiffness.len(), modes).unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let inertia = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.5));
    let mass = MassProperties { mass: 3.0, center: DVec3::splat(0.25), inertia };
    let elasticity = Elasticity::Linear(Stiffness::from_diagonal(stiffness).unwrap());
    Shape::new(model, certificates, elasticity, mass).unwrap()
}
