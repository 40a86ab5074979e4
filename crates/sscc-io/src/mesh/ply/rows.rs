//! Rows with a list of corners.

use super::header::{Element, Kind, Number, Property};
use super::values::Values;
use crate::FormatError;

/// Returns the place and the type of the list of corners among the properties of an element.
pub(super) fn corner_list(element: &Element) -> Result<(usize, Number), FormatError> {
    let refused = |cause: String| Err(FormatError::line(element.line, cause));
    let name = &element.name;
    let is_corners = |name: &str| matches!(name, "vertex_indices" | "vertex_index");
    let mut found = element.properties.iter().enumerate().filter(|(_, p)| is_corners(&p.name));
    match (found.next(), found.next()) {
        (Some(_), Some(_)) => {
            refused(format!("the element '{name}' has two lists of corners: remove one of them"))
        }
        (Some((at, Property { kind: Kind::List { item, .. }, .. })), None) => Ok((at, *item)),
        (Some((_, property)), None) => refused(format!("'{}' must be a list", property.name)),
        (None, _) => refused(format!("the element '{name}' has no list 'vertex_indices' or 'vertex_index'")),
    }
}

/// Reads a row of faces; `take` reads each number of the wanted list.
pub(super) fn read_row(
    element: &Element,
    values: &mut Values<'_>,
    wanted: usize,
    take: impl FnMut(&mut Values<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    values.row(|values| read_numbers(element, values, wanted, take))
}

/// Reads the numbers of a row, which may have any number of lines.
pub(super) fn read_numbers(
    element: &Element,
    values: &mut Values<'_>,
    wanted: usize,
    mut take: impl FnMut(&mut Values<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    for (at, property) in element.properties.iter().enumerate() {
        match property.kind {
            Kind::List { count, item } if at == wanted => {
                for _ in 0..values.list(count, item)? {
                    take(values)?;
                }
            }
            Kind::List { count, item } => values.skip_list(count, item)?,
            Kind::Number(number) => drop(values.number(number)?),
        }
    }
    Ok(())
}
