//! The energy metric measures strain energy, and the filter is the paper's formula.

use crate::common::{Random, bumpy};
use crate::matrix::{difference, dot, numbers, random_modes, stiffness, times, transpose, with_spectrum};
use glam::DVec3;
use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};
use sscc_modes::{
    DEFAULT_ELL, ModesError, diagonalize, energy_metric, filter_eigenvalues, polynomial_modes,
    reduced_stiffness,
};

#[test]
fn the_squared_length_is_the_strain_energy() {
    let mut random = Random(1);
    for n in [1, 2, 10, 60] {
        let spectrum: Vec<f64> = (0..n).map(|k| 1.0 + (k * k) as f64).collect();
        let entries = with_spectrum(&mut random, &spectrum);
        let found = diagonalize(&random_modes(&mut random, 3, n), &stiffness(n, &entries)).unwrap();
        let metric = energy_metric(&found.eigenvalues).unwrap();
        for _ in 0..20 {
            let q = numbers(&mut random, n);
            let energy = 0.5 * dot(&q, &times(&entries, &q));
            let length = metric.norm(&times(&transpose(n, &found.rotation), &q)).unwrap();
            assert!((length * length / energy - 1.0).abs() < 1e-11, "{n}: {length} {energy}");
        }
    }
}

#[test]
fn modes_without_energy_get_the_smallest_weight() {
    let scales = |eigenvalues: &[f64]| energy_metric(eigenvalues).unwrap().scales().to_vec();
    assert_eq!(scales(&[0.0, 0.0, 8.0, 18.0]), [2.0, 2.0, 2.0, 3.0]);
    assert_eq!(scales(&[0.0, 0.0]), [1.0, 1.0]);
    assert_eq!(scales(&[2.0, -0.0]), [1.0, 1.0]);
}

#[test]
fn the_filter_matches_the_formula() {
    let mut random = Random(2);
    for ell in [0.5, 1.0, 3.0, DEFAULT_ELL, 1e6] {
        let mut eigenvalues: Vec<f64> = (0..200).map(|_| 10_f64.powf(6.0 * random.number())).collect();
        eigenvalues.sort_by(f64::total_cmp);
        let smallest = eigenvalues[0];
        let filtered = filter_eigenvalues(&eigenvalues, ell).unwrap();
        for (x, y) in eigenvalues.iter().zip(&filtered) {
            let wanted = 1.0 / (1.0 / x + 1.0 / (ell * smallest));
            assert!((y / wanted - 1.0).abs() < 1e-15, "{x} {y} {wanted}");
            assert!(*y <= ell * smallest && y <= x, "{x} {y}");
        }
        assert!(filtered.is_sorted());
    }
    // Order and length are unchanged; zeros do not count as the smallest eigenvalue.
    let filtered = filter_eigenvalues(&[400.0, 0.0, 4.0], 100.0).unwrap();
    assert!(difference(&filtered, &[200.0, 0.0, 4.0 / 1.01]) < 1e-13, "{filtered:?}");
    assert_eq!(filter_eigenvalues(&[0.0, 0.0], 100.0).unwrap(), [0.0, 0.0]);
    assert!(filter_eigenvalues(&[], 100.0).unwrap().is_empty());
}

#[test]
fn the_filter_does_not_overflow() {
    let filtered = filter_eigenvalues(&[1e-310, 1.0, 1e308], 100.0).unwrap();
    assert!(difference(&filtered, &[1e-310, 1e-308, 1e-308]) < 1e-309, "{filtered:?}");
    // ell lambda_min overflows, so no weight is limited.
    assert_eq!(filter_eigenvalues(&[1e307, 1e308], 100.0).unwrap(), [1e307, 1e308]);
}

#[test]
fn invalid_eigenvalues_are_rejected() {
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

/// Computes `K u` of unit springs along the edges of a surface, one for each triangle at an edge.
fn springs(mesh: &TriMesh, u: &[f64], force: &mut [f64]) {
    force.fill(0.0);
    let p = mesh.rest_positions();
    for face in mesh.faces() {
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (face[i] as usize, face[j] as usize)) {
            let along = (p[b] - p[a]).normalize();
            let stretch = along.dot(DVec3::from_slice(&u[3 * b..]) - DVec3::from_slice(&u[3 * a..]));
            for i in 0..3 {
                force[3 * a + i] -= stretch * along[i];
                force[3 * b + i] += stretch * along[i];
            }
        }
    }
}

#[test]
fn a_free_body_from_stiffness_to_queries() {
    // The 6 rigid motions, and the 24 polynomial modes mixed with them.
    let mesh = bumpy(3);
    let polynomial = polynomial_modes(&mesh).unwrap();
    let mut random = Random(3);
    let mixing: Vec<[f64; 6]> = (0..24).map(|_| std::array::from_fn(|_| random.number())).collect();
    let mut displacements = Vec::new();
    for (v, p) in mesh.rest_positions().iter().enumerate() {
        let mut rigid = DVec3::AXES.to_vec();
        rigid.extend(DVec3::AXES.map(|axis| axis.cross(*p)));
        displacements.extend_from_slice(&rigid);
        for (u, shares) in polynomial.of_vertex(v as u32).iter().zip(&mixing) {
            displacements.push(*u - rigid.iter().zip(shares).map(|(r, x)| *r * *x).sum::<DVec3>());
        }
    }
    let modes = Modes::new(30, displacements).unwrap();
    let stiffness = reduced_stiffness(&modes, |u, force| springs(&mesh, u, force)).unwrap();
    let found = diagonalize(&modes, &stiffness).unwrap();
    assert_eq!(found.eigenvalues.iter().filter(|x| **x == 0.0).count(), 6, "{:?}", found.eigenvalues);

    let weights = filter_eigenvalues(&found.eigenvalues, DEFAULT_ELL).unwrap();
    let metric = energy_metric(&weights).unwrap();
    assert!(metric.scales().iter().all(|s| *s >= metric.scales()[0]));
    let model = ReducedModel::with_metric(mesh, found.modes, metric).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default().epsilon(0.5), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    // One comparison certifies a rigid motion within the root's radius.
    let mut q = vec![0.0; 30];
    q[0] = 1e-6;
    assert!(query.discrete(&q).unwrap().is_empty());
    assert!(query.statistics().root_certified);
}
