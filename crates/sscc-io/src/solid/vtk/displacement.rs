//! Selection of the point data that moves the points of a grid.

use crate::FormatError;
use crate::error::quoted;

/// Names that solvers give to displacements, in any case, the clearest first.
const NAMES: [&str; 5] = ["displacement", "displacements", "displacement_vector", "displ", "disp"];

/// A further name of displacements.
const SHORT: &str = "u";

/// Name of displacements or, as OpenFOAM writes them, of velocities.
const UNCLEAR: &str = "U";

/// The point data of a grid that moves its points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Displacement {
    /// The vectors with a name that solvers give to displacements, such as `displacement` and `u`; if there are none, no data.
    /// `U` is not such a name, because it is also a name of velocities.
    #[default]
    ByName,
    /// No data: the points keep their positions.
    None,
    /// The vectors of this name.
    Named(String),
}

impl Displacement {
    /// Returns the choice by a name; an empty name chooses no data.
    pub(crate) fn of_name(name: Option<&str>) -> Self {
        match name {
            None => Self::ByName,
            Some("") => Self::None,
            Some(name) => Self::Named(name.to_owned()),
        }
    }

    /// Whether points stay where they are although the data has vectors `U`, which may be displacements or velocities.
    pub(super) fn is_unclear<'a>(&self, mut arrays: impl Iterator<Item = (&'a str, usize)> + Clone) -> bool {
        *self == Self::ByName
            && matches!(self.choose(arrays.clone()), Ok(None))
            && arrays.any(|(name, components)| components == 3 && name == UNCLEAR)
    }

    /// Returns the chosen one of these arrays, each with its number of components.
    ///
    /// # Errors
    /// When no array has the wanted name; when two have the chosen name, because which of them the file means is unknown.
    pub(super) fn choose<'a>(
        &self,
        arrays: impl Iterator<Item = (&'a str, usize)> + Clone,
    ) -> Result<Option<usize>, FormatError> {
        let chosen = self.choose_first(arrays.clone())?;
        let name = chosen.and_then(|chosen| arrays.clone().nth(chosen)).map(|(name, _)| name);
        let is_chosen = |(other, components): &(&str, usize)| *components == 3 && Some(*other) == name;
        if arrays.filter(is_chosen).nth(1).is_none() {
            return Ok(chosen);
        }
        let cause = format!(
            "there are two arrays of vectors {}: rename or remove one (FILE# takes the points as they are)",
            quoted(name.unwrap_or_default())
        );
        Err(FormatError::part("point data", cause))
    }

    /// As [`Displacement::choose`], but returns the first array of the chosen name.
    fn choose_first<'a>(
        &self,
        arrays: impl Iterator<Item = (&'a str, usize)> + Clone,
    ) -> Result<Option<usize>, FormatError> {
        let find = |is_wanted: &dyn Fn(&str) -> bool| {
            arrays.clone().position(|(name, components)| components == 3 && is_wanted(name))
        };
        match self {
            Self::None => Ok(None),
            Self::ByName => {
                let clear = NAMES.iter().find_map(|known| find(&|name| name.eq_ignore_ascii_case(known)));
                Ok(clear.or_else(|| find(&|name| name == SHORT)))
            }
            Self::Named(wanted) => match find(&|name| name == wanted) {
                Some(found) => Ok(Some(found)),
                None => {
                    let vectors = arrays.filter(|(_, components)| *components == 3);
                    let known: Vec<String> = vectors.take(10).map(|(name, _)| quoted(name)).collect();
                    let has = if known.is_empty() { "no vectors".into() } else { known.join(", ") };
                    let cause = format!("there are no vectors {}; the point data has {has}", quoted(wanted));
                    Err(FormatError::part("point data", cause))
                }
            },
        }
    }
}
