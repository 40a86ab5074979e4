//! Diagonalization is accurate and complete, and preserves shapes.

use crate::common::{Random, bumpy};
use crate::matrix::{
    diagonal, difference, numbers, product, random_modes, stiffness, times, transpose, with_spectrum,
};
use sscc::{Metric, Modes, ReducedModel};
use sscc_modes::{DiagonalModes, diagonalize, stiffness_eigenvalues};

/// Diagonalizes modes and checks the properties of every stiffness with these eigenvalues.
fn check(name: &str, modes: &Modes, entries: &[f64], spectrum: &[f64]) -> DiagonalModes {
    let n = modes.rank();
    let stiffness = stiffness(n, entries);
    let found = diagonalize(modes, &stiffness).unwrap_or_else(|e| panic!("{name}: {e}"));
    let (q, qt) = (&found.rotation, transpose(n, &found.rotation));
    let largest = spectrum.iter().fold(0.0_f64, |m, x| m.max(*x));
    let tolerance = 1e-12 * largest;

    // Comparing whole lists detects missing and repeated eigenvalues.
    let mut spectrum = spectrum.to_vec();
    spectrum.sort_by(f64::total_cmp);
    assert!(found.eigenvalues.is_sorted(), "{name}");
    assert!(found.eigenvalues.iter().all(|x| *x >= 0.0), "{name}");
    assert!(difference(&found.eigenvalues, &spectrum) <= tolerance, "{name}");
    let alone = stiffness_eigenvalues(&stiffness).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(alone.is_sorted() && difference(&alone, &spectrum) <= tolerance, "{name}");

    let identity = diagonal(&vec![1.0; n]);
    assert!(difference(&product(n, &qt, q), &identity) < 1e-12, "{name}: orthogonal");
    let reduced = product(n, &qt, &product(n, entries, q));
    assert!(difference(&reduced, &diagonal(&found.eigenvalues)) <= tolerance, "{name}: diagonal");
    let residual = difference(&product(n, entries, q), &product(n, q, &diagonal(&found.eigenvalues)));
    assert!(residual <= tolerance, "{name}: residual {residual:e}");

    // U' Q' = U, so all shapes remain.
    for v in 0..modes.vertices() as u32 {
        for (j, wanted) in modes.of_vertex(v).iter().enumerate() {
            let row = &q[j * n..][..n];
            let back = found.modes.of_vertex(v).iter().zip(row).map(|(u, x)| *u * *x).sum::<glam::DVec3>();
            assert!((back - *wanted).abs().max_element() < 1e-12, "{name}: vertex {v}, mode {j}");
        }
    }
    for k in 0..n {
        let column = || (0..n).map(|j| q[j * n + k]);
        let largest = column().fold(0.0_f64, |m, x| m.max(x.abs())) * (1.0 - 1e-8);
        assert!(column().find(|x| x.abs() >= largest).is_some_and(|x| x > 0.0), "{name}: sign of column {k}");
    }
    found
}

#[test]
fn spectra_of_many_kinds_and_ranks() {
    let mut random = Random(1);
    // faer uses divide and conquer from 128 rows on.
    for n in [1, 2, 3, 4, 5, 7, 16, 24, 33, 64, 127, 128, 129, 161] {
        let modes = random_modes(&mut random, 9, n);
        let spectra: [(&str, Vec<f64>); 7] = [
            ("steps", (0..n).map(|k| 1.0 + k as f64).collect()),
            ("all equal", vec![2.5; n]),
            ("fours", (0..n).map(|k| 1.0 + (k / 4) as f64).collect()),
            ("one apart", (0..n).map(|k| if k == 0 { 100.0 } else { 1.0 }).collect()),
            ("nearly equal", (0..n).map(|k| 1.0 + k as f64 * 3e-15).collect()),
            ("rigid motions", (0..n).map(|k| if k < n.min(7) - 1 { 0.0 } else { k as f64 }).collect()),
            ("random", (0..n).map(|_| random.number().abs()).collect()),
        ];
        for (name, spectrum) in spectra {
            let name = format!("{name}, rank {n}");
            let dense = with_spectrum(&mut random, &spectrum);
            let found = check(&name, &modes, &dense, &spectrum);
            let zeros = spectrum.iter().filter(|x| **x == 0.0).count();
            assert_eq!(found.eigenvalues.iter().filter(|x| **x == 0.0).count(), zeros, "{name}");
            check(&name, &modes, &diagonal(&spectrum), &spectrum);
        }
    }
}

#[test]
fn chains_and_grids_with_exact_entries() {
    // A free grid of m x m unit springs has many double eigenvalues and one that is 0.
    let m = 12;
    let chain = |i: usize, j: usize| match i.abs_diff(j) {
        0 => f64::from(u8::from(i > 0) + u8::from(i + 1 < m)),
        1 => -1.0,
        _ => 0.0,
    };
    let equal = |i: usize, j: usize| f64::from(u8::from(i == j));
    let n = m * m;
    let grid: Vec<f64> = (0..n * n)
        .map(|at| [at / n / m, at / n % m, at % n / m, at % n % m])
        .map(|[a, b, c, d]| chain(a, c) * equal(b, d) + equal(a, c) * chain(b, d))
        .collect();
    let wave = |k: usize| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / m as f64).cos();
    let spectrum: Vec<f64> = (0..n).map(|k| wave(k / m) + wave(k % m)).collect();
    let found = check("grid", &random_modes(&mut Random(2), 3, n), &grid, &spectrum);
    assert_eq!(found.eigenvalues[0], 0.0);
    assert!(found.eigenvalues[1] > 0.0);
}

#[test]
fn rank_60_of_condition_1e10() {
    let mut random = Random(3);
    let spectrum: Vec<f64> = (0..60).map(|k| 1e-10_f64.powf(f64::from(k) / 59.0)).collect();
    let modes = random_modes(&mut random, 40, 60);
    let found = check("1e10", &modes, &with_spectrum(&mut random, &spectrum), &spectrum);
    assert!((found.eigenvalues[0] / 1e-10 - 1.0).abs() < 1e-4, "{:e}", found.eigenvalues[0]);
}

#[test]
fn rank_1_and_diagonal_matrices_are_exact() {
    let mut random = Random(4);
    let modes = random_modes(&mut random, 5, 1);
    let found = diagonalize(&modes, &stiffness(1, &[7.3])).unwrap();
    assert_eq!(found, DiagonalModes { modes, eigenvalues: vec![7.3], rotation: vec![1.0] });

    let modes = random_modes(&mut random, 5, 3);
    let found = diagonalize(&modes, &stiffness(3, &diagonal(&[3.0, 7.0, 1.0]))).unwrap();
    assert_eq!(found.eigenvalues, [1.0, 3.0, 7.0]);
    assert_eq!(found.rotation, [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
    let zero = diagonalize(&modes, &stiffness(3, &[0.0; 9])).unwrap();
    assert_eq!((zero.eigenvalues, zero.rotation), (vec![0.0; 3], diagonal(&[1.0; 3])));
}

#[test]
fn results_scale_with_the_unit() {
    let mut random = Random(5);
    let modes = random_modes(&mut random, 5, 6);
    let entries = with_spectrum(&mut random, &[0.0, 1.0, 2.0, 2.0, 30.0, 400.0]);
    let found = diagonalize(&modes, &stiffness(6, &entries)).unwrap();
    for unit in [2.0_f64.powi(-900), 2.0_f64.powi(-300), 2.0_f64.powi(190)] {
        let scaled: Vec<f64> = entries.iter().map(|x| x * unit).collect();
        let other = diagonalize(&modes, &stiffness(6, &scaled)).unwrap();
        assert_eq!((&other.modes, &other.rotation), (&found.modes, &found.rotation), "{unit:e}");
        let eigenvalues: Vec<f64> = found.eigenvalues.iter().map(|x| x * unit).collect();
        assert_eq!(other.eigenvalues, eigenvalues, "{unit:e}");
    }
}

#[test]
fn results_are_reproducible() {
    let mut random = Random(6);
    for n in [5, 60, 140] {
        let modes = random_modes(&mut random, 5, n);
        let entries = with_spectrum(&mut random, &(0..n).map(|k| (k / 3) as f64).collect::<Vec<_>>());
        let stiffness = stiffness(n, &entries);
        let first = diagonalize(&modes, &stiffness).unwrap();
        std::thread::scope(|scope| {
            let others: Vec<_> =
                (0..4).map(|_| scope.spawn(|| diagonalize(&modes, &stiffness).unwrap())).collect();
            others.into_iter().for_each(|other| assert_eq!(other.join().unwrap(), first, "rank {n}"));
        });
    }
}

#[test]
fn the_first_of_equal_components_decides_the_sign() {
    let found =
        diagonalize(&random_modes(&mut Random(7), 2, 2), &stiffness(2, &[2.0, -1.0, -1.0, 2.0])).unwrap();
    let half = 0.5_f64.sqrt();
    assert!(difference(&found.rotation, &[half, half, half, -half]) < 1e-15, "{:?}", found.rotation);
}

#[test]
fn positions_are_preserved() {
    let mut random = Random(8);
    let mesh = bumpy(1);
    let modes = random_modes(&mut random, mesh.rest_positions().len(), 12);
    let entries = with_spectrum(&mut random, &[0.0, 0.0, 1.0, 1.0, 1.0, 5.0, 6.0, 7.0, 8.0, 9.0, 1e4, 1e6]);
    let found = diagonalize(&modes, &stiffness(12, &entries)).unwrap();
    let back = transpose(12, &found.rotation);
    let before = ReducedModel::new(mesh.clone(), modes).unwrap();
    let after = ReducedModel::with_metric(mesh, found.modes, Metric::identity(12)).unwrap();
    for _ in 0..20 {
        let q = numbers(&mut random, 12);
        let [x, y] = [before.positions(&q).unwrap(), after.positions(&times(&back, &q)).unwrap()];
        for (x, y) in x.into_iter().zip(y) {
            assert!((x - y).abs().max_element() < 1e-13, "{x} {y}");
        }
    }
}
