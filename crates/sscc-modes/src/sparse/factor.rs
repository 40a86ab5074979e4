//! Sparse Cholesky factors.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side};
use glam::DVec3;
use rayon::prelude::*;

use super::BlockSparse;
use super::dissection::nested_dissection;
use crate::ModesError;

/// Number of right-hand sides per task. The factor is read once per group: see `docs/notes/modes.md#lanczos`.
const COLUMNS_PER_TASK: usize = 8;

/// Symbolic factorization for all matrices of one pattern: the order of elimination and the entries of the factor.
#[derive(Clone)]
pub(crate) struct Analysis(Arc<SymbolicCholesky<usize>>);

/// Cholesky factor of a positive definite matrix.
pub(crate) struct Cholesky {
    analysis: Analysis,
    values: Vec<f64>,
}

impl Analysis {
    /// Analyses a pattern with nested dissection. `positions` has one vertex for each row of blocks.
    ///
    /// # Errors
    /// When memory is short.
    pub fn new(matrix: &BlockSparse, positions: &[DVec3]) -> Result<Self, ModesError> {
        Self::with_order(matrix, &nested_dissection(matrix, positions))
    }

    /// Analyses a pattern for a given order of vertices.
    pub fn with_order(matrix: &BlockSparse, vertices: &[usize]) -> Result<Self, ModesError> {
        let size = 3 * matrix.rows();
        let forward: Vec<usize> = vertices.iter().flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect();
        let mut inverse = vec![0; size];
        forward.iter().enumerate().for_each(|(at, row)| inverse[*row] = at);
        let (starts, rows, _) = matrix.lower();
        factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, size)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map(|symbolic| Self(Arc::new(symbolic)))
        .map_err(|_| ModesError::Memory)
    }

    /// Returns the number of entries of a factor.
    pub fn entries(&self) -> usize {
        self.0.len_val()
    }

    /// Returns the symbolic factorization of faer.
    pub(super) fn symbolic(&self) -> &SymbolicCholesky<usize> {
        &self.0
    }

    /// Allocates the entries of a factor.
    pub(super) fn allocate(&self) -> Result<Vec<f64>, ModesError> {
        let mut values = Vec::new();
        values.try_reserve_exact(self.entries()).map_err(|_| ModesError::Memory)?;
        values.resize(self.entries(), 0.0);
        Ok(values)
    }

    /// Factors a matrix of the pattern.
    ///
    /// # Errors
    /// When the matrix is not positive definite, or memory is short.
    pub fn factor(&self, matrix: &BlockSparse) -> Result<Cholesky, ModesError> {
        let (starts, rows, entries) = matrix.lower();
        let size = 3 * matrix.rows();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let mut values = self.allocate()?;
        let scratch = self.0.factorize_numeric_llt_scratch::<f64>(threads(), Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?;
        self.0
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(pattern, &entries),
                Side::Lower,
                Default::default(),
                threads(),
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| {
                let row = self.0.perm().map_or(index, |perm| perm.arrays().0[index]);
                ModesError::NotDefinite { vertex: row / 3 }
            })?;
        Ok(Cholesky { analysis: self.clone(), values })
    }
}

impl Cholesky {
    /// Replaces all columns by their solutions.
    ///
    /// # Errors
    /// When memory is short.
    pub fn solve(&self, x: &mut Mat<f64>) -> Result<(), ModesError> {
        let symbolic = self.analysis.symbolic();
        let factor = LltRef::new(symbolic, &self.values);
        // Each column gives the same result on any thread.
        x.par_col_chunks_mut(COLUMNS_PER_TASK).try_for_each(|group| {
            let scratch = symbolic.solve_in_place_scratch::<f64>(group.ncols(), Par::Seq);
            let mut memory = MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?;
            factor.solve_in_place_with_conj(Conj::No, group, Par::Seq, MemStack::new(&mut memory));
            Ok(())
        })
    }
}

/// Returns the parallelism of factorizations.
pub(super) fn threads() -> Par {
    Par::rayon(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::{Lattice, dense, random_matrix};

    #[test]
    fn solutions_match_the_dense_matrix() {
        for body in [Lattice::clamped(6, 5, 4), Lattice::free(5, 5, 5)] {
            let matrix = body.stiffness.combined(1.0, &body.mass, 0.01);
            let factor = Analysis::new(&matrix, &body.positions).unwrap().factor(&matrix).unwrap();
            for columns in [0, 1, 11] {
                let wanted = random_matrix(3 * matrix.rows(), columns);
                let mut x = dense(&matrix) * &wanted;
                factor.solve(&mut x).unwrap();
                assert!((x - wanted).norm_max() < 1e-9);
            }
        }
    }

    #[test]
    fn an_indefinite_matrix_is_rejected_with_a_vertex() {
        let body = Lattice::clamped(6, 5, 4);
        let mut matrix = body.stiffness.clone();
        matrix.add(17, 17, &[-100.0, 0.0, 0.0, 0.0, -100.0, 0.0, 0.0, 0.0, -100.0]);
        let found = Analysis::new(&matrix, &body.positions).unwrap().factor(&matrix).err();
        assert_eq!(found, Some(ModesError::NotDefinite { vertex: 17 }));
    }

    /// faer does not guarantee this; the documentation of the crate relies on it.
    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let body = Lattice::clamped(12, 12, 12);
        let matrix = body.stiffness.combined(1.0, &body.mass, 0.01);
        let values = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Analysis::new(&matrix, &body.positions).unwrap().factor(&matrix).unwrap().values)
        };
        let one = values(1);
        for threads in [2, 3, 8] {
            assert!(one == values(threads), "{threads} threads");
        }
    }
}
