//! Reduced stiffness matrices are correct and symmetric, and invalid ones are rejected.

use crate::common::Random;
use crate::matrix::{diagonal, dot, random_modes, stiffness, times, transpose, with_spectrum};
use sscc::Modes;
use sscc_modes::{ModesError, diagonalize, reduced_stiffness};
use sscc_solid::SolidError;

#[test]
fn a_reduced_stiffness_is_symmetric_and_correct() {
    let mut random = Random(9);
    let modes = random_modes(&mut random, 4, 5);
    let full = with_spectrum(&mut random, &(1..=12).map(f64::from).collect::<Vec<_>>());
    let column =
        |k: usize| (0..12).map(|row| modes.of_vertex(row / 3)[k][row as usize % 3]).collect::<Vec<_>>();
    let found = reduced_stiffness(&modes, |u, force| force.copy_from_slice(&times(&full, u))).unwrap();
    assert_eq!(found.entries(), transpose(5, found.entries()));
    for (at, x) in found.entries().iter().enumerate() {
        let wanted = dot(&column(at / 5), &times(&full, &column(at % 5)));
        assert!((x - wanted).abs() < 1e-12, "{at}: {x} {wanted}");
    }
    let asymmetric = reduced_stiffness(&modes, |u, force| {
        force.fill(0.0);
        force[0] = u[1];
    });
    assert!(
        matches!(asymmetric, Err(ModesError::Solid(SolidError::StiffnessAsymmetric { .. }))),
        "{asymmetric:?}"
    );
    let nan = reduced_stiffness(&modes, |_, force| force.fill(f64::NAN));
    assert!(
        matches!(nan, Err(ModesError::Solid(SolidError::StiffnessEntry { row: 0, column: 0, .. }))),
        "{nan:?}"
    );
}

#[test]
fn asymmetry_by_rounding_is_removed() {
    let modes = random_modes(&mut Random(10), 2, 2);
    let found = diagonalize(&modes, &stiffness(2, &[2.0, 1.0 + 1e-12, 1.0 - 1e-12, 2.0])).unwrap();
    assert_eq!(found, diagonalize(&modes, &stiffness(2, &[2.0, 1.0, 1.0, 2.0])).unwrap());
    for noise in [1e-13, -1e-13] {
        assert_eq!(
            diagonalize(&modes, &stiffness(2, &diagonal(&[noise, 1.0]))).unwrap().eigenvalues,
            [0.0, 1.0]
        );
    }
    let soft = diagonalize(&modes, &stiffness(2, &diagonal(&[1e-11, 1.0]))).unwrap().eigenvalues[0];
    assert!((soft - 1e-11).abs() < 1e-16, "{soft:e}");
}

#[test]
fn invalid_matrices_are_rejected() {
    let modes = random_modes(&mut Random(11), 2, 2);
    let error = |entries: &[f64]| {
        let error = diagonalize(&modes, &stiffness(2, entries)).unwrap_err();
        assert!(!error.to_string().contains('\n'), "{error}");
        error
    };
    let other = diagonalize(&modes, &stiffness(3, &[1.0; 9])).unwrap_err();
    assert_eq!(other, ModesError::StiffnessRank { found: 3, rank: 2 });
    assert_eq!(
        error(&diagonal(&[-1.0, 4.0])),
        ModesError::StiffnessIndefinite { eigenvalue: -1.0, largest: 4.0 }
    );
    assert!(matches!(error(&diagonal(&[-1e-11, 1.0])), ModesError::StiffnessIndefinite { .. }));
    assert!(matches!(error(&[1.0, 2.0, 2.0, 1.0]), ModesError::StiffnessIndefinite { .. }));
    assert!(matches!(error(&[-1.0, 0.0, 0.0, -2.0]), ModesError::StiffnessIndefinite { .. }));

    // The rotated entries of these modes are out of range.
    let huge = Modes::from_matrix(1, 2, |_, _| sscc::limits::LARGEST).unwrap();
    let error = diagonalize(&huge, &stiffness(2, &[2.0, -1.0, -1.0, 2.0])).unwrap_err();
    assert!(matches!(error, ModesError::Core(sscc::Error::ModeEntry { .. })), "{error}");
}
