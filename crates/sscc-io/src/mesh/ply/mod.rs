//! Reader for polygon files (PLY): text, binary little endian and binary big endian.
//!
//! The module has its own parser: the crate `ply-rs-bw` trusts the counts of the header. Here bytes must back each row,
//! and only coordinates and corners are kept. See `docs/notes/2026-11-23-parsers-of-other-crates.md`.

mod header;
mod values;

use glam::DVec3;
use sscc::TriMesh;

use self::header::{Element, Header, Kind};
use self::values::Values;
use super::Soup;
use super::polygons::Polygons;
use crate::FormatError;

/// Parses a PLY file: `x`, `y`, `z` of the element `vertex` (any numeric type), and the list `vertex_indices` or
/// `vertex_index` of the element `face` (any integer types). Other elements and properties are skipped. Numbers in text
/// files have their declared type, too, so a text file and a binary file with the same declarations give the same mesh.
///
/// # Errors
/// When the header is malformed, lacks one of these, or declares more data than the file has; when bytes follow the last
/// row; when an index names no vertex, or [`TriMesh::new`] rejects the mesh.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, FormatError> {
    soup(bytes)?.into_mesh()
}

pub(super) fn soup(bytes: &[u8]) -> Result<Soup, FormatError> {
    let header = Header::parse(bytes)?;
    let mut values = Values::new(bytes, &header);
    let mut positions = Vec::new();
    let mut polygons = Polygons::new(0);
    for element in &header.elements {
        values.check_room(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, &mut positions)?,
            "face" => read_faces(element, &mut values, &mut polygons)?,
            _ => skip(element, &mut values)?,
        }
    }
    values.finish()?;
    polygons.finish(positions)
}

fn read_vertices(
    element: &Element,
    values: &mut Values<'_>,
    positions: &mut Vec<DVec3>,
) -> Result<(), FormatError> {
    let axis = |name: &str| match element.properties.iter().position(|p| p.name == name) {
        Some(at) if matches!(element.properties[at].kind, Kind::Number(_)) => Ok(at),
        _ => Err(FormatError::line(
            element.line,
            format!("the element 'vertex' has no scalar property '{name}'"),
        )),
    };
    let axes = [axis("x")?, axis("y")?, axis("z")?];
    for _ in 0..element.count {
        let mut position = DVec3::ZERO;
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Number(number) => {
                    let value = values.number(number)?;
                    if let Some(axis) = axes.iter().position(|a| *a == at) {
                        position[axis] = value;
                    }
                }
                Kind::List { count, item } => values.skip_list(count, item)?,
            }
        }
        positions.push(position);
    }
    Ok(())
}

fn read_faces(
    element: &Element,
    values: &mut Values<'_>,
    polygons: &mut Polygons,
) -> Result<(), FormatError> {
    let is_corners = |name: &str| matches!(name, "vertex_indices" | "vertex_index");
    let Some(wanted) = element.properties.iter().position(|p| is_corners(&p.name)) else {
        let cause = "the element 'face' has no list 'vertex_indices' or 'vertex_index'";
        return Err(FormatError::line(element.line, cause));
    };
    let mut corners = Vec::new();
    for _ in 0..element.count {
        let place = values.place();
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { count, item } if at == wanted => {
                    corners.clear();
                    for _ in 0..values.list(count, item)? {
                        corners.push(values.integer(item)?);
                    }
                }
                Kind::Number(_) if at == wanted => {
                    let cause = format!("'{}' must be a list", property.name);
                    return Err(FormatError::line(element.line, cause));
                }
                Kind::List { count, item } => values.skip_list(count, item)?,
                Kind::Number(number) => drop(values.number(number)?),
            }
        }
        polygons.push(&corners, place)?;
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values<'_>) -> Result<(), FormatError> {
    if element.properties.is_empty() {
        return Ok(()); // rows without bytes can have any count
    }
    for _ in 0..element.count {
        for property in &element.properties {
            match property.kind {
                Kind::List { count, item } => values.skip_list(count, item)?,
                Kind::Number(number) => drop(values.number(number)?),
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
