//! The energy metric gives every mode a weight; the filter is the paper's formula.

#[allow(dead_code)] // other tests use the rest
mod common;
#[allow(dead_code)]
mod matrix;

use common::Random;
use matrix::difference;
use sscc_modes::{DEFAULT_ELL, ModesError, energy_metric, filter_eigenvalues};

#[test]
fn modes_without_energy_get_the_smallest_weight() {
    let scales = |eigenvalues: &[f64]| energy_metric(eigenvalues).unwrap().scales().to_vec();
    assert_eq!(scales(&[0.0, 0.0, 8.0, 18.0]), [2.0, 2.0, 2.0, 3.0]);
    assert_eq!(scales(&[0.0, 0.0]), [1.0, 1.0]);
    assert_eq!(scales(&[2.0, -0.0]), [1.0, 1.0]);
}

#[test]
fn the_filter_is_the_formula() {
    let mut random = Random(2);
    for ell in [0.5, 1.0, 3.0, DEFAULT_ELL, 1e6] {
        let mut eigenvalues: Vec<f64> = (0..200).map(|_| 10_f64.powf(6.0 * random.number())).collect();
        eigenvalues.sort_by(f64::total_cmp);
        let least = eigenvalues[0];
        let filtered = filter_eigenvalues(&eigenvalues, ell).unwrap();
        for (x, y) in eigenvalues.iter().zip(&filtered) {
            let wanted = 1.0 / (1.0 / x + 1.0 / (ell * least));
            assert!((y / wanted - 1.0).abs() < 1e-15, "{x} {y} {wanted}");
            assert!(*y <= ell * least && y <= x, "{x} {y}");
        }
        assert!(filtered.is_sorted());
    }
    // Order and length are those given; zeros are not the smallest eigenvalue.
    let filtered = filter_eigenvalues(&[400.0, 0.0, 4.0], 100.0).unwrap();
    assert!(difference(&filtered, &[200.0, 0.0, 4.0 / 1.01]) < 1e-13, "{filtered:?}");
    assert_eq!(filter_eigenvalues(&[0.0, 0.0], 100.0).unwrap(), [0.0, 0.0]);
    assert!(filter_eigenvalues(&[], 100.0).unwrap().is_empty());
}

#[test]
fn the_filter_survives_the_ends_of_the_range() {
    let filtered = filter_eigenvalues(&[1e-310, 1.0, 1e308], 100.0).unwrap();
    assert!(difference(&filtered, &[1e-310, 1e-308, 1e-308]) < 1e-309, "{filtered:?}");
    // ell lambda_min overflows: nothing is moderated.
    assert_eq!(filter_eigenvalues(&[1e307, 1e308], 100.0).unwrap(), [1e307, 1e308]);
}

#[test]
fn what_is_refused() {
    for value in [f64::INFINITY, f64::NEG_INFINITY, -1.0, -1e-300] {
        let eigenvalues = [1.0, value, f64::NAN];
        let wanted = ModesError::Eigenvalue { index: 1, value };
        assert_eq!(filter_eigenvalues(&eigenvalues, DEFAULT_ELL), Err(wanted.clone()));
        assert_eq!(energy_metric(&eigenvalues), Err(wanted));
    }
    let nan = filter_eigenvalues(&[f64::NAN], DEFAULT_ELL).unwrap_err();
    assert!(matches!(nan, ModesError::Eigenvalue { index: 0, value } if value.is_nan()));
    assert!(matches!(energy_metric(&[f64::NAN]), Err(ModesError::Eigenvalue { index: 0, .. })));
    for value in [0.0, -0.0, -100.0, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(filter_eigenvalues(&[1.0], value), Err(ModesError::Ell { value }));
    }
    assert!(matches!(filter_eigenvalues(&[1.0], f64::NAN), Err(ModesError::Ell { .. })));
    assert_eq!(energy_metric(&[]), Err(ModesError::Core(sscc::Error::RankZero)));
    let vanishing = energy_metric(&[f64::from_bits(1)]).unwrap_err();
    assert!(matches!(vanishing, ModesError::Core(sscc::Error::MetricWeight { .. })), "{vanishing}");
}
