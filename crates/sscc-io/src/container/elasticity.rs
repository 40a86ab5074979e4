//! Elastic forces in a model file: `stiffness` (r x r), and for large deformations `forces_quadratic` and
//! `forces_cubic`.

use sscc_solid::{Elasticity, ReducedForces, SolidError, Stiffness, monomials};

use super::{ANY, Container, ContainerWriter};
use crate::{FormatError, Place};

pub(super) const STIFFNESS: &str = "stiffness";
pub(super) const QUADRATIC: &str = "forces_quadratic";
pub(super) const CUBIC: &str = "forces_cubic";

/// Key of the text entry for the reduced mass matrix.
const MASS: &str = "mass";
/// The only value of this text: `M~` is the identity.
const IDENTITY: &str = "identity";

/// Returns the shapes of the three tensors.
fn shapes(rank: usize) -> [(&'static str, [usize; 2]); 3] {
    // A length beyond `usize` fits no tensor; `ANY` itself would match every length.
    let [one, two, three] = [1, 2, 3].map(|degree| [rank, monomials::count(rank, degree).min(ANY - 1)]);
    [(STIFFNESS, one), (QUADRATIC, two), (CUBIC, three)]
}

/// Adds the forces of a model of rank r, and the text for its mass.
///
/// # Errors
/// When the rank of the forces differs.
pub(super) fn write(
    writer: &mut ContainerWriter,
    elasticity: &Elasticity,
    rank: usize,
) -> Result<(), FormatError> {
    let found = elasticity.rank();
    if found != rank {
        let cause = format!("the stiffness has {found} modes, the model has {rank}");
        return Err(FormatError::new(Place::Tensor(STIFFNESS.into()), cause));
    }
    let stiffness = elasticity.stiffness().entries();
    let values = match elasticity {
        Elasticity::Linear(_) => vec![stiffness],
        Elasticity::Nonlinear(forces) => vec![stiffness, forces.quadratic(), forces.cubic()],
    };
    writer.text(MASS, IDENTITY);
    for ((name, shape), values) in shapes(rank).into_iter().zip(values) {
        writer.f64(name, &shape, values);
    }
    Ok(())
}

/// Reads the forces of a model of rank r; None if the file has no forces.
pub(super) fn read(file: &Container<'_>, rank: usize) -> Result<Option<Elasticity>, FormatError> {
    let names = file.names();
    let exists = |name: &str| names.iter().any(|known| known == name);
    if ![STIFFNESS, QUADRATIC, CUBIC].into_iter().any(exists) {
        return Ok(None);
    }
    let mass = file.text(MASS)?;
    if mass != IDENTITY {
        let cause = format!("unknown mass {}", crate::error::quoted(mass));
        return Err(FormatError::new(Place::Key(MASS.into()), cause));
    }
    let tensor =
        |(name, shape): (&str, [usize; 2])| Ok::<_, FormatError>(file.f64(name)?.shaped(&shape)?.values);
    let [linear, quadratic, cubic] = shapes(rank);
    let stiffness = Stiffness::new(rank, tensor(linear)?).map_err(refused)?;
    if !exists(QUADRATIC) && !exists(CUBIC) {
        return Ok(Some(Elasticity::Linear(stiffness)));
    }
    let forces = ReducedForces::new(stiffness, tensor(quadratic)?, tensor(cubic)?).map_err(refused)?;
    Ok(Some(Elasticity::Nonlinear(forces)))
}

/// Returns the error with its place, the tensor that has the invalid entry.
fn refused(error: SolidError) -> FormatError {
    let tensor = match error {
        SolidError::ForceEntry { degree: 2, .. } | SolidError::ForceLength { degree: 2, .. } => QUADRATIC,
        SolidError::ForceEntry { .. } | SolidError::ForceLength { .. } => CUBIC,
        _ => STIFFNESS,
    };
    FormatError::new(Place::Tensor(tensor.into()), error.to_string())
}

#[cfg(test)]
mod tests;
