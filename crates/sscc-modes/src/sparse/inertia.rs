//! Count of the negative eigenvalues of an indefinite matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{IntranodeLbltRef, SymbolicCholeskyRaw};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side};

use super::BlockSparse;
use super::factor::{Analysis, threads};
use crate::ModesError;

/// Minimum pivot of certain sign, relative to the largest entry.
const MIN_PIVOT: f64 = 1e-14;

/// Maximum backward error of the factor, relative to the largest row sum. Pivots are chosen only within a supernode, so
/// larger errors are possible; 1e-16 is usual.
const MAX_BACKWARD_ERROR: f64 = 1e-13;

/// Returns the number of negative eigenvalues, which equals the number of negative pivots (Sylvester's law of inertia).
/// The pivots have one or two rows (Bunch and Kaufman 1977), within each supernode. None if the result is uncertain by
/// rounding, because the matrix is nearly singular or the pivots are small: try another shift.
///
/// # Errors
/// When memory is short.
pub(crate) fn count_negative_eigenvalues(
    matrix: &BlockSparse,
    analysis: &Analysis,
) -> Result<Option<usize>, ModesError> {
    let symbolic = analysis.symbolic();
    let SymbolicCholeskyRaw::Supernodal(nodes) = symbolic.raw() else { return Ok(None) };
    let (starts, rows, entries) = matrix.lower();
    let size = 3 * matrix.rows();
    let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
    let mut values = analysis.allocate()?;
    let mut below = vec![0.0; size];
    let (mut forward, mut inverse) = (vec![0; size], vec![0; size]);
    let scratch = symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(threads(), Default::default());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?;
    symbolic.factorize_numeric_intranode_lblt(
        &mut values,
        &mut below,
        &mut forward,
        &mut inverse,
        SparseColMatRef::new(pattern, &entries),
        Side::Lower,
        threads(),
        MemStack::new(&mut memory),
        Default::default(),
    );
    drop(memory);
    let threshold = MIN_PIVOT * entries.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut negative = 0;
    for node in 0..nodes.n_supernodes() {
        let (first, end) = (nodes.supernode_begin()[node], nodes.supernode_end()[node]);
        let at = nodes.col_ptr_for_val()[node];
        let height = (nodes.col_ptr_for_val()[node + 1] - at) / (end - first);
        let diagonal: Vec<f64> = (0..end - first).map(|k| values[at + k * height + k]).collect();
        match negative_pivots(&diagonal, &below[first..end], threshold) {
            Some(count) => negative += count,
            None => return Ok(None),
        }
    }
    let factor =
        IntranodeLbltRef::new(symbolic, &values, &below, PermRef::new_checked(&forward, &inverse, size));
    let mut solution = Mat::from_fn(size, 1, |i, _| if i * i % 7 < 3 { 1.0 } else { -1.0 });
    let wanted = solution.clone();
    let scratch = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?;
    factor.solve_in_place_with_conj(Conj::No, solution.as_mut(), Par::Seq, MemStack::new(&mut memory));
    let residual = (matrix.multiply(solution.as_ref()) - wanted).norm_max();
    let is_accurate = residual <= MAX_BACKWARD_ERROR * largest_row_sum(matrix) * solution.norm_max();
    Ok(is_accurate.then_some(negative))
}

/// Counts negative pivots, of one row, or of two rows where `below` the diagonal is not 0. None if a pivot is tiny or not
/// finite.
fn negative_pivots(diagonal: &[f64], below: &[f64], threshold: f64) -> Option<usize> {
    let (mut negative, mut k) = (0, 0);
    while k < diagonal.len() {
        if below[k] == 0.0 {
            let is_certain = diagonal[k].abs() > threshold && diagonal[k].is_finite();
            negative += usize::from(is_certain.then_some(diagonal[k])? < 0.0);
            k += 1;
        } else {
            let (a, b, c) = (diagonal[k], below[k], *diagonal.get(k + 1)?);
            let determinant = a * c - b * b;
            let scale = a.abs().max(b.abs()).max(c.abs());
            let is_certain = determinant.abs() > threshold * scale && determinant.is_finite();
            negative += match is_certain.then_some(determinant)? < 0.0 {
                true => 1,
                false => 2 * usize::from(a < 0.0),
            };
            k += 2;
        }
    }
    Some(negative)
}

/// Returns an upper bound of the largest eigenvalue.
fn largest_row_sum(matrix: &BlockSparse) -> f64 {
    let sum = |(row, axis): (usize, usize)| -> f64 {
        matrix.blocks(row).iter().flat_map(|b| &b[3 * axis..3 * axis + 3]).map(|x| x.abs()).sum()
    };
    (0..matrix.rows()).flat_map(|row| [(row, 0), (row, 1), (row, 2)]).map(sum).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::{Lattice, dense, random_blocks};
    use crate::eigen::tests::dense_eigenvalues;

    #[test]
    fn random_indefinite_matrices_have_the_inertia_of_the_dense_ones() {
        let body = Lattice::free(6, 5, 4);
        let analysis = Analysis::new(&body.stiffness, &body.positions).unwrap();
        let mut counted = 0;
        for seed in 0..40 {
            // The first diagonals are 0 and need pivots of two rows; later ones grow, with both signs.
            let matrix = random_blocks(&body.stiffness, seed, 0.25 * (seed / 8) as f64);
            let values = dense(&matrix).self_adjoint_eigenvalues(Side::Lower).unwrap();
            let wanted = values.iter().filter(|x| **x < 0.0).count();
            if let Some(found) = count_negative_eigenvalues(&matrix, &analysis).unwrap() {
                assert_eq!(found, wanted, "seed {seed}");
                counted += 1;
            }
        }
        assert!(counted >= 36, "{counted} of 40 were counted");
    }

    #[test]
    fn shifts_close_to_eigenvalues_are_counted() {
        for body in [Lattice::free(4, 4, 4), Lattice::clamped(5, 4, 4)] {
            let analysis = Analysis::new(&body.stiffness, &body.positions).unwrap();
            let values = dense_eigenvalues(&body);
            let below = |sigma: f64| values.iter().filter(|x| **x < sigma).count();
            for index in [7, 20, 21, 50, 100, 150] {
                for share in [1e-2, 1e-4, 1e-6, 1e-8, -1e-8, -1e-6, -1e-4, -1e-2] {
                    let sigma = values[index] * (1.0 + share);
                    let matrix = body.stiffness.combined(1.0, &body.mass, -sigma);
                    let found = count_negative_eigenvalues(&matrix, &analysis).unwrap();
                    assert_eq!(found, Some(below(sigma)), "eigenvalue {index}, share {share:e}");
                }
            }
        }
    }

    #[test]
    fn singular_matrices_and_bad_numbers_are_not_counted() {
        let body = Lattice::free(4, 4, 4);
        let analysis = Analysis::new(&body.stiffness, &body.positions).unwrap();
        assert_eq!(count_negative_eigenvalues(&body.stiffness, &analysis).unwrap(), None);
        let zero = body.stiffness.combined(0.0, &body.mass, 0.0);
        assert_eq!(count_negative_eigenvalues(&zero, &analysis).unwrap(), None);
        let bad = body.stiffness.combined(f64::NAN, &body.mass, 1.0);
        assert_eq!(count_negative_eigenvalues(&bad, &analysis).unwrap(), None);
        let zero = body.stiffness.combined(0.0, &body.mass, 1.0);
        assert_eq!(count_negative_eigenvalues(&zero, &analysis).unwrap(), Some(0));
        let negative = body.stiffness.combined(0.0, &body.mass, -1.0);
        assert_eq!(count_negative_eigenvalues(&negative, &analysis).unwrap(), Some(192));
    }

    #[test]
    fn pivots_are_counted_by_sign() {
        assert_eq!(negative_pivots(&[1.0, -2.0, 3.0], &[0.0; 3], 1e-9), Some(1));
        assert_eq!(negative_pivots(&[0.0, 0.0, -3.0], &[1.0, 0.0, 0.0], 1e-9), Some(2));
        assert_eq!(negative_pivots(&[-2.0, -2.0], &[1.0, 0.0], 1e-9), Some(2));
        assert_eq!(negative_pivots(&[2.0, 2.0], &[1.0, 0.0], 1e-9), Some(0));
        assert_eq!(negative_pivots(&[1.0, 1.0], &[1.0, 0.0], 1e-9), None);
        assert_eq!(negative_pivots(&[f64::NAN], &[0.0], 1e-9), None);
        assert_eq!(negative_pivots(&[f64::INFINITY], &[0.0], 1e-9), None);
        assert_eq!(negative_pivots(&[1e-10], &[0.0], 1e-9), None);
    }
}
