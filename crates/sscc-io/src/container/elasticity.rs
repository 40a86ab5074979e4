//! What a model file knows of the elastic forces, and their tensors: `stiffness` (r x r), and for large deformations
//! `forces_quadratic` and `forces_cubic`.

use sscc::limits;

use super::{Sealed, SealedWriter};
use crate::cubic::monomials;
use crate::{Cubic, FormatError, Place};

pub(super) const STIFFNESS: &str = "stiffness";
pub(super) const QUADRATIC: &str = "forces_quadratic";
pub(super) const CUBIC: &str = "forces_cubic";

/// The text entry that states the reduced mass matrix.
const MASS: &str = "mass";
/// Its one value: `M~` is the identity.
const IDENTITY: &str = "identity";

/// Mirrored entries differ by at most this share of the largest entry: more is a mistake, not rounding.
const SYMMETRY_SHARE: f64 = 1e-9;

/// What a model file knows of the elastic forces: the reduced internal forces at q, for modes of which the reduced mass
/// matrix is the identity. So the eigenvalues of the stiffness are squared natural angular frequencies.
#[derive(Clone, Debug, PartialEq)]
pub enum Elasticity {
    /// The stiffness `K~` at rest (r x r, row-major, symmetric): the forces are `K~ q`.
    Linear(Vec<f64>),
    /// The forces of large deformations (St. Venant-Kirchhoff); their linear part is the stiffness at rest.
    Nonlinear(Cubic),
}

impl Elasticity {
    /// The stiffness at rest (r x r, row-major).
    pub fn stiffness(&self) -> &[f64] {
        match self {
            Self::Linear(stiffness) => stiffness,
            Self::Nonlinear(forces) => &forces.linear,
        }
    }

    /// Number of modes r.
    pub fn rank(&self) -> usize {
        match self {
            Self::Linear(stiffness) => stiffness.len().isqrt(),
            Self::Nonlinear(forces) => forces.rank,
        }
    }
}

/// The shapes of the three tensors.
fn shapes(rank: usize) -> [(&'static str, [usize; 2]); 3] {
    // A length that no `usize` holds fits no tensor; the largest one means any.
    let length = |n: u128| usize::try_from(n).unwrap_or(usize::MAX).min(usize::MAX - 1);
    let [one, two, three] = monomials(rank as u128).map(|n| [rank, length(n)]);
    [(STIFFNESS, one), (QUADRATIC, two), (CUBIC, three)]
}

/// Adds the forces of a model of that many modes, and its mass as text.
///
/// # Errors
/// When they would be refused by the reader.
pub(super) fn write(
    writer: &mut SealedWriter,
    elasticity: &Elasticity,
    rank: usize,
) -> Result<(), FormatError> {
    let values = match elasticity {
        Elasticity::Linear(stiffness) => vec![stiffness],
        Elasticity::Nonlinear(Cubic { linear, quadratic, cubic, .. }) => vec![linear, quadratic, cubic],
    };
    writer.text(MASS, IDENTITY);
    for ((name, shape), values) in shapes(rank).into_iter().zip(values) {
        let fits = shape[0].checked_mul(shape[1]) == Some(values.len());
        if fits {
            check(name, shape, values)?;
        }
        writer.f64(name, &shape, values); // which refuses values that do not fit
    }
    Ok(())
}

/// Reads the forces of a model of that many modes; none where the file has none.
pub(super) fn read(file: &Sealed<'_>, rank: usize) -> Result<Option<Elasticity>, FormatError> {
    let names = file.names();
    let there = |name: &str| names.iter().any(|known| known == name);
    if ![STIFFNESS, QUADRATIC, CUBIC].into_iter().any(there) {
        return Ok(None);
    }
    let mass = file.text(MASS)?;
    if mass != IDENTITY {
        let cause = format!("unknown mass {}", crate::error::quoted(mass));
        return Err(FormatError::new(Place::Key(MASS.into()), cause));
    }
    let tensor = |(name, shape): (&str, [usize; 2])| {
        let tensor = file.f64(name)?.shaped(&shape)?;
        check(name, shape, &tensor.values)?;
        Ok::<_, FormatError>(tensor.values)
    };
    let [linear, quadratic, cubic] = shapes(rank);
    let linear = tensor(linear)?;
    if !there(QUADRATIC) && !there(CUBIC) {
        return Ok(Some(Elasticity::Linear(linear)));
    }
    let (quadratic, cubic) = (tensor(quadratic)?, tensor(cubic)?);
    Ok(Some(Elasticity::Nonlinear(Cubic { rank, linear, quadratic, cubic })))
}

/// Refuses entries out of range, and a stiffness that is not symmetric.
fn check(name: &str, [rows, columns]: [usize; 2], values: &[f64]) -> Result<(), FormatError> {
    let refused = |cause: String| Err(FormatError::new(Place::Tensor(name.into()), cause));
    let place = |at: usize| format!("at row {}, column {} (counted from 0)", at / columns, at % columns);
    if let Some(at) = values.iter().position(|x| x.is_nan() || x.abs() > limits::LARGEST) {
        return refused(format!("{:e} {}: not finite, or beyond 2^200", values[at], place(at)));
    }
    if name != STIFFNESS {
        return Ok(());
    }
    let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (row, column) in (0..rows).flat_map(|row| (0..row).map(move |column| (row, column))) {
        let at = row * columns + column;
        let [entry, mirrored] = [values[at], values[column * columns + row]];
        if (entry - mirrored).abs() > SYMMETRY_SHARE * largest {
            return refused(format!(
                "{entry:e} {}, but {mirrored:e} mirrored: it must be symmetric",
                place(at)
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
