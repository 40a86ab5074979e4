//! Lowest eigenvectors of a sparse problem, with a check that none is missing.

use faer::{Mat, MatRef};
use glam::DVec3;
use sscc::Progress;

use super::count::{Count, count_below_gap};
use super::dense::all_modes;
use super::lanczos::{BLOCK, RitzPairs, ShiftInvert, largest};
use super::shift::{ShiftedFactor, factor_below, factor_shifted, negligible};
use super::space::Space;
use super::tall_matrix::Random;
use crate::ModesError;
use crate::cancel::check_cancelled;
use crate::sparse::{Analysis, BlockSparse, Cholesky, count_negative_eigenvalues};

/// Maximum number of rows for the dense solver.
const MAX_DENSE_ROWS: usize = 300;

/// Larger problems use the dense solver, too, if more than one in this number of eigenvectors is requested.
const DENSE_DIVISOR: usize = 4;

/// Maximum number of searches for missed eigenvectors, each from a new random block.
const MAX_RETRIES: usize = 2;

/// Relative difference up to which components count as equal, so that rounding does not decide the sign.
const TIE_TOLERANCE: f64 = 1e-8;

/// The lowest eigenvectors.
pub(crate) struct LowestModes {
    /// Eigenvalues, ascending.
    pub eigenvalues: Vec<f64>,
    /// M-orthonormal vectors, M-orthogonal to the rigid motions (3n x count).
    pub vectors: Mat<f64>,
    /// The factor of `K + shift M`.
    pub factor: Cholesky,
    /// The shift; 0 for a body without rigid motions.
    #[cfg_attr(not(test), expect(dead_code, reason = "used by tests"))]
    pub shift: f64,
}

/// Eigenproblem of a stiffness and a mass.
struct Pencil<'a> {
    stiffness: &'a BlockSparse,
    mass: &'a BlockSparse,
    rigid: MatRef<'a, f64>,
    analysis: Analysis,
}

/// Computes the `count` lowest eigenvectors of `K x = lambda M x` without rigid motions. `k` is positive semidefinite,
/// `m` positive definite, both with the same pattern. `positions` are the vertices (n), and `rigid` are M-orthonormal
/// motions without energy (3n x 0 to 6).
///
/// Small residuals do not prove that none is missing, so the inertia of `K - sigma M` counts the eigenvalues.
///
/// # Errors
/// When fewer exist, when other motions than `rigid` have no energy, when cancelled, when memory is short, or when the
/// iteration fails.
pub(crate) fn lowest_modes(
    k: &BlockSparse,
    m: &BlockSparse,
    positions: &[DVec3],
    rigid: MatRef<f64>,
    count: usize,
    progress: &dyn Progress,
) -> Result<LowestModes, ModesError> {
    let size = 3 * k.rows();
    let available = size - rigid.ncols();
    if count > available {
        return Err(ModesError::TooManyModes { requested: count, available });
    }
    check_cancelled(progress)?;
    progress.report(0, count);
    let pencil = Pencil { stiffness: k, mass: m, rigid, analysis: Analysis::new(k, positions)? };
    let small = size <= MAX_DENSE_ROWS || DENSE_DIVISOR * count > size;
    let (values, mut vectors, shifted) =
        if small { pencil.solve_dense()? } else { pencil.solve_lanczos(count, progress)? };
    vectors.resize_with(size, count, |_, _| 0.0);
    fix_signs(&mut vectors);
    progress.report(count, count);
    let ShiftedFactor { factor, shift } = shifted;
    Ok(LowestModes { eigenvalues: values[..count].to_vec(), vectors, factor, shift })
}

impl Pencil<'_> {
    /// Computes all eigenvectors with the dense solver.
    fn solve_dense(&self) -> Result<(Vec<f64>, Mat<f64>, ShiftedFactor), ModesError> {
        let (values, vectors) = all_modes(self.stiffness, self.mass, self.rigid)?;
        self.check_mechanisms(&values)?;
        let Some(lowest) = values.first() else { return Err(sscc::Error::RankZero.into()) };
        let shifted = factor_below(self.stiffness, self.mass, &self.analysis, self.rigid.ncols(), *lowest)?;
        Ok((values, vectors, shifted))
    }

    /// Factors the shifted stiffness.
    fn shifted(&self) -> Result<ShiftedFactor, ModesError> {
        let space = Space::new(self.mass, self.rigid);
        factor_shifted(self.stiffness, &space, &self.analysis, self.rigid.ncols(), &mut Random(0))
    }

    /// Computes at least the `count` lowest eigenvectors with the Lanczos iteration.
    fn solve_lanczos(
        &self,
        count: usize,
        progress: &dyn Progress,
    ) -> Result<(Vec<f64>, Mat<f64>, ShiftedFactor), ModesError> {
        let space = Space::new(self.mass, self.rigid);
        let shifted = self.shifted()?;
        let zero = negligible(self.stiffness, self.mass);
        let ceiling = 1.0 / (shifted.shift + zero);
        let operator = ShiftInvert { space: &space, factor: &shifted.factor, ceiling };
        // A few more eigenvalues are likely to contain a wide gap.
        let wanted = count + BLOCK / 2;
        let mut random = Random(1);
        let mut ritz = RitzPairs { values: Vec::new(), vectors: Mat::zeros(space.size(), 0) };
        let mut missed = Count { found: 0, counted: 0 };
        for _ in 0..=MAX_RETRIES {
            ritz = largest(&operator, ritz, wanted, &mut random, progress, count)?;
            let values: Vec<f64> = ritz.values.iter().map(|theta| 1.0 / theta - shifted.shift).collect();
            self.check_mechanisms(&values)?;
            check_cancelled(progress)?;
            let counted = count_below_gap(self.stiffness, self.mass, &self.analysis, &values, count)?;
            let Some(Count { found, counted }) = counted else { return Err(self.uncounted(values[0])) };
            let found = found + self.rigid.ncols();
            if found == counted {
                return Ok((values, ritz.vectors, shifted));
            }
            missed = Count { found, counted };
        }
        Err(ModesError::MissedModes { found: missed.found, counted: missed.counted })
    }

    /// Returns the error for an uncertain count, with its likely causes.
    fn uncounted(&self, lowest: f64) -> ModesError {
        let mean = self.stiffness.trace() / self.mass.trace();
        let (smallest, largest) = self.stiffness.diagonal_range();
        ModesError::Uncounted { contrast: largest / smallest, lowest: lowest / mean }
    }

    /// Returns an error if eigenvalues (ascending) are 0.
    fn check_mechanisms(&self, values: &[f64]) -> Result<(), ModesError> {
        let zero = negligible(self.stiffness, self.mass);
        let expected = self.rigid.ncols();
        let mut found = expected + values.iter().filter(|x| **x <= zero).count();
        if found == expected {
            return Ok(());
        }
        // More may exist than the search returned.
        let sigma = values.get(found - expected).map_or(zero, |next| (zero * next).sqrt());
        let shifted = self.stiffness.combined(1.0, self.mass, -sigma);
        found = found.max(count_negative_eigenvalues(&shifted, &self.analysis)?.unwrap_or(0));
        Err(ModesError::Mechanism { found, expected })
    }
}

/// Chooses the sign of each column so that its largest component is positive, the first one of equals.
pub(crate) fn fix_signs(vectors: &mut Mat<f64>) {
    for column in vectors.col_iter_mut() {
        let largest = column.norm_max();
        let first = column.as_ref().iter().find(|x| x.abs() >= (1.0 - TIE_TOLERANCE) * largest).copied();
        if first.is_some_and(|x| x < 0.0) {
            column.iter_mut().for_each(|x| *x = -*x);
        }
    }
}
