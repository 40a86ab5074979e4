//! The lowest eigenvectors of `K x = lambda M x`, all of them: counted, not believed.

use faer::{Mat, MatRef};
use glam::DVec3;
use sscc::{Error, Progress};

use super::factor::{Cholesky, Symbolic};
use super::lanczos::{BLOCK, Operator, Random, Ritz, largest};
use super::BlockSparse;
use crate::ModesError;

/// The shift, as a share of an upper bound of the lowest eigenvalue.
const SHIFT: f64 = 1e-3;

/// An eigenvalue below this share of the mean one is rounding: a motion that costs no energy. The lowest of slender
/// springs are about 1e-9 of it.
const ZERO: f64 = 1e-13;

/// How often new random vectors may look for what was missed.
const ROUNDS: usize = 4;

/// A stiffness, a mass, and what is known of them.
pub(crate) struct Pencil<'a> {
    /// K, positive semidefinite.
    pub stiffness: &'a BlockSparse,
    /// M, positive definite, of the same pattern.
    pub mass: &'a BlockSparse,
    /// Where the free vertices are at rest.
    pub positions: &'a [DVec3],
    /// M-orthonormal motions without energy; no columns where the body is fixed.
    pub rigid: MatRef<'a, f64>,
}

/// The lowest eigenvectors.
pub(crate) struct Lowest {
    /// Ascending (squared angular frequencies).
    pub eigenvalues: Vec<f64>,
    /// M-orthonormal, M-orthogonal to the rigid motions.
    pub vectors: Mat<f64>,
}

impl Pencil<'_> {
    /// Takes the rigid motions away, M-orthogonally.
    pub fn without_rigid(&self, x: &mut Mat<f64>) {
        if self.rigid.ncols() > 0 {
            for _ in 0..2 {
                let coefficients = self.rigid.transpose() * self.mass.multiply(x.as_ref());
                *x -= self.rigid * coefficients;
            }
        }
    }

    /// A shift that makes K positive definite and leaves the order of magnitude of its eigenvalues; 0 for fixed bodies.
    pub fn shift(&self) -> f64 {
        if self.rigid.ncols() == 0 {
            return 0.0;
        }
        // Quadratic fields of the position bound the lowest eigenvalue from above (Rayleigh-Ritz).
        let low = self.positions.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
        let high = self.positions.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
        let (middle, size) = ((low + high) * 0.5, (high - low).max_element());
        let mut fields = Mat::from_fn(3 * self.positions.len(), 27, |row, k| {
            let p = (self.positions[row / 3] - middle) / size;
            let scalars = [p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.y * p.z, p.z * p.x];
            if k % 3 == row % 3 { scalars[k / 3] } else { 0.0 }
        });
        self.without_rigid(&mut fields);
        let (energy, mass) = (self.stiffness.multiply(fields.as_ref()), self.mass.multiply(fields.as_ref()));
        let quotient = |k: usize| {
            let along = |x: &Mat<f64>| fields.col(k).transpose() * x.col(k);
            along(&energy) / along(&mass)
        };
        let mean = self.stiffness.trace() / self.mass.trace();
        // Linear fields may be rigid but for rounding.
        let least = (0..27).map(quotient).filter(|x| *x > 1e-9 * mean).fold(mean, f64::min);
        SHIFT * least
    }

    /// The factor of `K + s M`.
    ///
    /// # Errors
    /// When there are motions without energy beside the rigid ones.
    pub fn factor<'a>(&self, symbolic: &'a Symbolic, shift: f64) -> Result<Cholesky<'a>, ModesError> {
        let shifted = self.stiffness.combined(1.0, self.mass, shift);
        let expected = self.rigid.ncols();
        symbolic.factor(&shifted).ok_or(ModesError::Mechanism { found: expected + 1, expected })
    }
}

/// `(K + s M)^-1 M` beside the rigid motions: its eigenvalues are `1 / (lambda + s)`.
struct Inverse<'a> {
    pencil: &'a Pencil<'a>,
    factor: &'a Cholesky<'a>,
    wanted: usize,
    progress: &'a dyn Progress,
}

impl Operator for Inverse<'_> {
    fn apply(&self, x: MatRef<f64>) -> Mat<f64> {
        let mut y = self.pencil.mass.multiply(x);
        self.factor.solve(&mut y);
        self.deflate(&mut y);
        y
    }

    fn mass(&self, x: MatRef<f64>) -> Mat<f64> {
        self.pencil.mass.multiply(x)
    }

    fn deflate(&self, x: &mut Mat<f64>) {
        self.pencil.without_rigid(x);
    }

    fn step(&self, found: usize) -> Result<(), ModesError> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled.into());
        }
        self.progress.report(found, self.wanted);
        Ok(())
    }
}

/// The `count` lowest eigenvectors beside the rigid motions, none missed: the eigenvalues below the last one are
/// counted by the inertia of `K - sigma M`. Residuals could not tell: they are small for what was found.
///
/// # Errors
/// When there are fewer, the body has other motions without energy, it is cancelled, or memory is short.
pub(crate) fn lowest_modes(
    pencil: &Pencil,
    symbolic: &Symbolic,
    factor: &Cholesky,
    shift: f64,
    count: usize,
    progress: &dyn Progress,
) -> Result<Lowest, ModesError> {
    let (size, rigid) = (3 * pencil.stiffness.rows(), pencil.rigid.ncols());
    let available = size - rigid;
    if count > available {
        return Err(ModesError::TooManyModes { asked: count, available });
    }
    // A few more, so that the count can be taken in a wide gap.
    let wanted = (count + BLOCK).min(available);
    let operator = Inverse { pencil, factor, wanted, progress };
    let mut random = Random::new();
    let mut known = None;
    for _ in 0..ROUNDS {
        let ritz = largest(&operator, known, wanted, [size, available], &mut random)?;
        let eigenvalues: Vec<f64> = ritz.values.iter().map(|theta| 1.0 / theta - shift).collect();
        let zero = ZERO * pencil.stiffness.trace() / pencil.mass.trace();
        let mechanisms = eigenvalues.iter().filter(|x| **x <= zero).count();
        if mechanisms > 0 {
            return Err(ModesError::Mechanism { found: rigid + mechanisms, expected: rigid });
        }
        if all_found(pencil, symbolic, &eigenvalues, count, available)? {
            let mut vectors = ritz.vectors.as_ref().subcols(0, count).to_owned();
            fix_signs(&mut vectors);
            return Ok(Lowest { eigenvalues: eigenvalues[..count].to_vec(), vectors });
        }
        known = Some(ritz);
    }
    Err(ModesError::NoEigenvalues)
}

/// Whether as many eigenvalues as found lie below a gap after the first `count`.
fn all_found(
    pencil: &Pencil,
    symbolic: &Symbolic,
    found: &[f64],
    count: usize,
    available: usize,
) -> Result<bool, ModesError> {
    if found.len() == available {
        return Ok(true); // all there are
    }
    let ratio = |k: &usize| found[*k] / found[k - 1];
    let gap = (count..found.len()).max_by(|a, b| ratio(a).total_cmp(&ratio(b))).unwrap_or(found.len() - 1);
    let (low, high) = (found[gap - 1], found[gap]);
    for share in [0.5, 0.37, 0.71] {
        let sigma = low + share * (high - low);
        let shifted = pencil.stiffness.combined(1.0, pencil.mass, -sigma);
        if let Some(negative) = symbolic.negative_eigenvalues(&shifted) {
            return Ok(negative == gap + pencil.rigid.ncols());
        }
    }
    Err(ModesError::NoEigenvalues)
}

/// Turns each column so that its largest entry is positive, the first one of equals.
pub(crate) fn fix_signs(vectors: &mut Mat<f64>) {
    for j in 0..vectors.ncols() {
        let column = vectors.col_as_slice_mut(j);
        let largest = column.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let first = column.iter().find(|x| x.abs() >= (1.0 - 1e-8) * largest);
        if first.is_some_and(|x| *x < 0.0) {
            column.iter_mut().for_each(|x| *x = -*x);
        }
    }
}
