//! Elastic forces in a model container: `stiffness` (r x r), and for large deformations `forces_quadratic` and
//! `forces_cubic`.

use super::{Sealed, SealedWriter};
use crate::{Cubic, FormatError};

pub(super) const STIFFNESS: &str = "stiffness";
pub(super) const QUADRATIC: &str = "forces_quadratic";
pub(super) const CUBIC: &str = "forces_cubic";

/// Mirrored entries of a stiffness may differ by this share of the largest.
const SYMMETRIC: f64 = 1e-9;

/// The elastic forces of a model whose modes are mass-orthonormal: its reduced mass matrix is the identity.
#[derive(Clone, Debug, PartialEq)]
pub enum Elasticity {
    /// Forces are `K q`: the stiffness K (r x r, row after row), symmetric.
    Linear(Vec<f64>),
    /// Forces of large deformations; their linear part is the stiffness at rest.
    Nonlinear(Cubic),
}

impl Elasticity {
    /// The stiffness at rest (r x r, row after row).
    pub fn stiffness(&self) -> &[f64] {
        match self {
            Self::Linear(stiffness) => stiffness,
            Self::Nonlinear(forces) => &forces.linear,
        }
    }

    /// The squared angular frequencies, where the stiffness is diagonal.
    pub fn diagonal(&self) -> Option<Vec<f64>> {
        let stiffness = self.stiffness();
        let rank = stiffness.len().isqrt();
        let largest = stiffness.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let off = |at: &usize| at / rank != at % rank && stiffness[*at].abs() > 1e-9 * largest;
        let diagonal = !(0..stiffness.len()).any(|at| off(&at));
        diagonal.then(|| (0..rank).map(|k| stiffness[k * (rank + 1)]).collect())
    }
}

/// Adds the forces.
pub(super) fn write(writer: &mut SealedWriter, elasticity: &Elasticity, rank: usize) {
    writer.f64(STIFFNESS, &[rank, rank], elasticity.stiffness());
    if let Elasticity::Nonlinear(forces) = elasticity {
        let [two, three] = monomials(rank);
        writer.f64(QUADRATIC, &[rank, two], &forces.quadratic).f64(CUBIC, &[rank, three], &forces.cubic);
    }
}

/// Reads the forces of so many modes, if there are any.
pub(super) fn read(file: &Sealed<'_>, rank: usize) -> Result<Option<Elasticity>, FormatError> {
    let has = |name: &str| file.names().iter().any(|n| n == name);
    if !has(STIFFNESS) && !has(QUADRATIC) && !has(CUBIC) {
        return Ok(None);
    }
    let stiffness = file.f64(STIFFNESS)?.shaped(&[rank, rank])?;
    let largest = stiffness.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for i in 0..rank {
        for j in 0..=i {
            let (entry, mirrored) = (stiffness.values[i * rank + j], stiffness.values[j * rank + i]);
            if !entry.is_finite() || !mirrored.is_finite() || (entry - mirrored).abs() > SYMMETRIC * largest {
                let cause = format!("it is not finite or not symmetric at row {i}, column {j}");
                return Err(stiffness.refused(cause));
            }
        }
    }
    if !has(QUADRATIC) && !has(CUBIC) {
        return Ok(Some(Elasticity::Linear(stiffness.values)));
    }
    let [two, three] = monomials(rank);
    let part = |name: &str, monomials: usize| {
        let tensor = file.f64(name)?.shaped(&[rank, monomials])?;
        match tensor.values.iter().all(|x| x.is_finite()) {
            true => Ok(tensor.values),
            false => Err(tensor.refused("a coefficient is not finite")),
        }
    };
    let (quadratic, cubic) = (part(QUADRATIC, two)?, part(CUBIC, three)?);
    Ok(Some(Elasticity::Nonlinear(Cubic { rank, linear: stiffness.values, quadratic, cubic })))
}

/// Monomials of degree 2 and 3. `rank` is that of modes that are in the file, so nothing overflows.
fn monomials(rank: usize) -> [usize; 2] {
    let two = rank * (rank + 1) / 2;
    [two, two.saturating_mul(rank + 2) / 3]
}

#[cfg(test)]
mod tests {
    use super::super::MODEL;
    use super::*;

    fn read_back(fill: impl Fn(&mut SealedWriter)) -> Result<Option<Elasticity>, String> {
        let mut writer = SealedWriter::new(MODEL);
        fill(&mut writer);
        let bytes = writer.finish().unwrap();
        read(&Sealed::parse(&bytes, MODEL).unwrap(), 2).map_err(|error| error.to_string())
    }

    #[test]
    fn forces_are_kept() {
        let cubic = Cubic {
            rank: 2,
            linear: vec![2.0, 1.0, 1.0, 3.0],
            quadratic: (0..6).map(f64::from).collect(),
            cubic: (0..8).map(f64::from).collect(),
        };
        for forces in [Elasticity::Linear(vec![1.0, 0.0, 0.0, 4.0]), Elasticity::Nonlinear(cubic)] {
            let read = read_back(|writer| write(writer, &forces, 2)).unwrap();
            assert_eq!(read, Some(forces));
        }
        assert_eq!(read_back(|_| ()).unwrap(), None);
        assert_eq!(Elasticity::Linear(vec![1.0, 0.0, 0.0, 4.0]).diagonal(), Some(vec![1.0, 4.0]));
        assert_eq!(Elasticity::Linear(vec![2.0, 1.0, 1.0, 4.0]).diagonal(), None);
    }

    #[test]
    fn wrong_forces_are_refused() {
        let stiffness = |values: [f64; 4]| {
            move |writer: &mut SealedWriter| {
                writer.f64(STIFFNESS, &[2, 2], &values);
            }
        };
        assert!(
            read_back(stiffness([1.0, 2.0, 3.0, 1.0]))
                .unwrap_err()
                .contains("not symmetric at row 1, column 0")
        );
        assert!(read_back(stiffness([1.0, 0.0, 0.0, f64::NAN])).unwrap_err().contains("not finite"));
        let wrong = read_back(|writer| {
            writer.f64(STIFFNESS, &[1, 1], &[1.0]);
        });
        assert!(wrong.unwrap_err().contains("was expected"));
        let lonely = read_back(|writer| {
            writer.f64(QUADRATIC, &[2, 3], &[0.0; 6]);
        });
        assert!(lonely.unwrap_err().contains("stiffness"));
        let half = read_back(|writer| {
            stiffness([1.0, 0.0, 0.0, 1.0])(writer);
            writer.f64(QUADRATIC, &[2, 3], &[0.0; 6]);
        });
        assert!(half.unwrap_err().contains("forces_cubic"));
        let infinite = read_back(|writer| {
            stiffness([1.0, 0.0, 0.0, 1.0])(writer);
            writer.f64(QUADRATIC, &[2, 3], &[0.0; 6]).f64(CUBIC, &[2, 4], &[f64::INFINITY; 8]);
        });
        assert!(infinite.unwrap_err().contains("not finite"));
    }
}
