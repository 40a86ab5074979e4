//! The ranges in which sweeps move the weights of modes, and their units.

use std::fmt;

use sscc::ReducedModel;
use sscc_io::{LoadedModel, Message, Setting};

use super::sweep_row::weight;
use crate::TaskError;
use crate::error::Result;

/// Range of sweeps of principal components, in standard deviations. It contains 99.7% of a normal distribution.
const DEVIATIONS: f64 = 3.0;

/// The ranges of the weights of all modes.
#[derive(Clone, Debug, PartialEq)]
pub enum SweepRange {
    /// The same range for every weight.
    Given([f64; 2]),
    /// From 0 to 1, for modes with names, which are morph targets.
    Targets,
    /// Three standard deviations below and above the mean, for principal components. Holds the deviation of each weight.
    Deviations(Vec<f64>),
    /// The change of the weight, below and above its start, that moves some vertex by half the diagonal of the AABB.
    HalfDiagonal,
}

impl SweepRange {
    /// Parses the range of `--range`: two numbers.
    ///
    /// # Errors
    /// When there are not two numbers with a finite difference, in ascending order.
    pub fn parse(typed: &str) -> Result<Self> {
        let refused = |cause: Message| Err(TaskError::refused(Setting::Range + " " + typed, cause));
        let numbers: std::result::Result<Vec<f64>, _> =
            typed.split(',').map(|text| text.trim().parse()).collect();
        match numbers.as_deref() {
            Ok([low, high]) if !(low.is_finite() && high.is_finite()) => {
                refused("both ends must be finite".into())
            }
            Ok([low, high]) if !(high - low).is_finite() => {
                refused("the range is too wide: the difference of both ends must be finite".into())
            }
            Ok([low, high]) if low >= high => {
                refused("the range is empty: the first number must be the smaller one".into())
            }
            Ok([low, high]) => Ok(Self::Given([*low, *high])),
            _ => refused("two numbers were expected, as in " + Setting::Range + "=-1,1"),
        }
    }

    /// Returns the default range of a model.
    pub fn of_model(loaded: &LoadedModel) -> Self {
        Self::of_modes(&loaded.mode_names, loaded.info.deviations.as_deref())
    }

    /// Returns the default range for the names of the modes (or no names) and the standard deviations of q, if known.
    pub fn of_modes(mode_names: &[String], deviations: Option<&[f64]>) -> Self {
        match deviations {
            _ if !mode_names.is_empty() => Self::Targets,
            Some(deviations) => Self::Deviations(deviations.to_vec()),
            None => Self::HalfDiagonal,
        }
    }

    /// Returns the range of each weight, for sweeps that start at q.
    pub fn ends(&self, model: &ReducedModel, q: &[f64]) -> Vec<[f64; 2]> {
        let limits = model.weight_limits();
        let half_diagonal = |k: usize| [q[k] - limits[k], q[k] + limits[k]];
        let range = |k: usize| match self {
            Self::Given(range) => *range,
            Self::Targets => [0.0, 1.0],
            Self::Deviations(deviations) => {
                let end = DEVIATIONS * deviations[k];
                // A component without variance has no range of its own.
                if end > 0.0 && (2.0 * end).is_finite() { [-end, end] } else { half_diagonal(k) }
            }
            Self::HalfDiagonal => half_diagonal(k),
        };
        (0..q.len()).map(range).collect()
    }
}

impl fmt::Display for SweepRange {
    /// Writes the range and its unit.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given([low, high]) => {
                write!(f, "each weight from {} to {}, in units of q", weight(*low), weight(*high))
            }
            Self::Targets => f.write_str("each weight from 0 to 1, the whole morph target"),
            Self::Deviations(all) if all.iter().all(|deviation| *deviation == 1.0) => {
                write!(f, "each weight from -{DEVIATIONS} to {DEVIATIONS} standard deviations, the unit of q")
            }
            Self::Deviations(_) => {
                write!(f, "each weight from -{DEVIATIONS} to {DEVIATIONS} standard deviations, listed in units of q")
            }
            Self::HalfDiagonal => f.write_str(
                "each weight up and down by the change that moves some vertex by half the diagonal of the AABB, \
                 listed in units of q",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use sscc::{Modes, TriMesh};

    use super::*;

    /// Returns a triangle with two modes.
    fn model() -> ReducedModel {
        let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let modes = Modes::from_matrix(3, 2, |row, k| f64::from(u8::from(row == 3 * k))).unwrap();
        ReducedModel::new(mesh, modes).unwrap()
    }

    #[test]
    fn ranges_are_two_numbers_in_order() {
        assert_eq!(SweepRange::parse("-1, 2.5").unwrap(), SweepRange::Given([-1.0, 2.5]));
        let message = |typed: &str| SweepRange::parse(typed).unwrap_err().to_string();
        let empty = "range 1,1: the range is empty: the first number must be the smaller one";
        assert_eq!(message("1,1"), empty);
        assert!(message("1,0").contains("is empty"));
        for typed in ["", "1", "1,2,3", "a,b"] {
            assert!(message(typed).ends_with("two numbers were expected, as in range=-1,1"), "{typed}");
        }
        for typed in ["nan,1", "0,inf", "inf,inf"] {
            assert!(message(typed).ends_with(": both ends must be finite"), "{typed}");
        }
        for typed in ["-1e308,1e308", "1e308,-1e308"] {
            assert!(message(typed).ends_with(": the difference of both ends must be finite"), "{typed}");
        }
    }

    #[test]
    fn principal_components_go_to_three_standard_deviations_about_the_mean() {
        let (model, q) = (model(), [0.25, 0.0]);
        let range = |names: &[String], deviations: Option<&[f64]>| SweepRange::of_modes(names, deviations);
        let limit = 0.5 * 2.0_f64.sqrt();
        assert_eq!(range(&[], None).ends(&model, &q), [[0.25 - limit, 0.25 + limit], [-limit, limit]]);
        let known = range(&[], Some(&[2.0, 0.5]));
        assert_eq!(known.ends(&model, &q), [[-6.0, 6.0], [-1.5, 1.5]]);
        assert_eq!(known.to_string(), "each weight from -3 to 3 standard deviations, listed in units of q");
        let unit = range(&[], Some(&[1.0, 1.0])).to_string();
        assert_eq!(unit, "each weight from -3 to 3 standard deviations, the unit of q");
        // One component has no variance, one has a variance beyond the range of numbers.
        let unusual = range(&[], Some(&[0.0, 1e308]));
        assert_eq!(unusual.ends(&model, &q), range(&[], None).ends(&model, &q));
        let names = ["a", "b"].map(str::to_owned);
        assert_eq!(range(&names, None).ends(&model, &q), [[0.0, 1.0]; 2]);
    }
}
