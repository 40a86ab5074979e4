//! Cholesky factors, and the inertia of indefinite matrices.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side};
use glam::DVec3;

use super::BlockSparse;
use super::dissection::nested_dissection;
use crate::ModesError;

/// An order of elimination for all matrices of one pattern.
pub(crate) struct Symbolic(SymbolicCholesky<usize>);

/// The factor of a positive definite matrix.
pub(crate) struct Cholesky<'a> {
    symbolic: &'a Symbolic,
    values: Vec<f64>,
}

/// Threads for what faer does.
fn threads() -> Par {
    Par::rayon(0)
}

impl Symbolic {
    /// By nested dissection of the vertices' positions.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn new(matrix: &BlockSparse, positions: &[DVec3]) -> Result<Self, ModesError> {
        let size = 3 * matrix.rows();
        let order: Vec<usize> =
            nested_dissection(matrix, positions).into_iter().flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect();
        let mut inverse = vec![0; size];
        order.iter().enumerate().for_each(|(at, index)| inverse[*index] = at);
        let (starts, rows, _) = matrix.lower();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &inverse, size)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map(Self)
        .map_err(|_| ModesError::Memory)
    }

    /// The Cholesky factor; none where the matrix is not positive definite.
    pub fn factor(&self, matrix: &BlockSparse) -> Option<Cholesky<'_>> {
        let (starts, rows, entries) = matrix.lower();
        let size = 3 * matrix.rows();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let mut values = vec![0.0; self.0.len_val()];
        let scratch = self.0.factorize_numeric_llt_scratch::<f64>(threads(), Default::default());
        self.0
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(pattern, &entries),
                Side::Lower,
                Default::default(),
                threads(),
                MemStack::new(&mut MemBuffer::new(scratch)),
                Default::default(),
            )
            .ok()?;
        Some(Cholesky { symbolic: self, values })
    }

    /// How many eigenvalues of a symmetric matrix are negative (Sylvester's law of inertia), from a factor with
    /// pivots of one or two rows, chosen within each block column. None where a pivot is not a number: the matrix is
    /// singular; shift it a little.
    pub fn negative_eigenvalues(&self, matrix: &BlockSparse) -> Option<usize> {
        let (starts, rows, entries) = matrix.lower();
        let size = 3 * matrix.rows();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let mut values = vec![0.0; self.0.len_val()];
        let mut off_diagonal = vec![0.0; size];
        let (mut forward, mut backward) = (vec![0; size], vec![0; size]);
        let scratch = self.0.factorize_numeric_intranode_lblt_scratch::<f64>(threads(), Default::default());
        self.0.factorize_numeric_intranode_lblt(
            &mut values,
            &mut off_diagonal,
            &mut forward,
            &mut backward,
            SparseColMatRef::new(pattern, &entries),
            Side::Lower,
            threads(),
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        );
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.0.raw() else { return None };
        let mut negative = 0;
        for node in 0..symbolic.n_supernodes() {
            let (begin, end) = (symbolic.supernode_begin()[node], symbolic.supernode_end()[node]);
            let first = symbolic.col_ptr_for_val()[node];
            let columns = end - begin;
            let height = (symbolic.col_ptr_for_val()[node + 1] - first) / columns;
            let diagonal = |k: usize| values[first + k * height + k];
            let mut k = 0;
            while k < columns {
                let (a, b) = (diagonal(k), off_diagonal[begin + k]);
                if !a.is_finite() || !b.is_finite() || (b == 0.0 && a == 0.0) {
                    return None;
                }
                if b == 0.0 {
                    negative += usize::from(a < 0.0);
                    k += 1;
                    continue;
                }
                let c = diagonal(k + 1);
                negative += match a * c - b * b {
                    determinant if determinant < 0.0 => 1,
                    determinant if determinant > 0.0 => 2 * usize::from(a < 0.0),
                    _ => return None,
                };
                k += 2;
            }
        }
        Some(negative)
    }
}

impl Cholesky<'_> {
    /// Solves in place for all columns at once.
    pub fn solve(&self, right: &mut Mat<f64>) {
        let scratch = self.symbolic.0.solve_in_place_scratch::<f64>(right.ncols(), threads());
        LltRef::new(&self.symbolic.0, &self.values).solve_in_place_with_conj(
            Conj::No,
            right.as_mut(),
            threads(),
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}
