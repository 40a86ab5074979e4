//! The lowest modes of boxes, against dense solvers.

use std::sync::atomic::{AtomicUsize, Ordering};

use faer::{Mat, Side};
use sscc::{CancelToken, Error};

use super::lanczos::{RitzPairs, ShiftInvert, largest};
use super::lattice::{Lattice, dense};
use super::space::Space;
use super::tall_matrix::Random;
use super::{LowestModes, lowest_modes};
use crate::ModesError;
use crate::sparse::Analysis;

/// Returns all eigenvalues, rigid motions included, ascending, from a solver that shares no code with the crate.
pub(crate) fn dense_eigenvalues(body: &Lattice) -> Vec<f64> {
    let lower = dense(&body.mass).llt(Side::Lower).unwrap();
    let inverse = lower.L().to_owned().partial_piv_lu();
    use faer::linalg::solvers::Solve;
    let half = inverse.solve(dense(&body.stiffness));
    let whole = inverse.solve(half.transpose());
    whole.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

fn lowest(body: &Lattice, count: usize) -> Result<LowestModes, ModesError> {
    lowest_modes(&body.stiffness, &body.mass, &body.positions, body.rigid.as_ref(), count, &())
}

/// Compares eigenvalues with those of the dense solver.
fn check(body: &Lattice, count: usize) {
    let found = lowest(body, count).unwrap();
    let rigid = body.rigid.ncols();
    let wanted = dense_eigenvalues(body);
    assert!(wanted[..rigid].iter().all(|x| x.abs() < 1e-12));
    assert_eq!(found.eigenvalues.len(), count);
    // Both solvers round the largest eigenvalue.
    let rounding = 3e-15 * wanted[wanted.len() - 1];
    for (k, (x, y)) in found.eigenvalues.iter().zip(&wanted[rigid..]).enumerate() {
        assert!((x - y).abs() < 1e-10 * y + rounding, "eigenvalue {k}: {x} {y}");
    }
    check_vectors(body, &found, count);
}

/// Checks residuals, products and signs of the vectors.
fn check_vectors(body: &Lattice, found: &LowestModes, count: usize) {
    let rigid = body.rigid.ncols();
    let x = &found.vectors;
    assert_eq!((x.nrows(), x.ncols()), (3 * body.positions.len(), count));
    let m_x = body.mass.multiply(x.as_ref());
    let products = x.transpose() * &m_x;
    assert!((products - Mat::<f64>::identity(count, count)).norm_max() < 1e-12);
    assert!((body.rigid.transpose() * &m_x).norm_max() < 1e-12);
    let force = body.stiffness.multiply(x.as_ref());
    for k in 0..count {
        let residual = force.col(k) - faer::Scale(found.eigenvalues[k]) * m_x.col(k);
        // The absolute term is rounding of the largest eigenvalue, which is about 10.
        assert!(residual.norm_l2() < 1e-8 * force.col(k).norm_l2() + 1e-13, "{k}: {}", residual.norm_l2());
        let largest = x.col(k).norm_max();
        let first = x.col(k).iter().find(|x| x.abs() >= (1.0 - 1e-8) * largest).unwrap();
        assert!(*first > 0.0);
    }
    assert_eq!(found.shift == 0.0, rigid == 0);
    assert!(found.shift >= 0.0 && found.shift < found.eigenvalues[0]);
    let mut back = &force + faer::Scale(found.shift) * &m_x;
    found.factor.solve(&mut back).unwrap();
    assert!((back - x).norm_max() < 1e-6);
}

#[test]
fn free_cubes_with_repeated_eigenvalues() {
    for nodes in [3, 4, 5, 6, 8] {
        check(&Lattice::free(nodes, nodes, nodes), 60);
    }
}

#[test]
fn free_boxes_and_bars() {
    check(&Lattice::free(7, 5, 4), 60);
    check(&Lattice::free(3, 3, 40), 60);
    check(&Lattice::free(9, 9, 2), 20);
}

#[test]
fn clamped_bodies() {
    for (x, y, z) in [(4, 4, 4), (6, 5, 5), (12, 4, 4), (40, 3, 3), (2, 9, 9)] {
        check(&Lattice::clamped(x, y, z), 60);
    }
}

#[test]
fn few_and_all_modes() {
    let cube = Lattice::free(6, 6, 6);
    for count in [0, 1, 2, 7] {
        if count > 0 {
            check(&cube, count);
        }
        assert_eq!(lowest(&cube, count).unwrap().eigenvalues.len(), count);
    }
    check(&cube, 300);
    let small = Lattice::free(3, 3, 3);
    check(&small, 75);
    let error = lowest(&small, 76).err();
    assert_eq!(error, Some(ModesError::TooManyModes { requested: 76, available: 75 }));
    check(&Lattice::clamped(2, 2, 2), 12);
}

/// A wire of 2 x 2 x 400 nodes: its lowest eigenvalue is far below the first shift.
#[test]
fn slender_bodies() {
    let wire = Lattice::free(2, 2, 400);
    let found = lowest(&wire, 12).unwrap();
    let mean = wire.stiffness.trace() / wire.mass.trace();
    assert!(found.eigenvalues[0] < 1e-8 * mean && found.shift < found.eigenvalues[0]);
    check_vectors(&wire, &found, 12);
    // Bending modes come in pairs. Eigenvalues of a slender beam are (4.7300, 7.8532, 10.9956) to the fourth power.
    for k in 0..3 {
        let ratio = found.eigenvalues[2 * k + 1] / found.eigenvalues[0];
        let beam = ([7.8532, 7.8532, 10.9956][k] / 4.7300_f64).powi(4);
        assert!(k == 0 || (ratio / beam - 1.0).abs() < 1e-2, "{k}: {ratio} {beam}");
        assert!((found.eigenvalues[2 * k + 1] / found.eigenvalues[2 * k] - 1.0).abs() < 1e-5);
    }
}

#[test]
fn mechanisms_are_counted() {
    // Two cubes share an edge, a vertex or nothing. The larger scale uses the iteration.
    let cases = [([1, 0, 1], 7), ([1, 1, 1], 9), ([2, 1, 1], 12)];
    for scale in [1, 3] {
        for (apart, wanted) in cases {
            let nodes = [0, 1, 2].map(|k| scale * (1 + apart[k]) + 1);
            let present = |p: [usize; 3]| {
                let low = (0..3).all(|k| p[k] < scale);
                low || (0..3).all(|k| p[k] >= scale * apart[k] && p[k] < scale * (apart[k] + 1))
            };
            let body = Lattice::new(nodes, |_| false, present);
            let error = lowest(&body, 6).err();
            let mechanism = ModesError::Mechanism { found: wanted, expected: 6 };
            assert_eq!(error, Some(mechanism), "{apart:?}, scale {scale}");
        }
    }
    // A cube fixed along an edge rotates about the edge, and one fixed at a vertex rotates about the vertex. In the last case,
    // only one of two parts is fixed.
    for nodes in [3, 6] {
        let hinged = Lattice::new([nodes; 3], |p| p[0] == 0 && p[1] == 0, |_| true);
        assert_eq!(lowest(&hinged, 6).err(), Some(ModesError::Mechanism { found: 1, expected: 0 }));
        let hung = Lattice::new([nodes; 3], |p| p == [0, 0, 0], |_| true);
        assert_eq!(lowest(&hung, 6).err(), Some(ModesError::Mechanism { found: 3, expected: 0 }));
        let flying = Lattice::new([2 * nodes + 1, nodes, nodes], |p| p[0] == 0, |p| p[0] != nodes);
        assert_eq!(lowest(&flying, 6).err(), Some(ModesError::Mechanism { found: 6, expected: 0 }));
    }
}

#[test]
fn the_iteration_can_be_cancelled() {
    let body = Lattice::free(7, 7, 7);
    for after in [0, 1, 2, 4] {
        let left = AtomicUsize::new(after);
        let is_over =
            move || left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err();
        let cancel = CancelToken::when(is_over);
        let found =
            lowest_modes(&body.stiffness, &body.mass, &body.positions, body.rigid.as_ref(), 60, &cancel);
        assert_eq!(found.err(), Some(ModesError::Core(Error::Cancelled)));
    }
}

/// A search that starts from an incomplete set of vectors finds the missing ones.
#[test]
fn missed_modes_are_found_beside_known_ones() {
    let body = Lattice::free(7, 7, 7);
    let wanted = lowest(&body, 68).unwrap();
    let space = Space::new(&body.mass, body.rigid.as_ref());
    let analysis = Analysis::new(&body.stiffness, &body.positions).unwrap();
    let factor = analysis.factor(&body.stiffness.combined(1.0, &body.mass, wanted.shift)).unwrap();
    let operator = ShiftInvert { space: &space, factor: &factor, ceiling: f64::INFINITY };
    let known: Vec<usize> = (0..68).filter(|k| ![0, 5, 30, 31, 59].contains(k)).collect();
    let known = RitzPairs {
        values: known.iter().map(|k| 1.0 / (wanted.eigenvalues[*k] + wanted.shift)).collect(),
        vectors: Mat::from_fn(space.size(), known.len(), |i, j| wanted.vectors[(i, known[j])]),
    };
    let found = largest(&operator, known, 68, &mut Random(9), &(), 60).unwrap();
    for (theta, value) in found.values.iter().zip(&wanted.eigenvalues) {
        assert!((1.0 / theta - wanted.shift - value).abs() < 1e-9 * value);
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let body = Lattice::free(8, 8, 8);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| lowest(&body, 40).unwrap());
        (found.eigenvalues, found.vectors)
    };
    let one = run(1);
    for threads in [2, 5] {
        let other = run(threads);
        assert!(one.0 == other.0 && (0..40).all(|k| one.1.col(k) == other.1.col(k)), "{threads} threads");
    }
}
