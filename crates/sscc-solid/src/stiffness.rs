//! Reduced stiffness matrix.

use sscc::limits;

use crate::SolidError;

/// Maximum difference of mirrored entries of a symmetric matrix, relative to the largest entry. Sums over millions of
/// vertices, in any order, have differences of about 1e-11; mistakes have far larger ones.
const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// Maximum off-diagonal entry of a diagonal matrix, relative to the largest entry; larger ones are not rounding.
const DIAGONAL_TOLERANCE: f64 = 1e-12;

/// The reduced stiffness `K~ = U'KU` of modes U (r x r): symmetric up to rounding, entries within [`sscc::limits`].
///
/// For mass-orthonormal modes, its eigenvalues are squared natural angular frequencies (1/s^2).
#[derive(Clone, Debug, PartialEq)]
pub struct Stiffness {
    rank: usize,
    entries: Vec<f64>,
}

impl Stiffness {
    /// Creates the stiffness of `rank` modes from its entries (r x r, row-major).
    ///
    /// # Errors
    /// When the rank is 0, the entries are not r x r, one is not finite or beyond 2^200, or mirrored ones differ by
    /// more than 1e-9 of the largest.
    pub fn new(rank: usize, entries: Vec<f64>) -> Result<Self, SolidError> {
        if rank == 0 {
            return Err(sscc::Error::RankZero.into());
        }
        if rank.checked_mul(rank) != Some(entries.len()) {
            return Err(SolidError::StiffnessLength { found: entries.len(), rank });
        }
        if let Some(at) = entries.iter().position(|x| x.is_nan() || x.abs() > limits::LARGEST) {
            return Err(SolidError::StiffnessEntry { row: at / rank, column: at % rank, value: entries[at] });
        }
        let stiffness = Self { rank, entries };
        let largest = stiffness.largest();
        for (row, column) in (0..rank).flat_map(|row| (0..row).map(move |column| (row, column))) {
            let [entry, mirrored] = [stiffness.at(row, column), stiffness.at(column, row)];
            if (entry - mirrored).abs() > SYMMETRY_TOLERANCE * largest {
                return Err(SolidError::StiffnessAsymmetric { row, column, entry, mirrored });
            }
        }
        Ok(stiffness)
    }

    /// Creates the diagonal stiffness of modes with these eigenvalues.
    ///
    /// # Errors
    /// When there is none, or one is not finite or beyond 2^200.
    pub fn from_diagonal(eigenvalues: &[f64]) -> Result<Self, SolidError> {
        let rank = eigenvalues.len();
        let mut entries = vec![0.0; rank * rank];
        eigenvalues.iter().enumerate().for_each(|(k, x)| entries[k * (rank + 1)] = *x);
        Self::new(rank, entries)
    }

    /// Returns the number of modes r.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Returns all entries (r x r, row-major).
    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// Returns the diagonal: the stiffness of each mode (r).
    pub fn diagonal(&self) -> impl ExactSizeIterator<Item = f64> {
        self.entries.iter().step_by(self.rank + 1).copied()
    }

    /// Whether the modes are uncoupled: off-diagonal entries are rounding.
    pub fn is_diagonal(&self) -> bool {
        let noise = DIAGONAL_TOLERANCE * self.largest();
        let is_off = |(at, x): (usize, &f64)| at % (self.rank + 1) != 0 && x.abs() > noise;
        !self.entries.iter().enumerate().any(is_off)
    }

    /// Returns the largest magnitude of an entry.
    pub fn largest(&self) -> f64 {
        self.entries.iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    /// Returns the mean of the matrix and its transpose (r x r, row-major), exactly symmetric.
    pub fn symmetrised(&self) -> Vec<f64> {
        let mut mean = self.entries.clone();
        for (row, column) in (0..self.rank).flat_map(|row| (0..row).map(move |column| (row, column))) {
            let x = (self.at(row, column) + self.at(column, row)) / 2.0;
            mean[row * self.rank + column] = x;
            mean[column * self.rank + row] = x;
        }
        mean
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.rank + column]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_matrices_are_rejected() {
        let rejected = |rank, entries: &[f64]| {
            let error = Stiffness::new(rank, entries.to_vec()).unwrap_err();
            assert!(!error.to_string().contains('\n'), "{error}");
            error
        };
        assert_eq!(rejected(0, &[]), SolidError::Core(sscc::Error::RankZero));
        for length in [0, 1, 2, 3, 5, 9] {
            let entries = vec![1.0; length];
            assert_eq!(rejected(2, &entries), SolidError::StiffnessLength { found: length, rank: 2 });
        }
        assert_eq!(rejected(usize::MAX, &[]), SolidError::StiffnessLength { found: 0, rank: usize::MAX });
        for value in [f64::INFINITY, f64::NEG_INFINITY, 1e61] {
            let entry = SolidError::StiffnessEntry { row: 0, column: 1, value };
            assert_eq!(rejected(2, &[1.0, value, 0.0, 1.0]), entry);
        }
        let nan = rejected(2, &[1.0, 0.0, f64::NAN, 1.0]);
        assert!(matches!(nan, SolidError::StiffnessEntry { row: 1, column: 0, value } if value.is_nan()));
        let (entry, mirrored) = (0.5 + 1e-8, 0.5);
        let asymmetric = SolidError::StiffnessAsymmetric { row: 1, column: 0, entry, mirrored };
        assert_eq!(rejected(2, &[1.0, mirrored, entry, 1.0]), asymmetric);
    }

    #[test]
    fn rounding_is_kept_in_entries_and_removed_in_the_mean() {
        let rounded = vec![2.0, 0.5, 0.5 + 1e-12, 3.0];
        let stiffness = Stiffness::new(2, rounded.clone()).unwrap();
        assert_eq!(stiffness.entries(), rounded);
        let mean = stiffness.symmetrised();
        assert_eq!((mean[1], mean[0], mean[3]), (mean[2], 2.0, 3.0));
        assert!(!stiffness.is_diagonal());
    }

    #[test]
    fn a_matrix_is_diagonal_up_to_rounding() {
        let diagonal = Stiffness::from_diagonal(&[1.0, 4.0]).unwrap();
        assert_eq!(diagonal.entries(), [1.0, 0.0, 0.0, 4.0]);
        assert!(diagonal.is_diagonal() && diagonal.diagonal().eq([1.0, 4.0]));
        assert!(Stiffness::new(2, vec![1.0, 4e-13, 4e-13, 4.0]).unwrap().is_diagonal());
        assert!(!Stiffness::new(2, vec![1.0, 5e-12, 5e-12, 4.0]).unwrap().is_diagonal());
    }
}
