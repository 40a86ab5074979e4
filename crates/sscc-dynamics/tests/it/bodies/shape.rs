//! Shapes.

use sscc::{Modes, ReducedModel};
use sscc_dynamics::{DynamicsError, Shape};
use sscc_solid::{Elasticity, Stiffness};

use crate::common::{certified, octahedron, rigid};

/// The integrator advances linear modes independently, so their stiffness must be diagonal.
#[test]
fn coupled_linear_modes_are_refused() {
    let mesh = octahedron(1.0);
    let modes = Modes::from_matrix(6, 2, |row, k| f64::from(u8::from(row % 5 == k))).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let (certificates, mass) = (certified(&model), *rigid(octahedron(1.0), 1.0).mass());
    let with = |entries: [f64; 4]| {
        let elasticity = Elasticity::Linear(Stiffness::new(2, entries.to_vec()).unwrap());
        Shape::new(model.clone(), certificates.clone(), elasticity, mass)
    };
    assert!(with([1.0, 1e-13, 1e-13, 2.0]).is_ok());
    assert_eq!(with([1.0, 0.5, 0.5, 2.0]).unwrap_err(), DynamicsError::Coupled);
}
