use super::*;
use crate::ModelInfo;
use crate::container::{MODEL, model_from_bytes, model_to_bytes};
use glam::DVec3;
use sscc::{Modes, ReducedModel, TriMesh};

/// A triangle with two modes.
fn model() -> ReducedModel {
    let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let modes = Modes::from_matrix(3, 2, |row, k| (1 + row + k) as f64).unwrap();
    ReducedModel::new(mesh, modes).unwrap()
}

fn stiffness(entries: &[f64]) -> Stiffness {
    Stiffness::new(entries.len().isqrt(), entries.to_vec()).unwrap()
}

fn nonlinear() -> Elasticity {
    let count = |n: usize| (0..n).map(|i| i as f64 - 2.5).collect();
    let linear = stiffness(&[2.0, -0.5, -0.5, 1e9]);
    Elasticity::Nonlinear(ReducedForces::new(linear, count(6), count(8)).unwrap())
}

fn write_model(elasticity: Elasticity) -> Result<Vec<u8>, FormatError> {
    model_to_bytes(&model(), &ModelInfo::new("m", "test").with_elasticity(elasticity))
}

#[test]
fn forces_round_trip_bit_for_bit() {
    // The first matrix is symmetric only up to rounding.
    let linear = Elasticity::Linear(stiffness(&[2.0, -0.5, -0.5 + 1e-12, 3.0]));
    for elasticity in [linear, nonlinear()] {
        assert_eq!((elasticity.rank(), elasticity.stiffness().entries()[0]), (2, 2.0));
        let bytes = write_model(elasticity.clone()).unwrap();
        let (model, info) = model_from_bytes(&bytes).unwrap();
        assert_eq!((info.units.as_str(), info.elasticity.as_ref()), ("m", Some(&elasticity)));
        assert_eq!(model_to_bytes(&model, &info).unwrap(), bytes);
        assert_eq!(Container::parse(&bytes, MODEL).unwrap().text("mass").unwrap(), "identity");
        for at in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[at] ^= 1 << (at % 8);
            assert!(model_from_bytes(&flipped).is_err(), "byte {at}");
            assert!(model_from_bytes(&bytes[..at]).is_err(), "length {at}");
        }
    }
}

#[test]
fn a_model_without_forces_has_no_force_tensors() {
    let bytes = model_to_bytes(&model(), &ModelInfo::new("m", "test")).unwrap();
    let file = Container::parse(&bytes, MODEL).unwrap();
    assert_eq!(file.names(), ["faces", "metric_scales", "modes", "rest_positions"]);
    assert!(file.text("mass").is_err());
    assert_eq!(model_from_bytes(&bytes).unwrap().1.elasticity, None);
}

#[test]
fn forces_of_another_rank_are_rejected_by_the_writer() {
    let message = write_model(Elasticity::Linear(stiffness(&[1.0]))).unwrap_err().to_string();
    assert_eq!(message, "tensor 'stiffness': the stiffness has 1 modes, the model has 2");
}

/// Reads forces of rank 2 from these tensors, with a valid digest; returns the error message or the forces.
fn message(mass: Option<&str>, tensors: &[(&str, &[usize], &[f64])]) -> String {
    let mut writer = ContainerWriter::new(MODEL);
    if let Some(mass) = mass {
        writer.text("mass", mass);
    }
    tensors.iter().for_each(|(name, shape, values)| {
        writer.f64(name, shape, values);
    });
    let bytes = writer.finish().unwrap();
    let read = read(&Container::parse(&bytes, MODEL).unwrap(), 2);
    read.map_or_else(|error| error.to_string(), |found| format!("{found:?}"))
}

#[test]
fn invalid_forces_are_rejected() {
    let stiffness = |shape, values| message(Some("identity"), &[("stiffness", shape, values)]);
    let good: (&str, &[usize], &[f64]) = ("stiffness", &[2, 2], &[1.0; 4]);
    assert!(message(Some("identity"), &[good]).starts_with("Some(Linear"));
    assert_eq!(message(None, &[good]), "metadata 'mass': missing");
    assert_eq!(message(Some("lumped"), &[good]), "metadata 'mass': unknown mass 'lumped'");
    assert!(stiffness(&[4], &[1.0; 4]).contains("it has the shape [4], [2, 2] was expected"));
    assert!(stiffness(&[3, 3], &[1.0; 9]).contains("[2, 2] was expected"));
    assert!(stiffness(&[2, 2], &[1.0, 0.0, 0.0, f64::INFINITY]).contains("inf at row 1, column 1"));
    assert!(stiffness(&[2, 2], &[1.0, 0.0, 0.0, 1e70]).contains("beyond 2^200"));
    assert!(stiffness(&[2, 2], &[1.0, 1e-8, 0.0, 1.0]).contains("0e0 at row 1, column 0"));
    let (quadratic, cubic): (&[usize], &[usize]) = (&[2, 3], &[2, 4]);
    let with = |more: &[(&str, &[usize], &[f64])]| message(Some("identity"), &[&[good], more].concat());
    assert!(with(&[("forces_quadratic", quadratic, &[1.0; 6])]).contains("'forces_cubic': missing"));
    assert!(with(&[("forces_cubic", cubic, &[1.0; 8])]).contains("'forces_quadratic': missing"));
    let wrong = [("forces_quadratic", quadratic, &[1.0; 6][..]), ("forces_cubic", &[2, 5], &[1.0; 10])];
    assert!(with(&wrong).contains("tensor 'forces_cubic': it has the shape [2, 5], [2, 4] was expected"));
    let nan = [("forces_quadratic", quadratic, &[f64::NAN; 6][..]), ("forces_cubic", cubic, &[1.0; 8])];
    assert!(
        with(&nan).contains("tensor 'forces_quadratic': a coefficient of degree 2 is NaN at row 0, column 0")
    );
    let alone = message(Some("identity"), &[("forces_quadratic", quadratic, &[1.0; 6])]);
    assert_eq!(alone, "tensor 'stiffness': missing");
}

#[test]
fn shapes_of_large_ranks_saturate() {
    assert_eq!(shapes(usize::MAX >> 24)[2].1[1], usize::MAX - 1);
}
