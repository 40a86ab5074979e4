//! Reader for polygon files (PLY): text, binary little endian and binary big endian.
//!
//! The module has its own parser: the crate `ply-rs-bw` trusts the counts of the header. Here bytes must back each row,
//! and only coordinates and corners are kept. See `docs/notes/files-and-page.md#readers-of-files`.

mod header;
mod rows;
mod strips;
mod values;

use glam::DVec3;
use sscc::TriMesh;

use self::header::{Element, Header, Kind, Property};
use self::rows::{corner_list, read_numbers, read_row};
use self::values::Values;
use crate::FormatError;
use crate::error::quoted;
use crate::polygons::{Polygons, Soup};

/// Parses a PLY file: `x`, `y`, `z` of the element `vertex` (any numeric type), and the list `vertex_indices` or
/// `vertex_index` of the elements `face` and `tristrips` (any integer types). Other elements and properties are skipped.
/// Numbers in text files have their declared type, too, so a text file and a binary file with the same declarations give
/// the same mesh.
///
/// In a list of strips, -1 ends a strip; in a list of an unsigned type, the largest number does so if it is no vertex. The
/// winding of every other triangle of a strip is reversed, so that all have the same orientation. Triangles with a repeated
/// corner, which connect strips, are left out.
///
/// # Errors
/// When the header is malformed, lacks one of these, or declares more data than the file has; when another element has
/// lists of vertex numbers, as faces have; when bytes follow the last row; when an index names no vertex, or
/// [`TriMesh::new`] rejects the mesh.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, FormatError> {
    soup(bytes)?.into_mesh()
}

pub(super) fn soup(bytes: &[u8]) -> Result<Soup, FormatError> {
    let header = Header::parse(bytes)?;
    let mut values = Values::new(bytes, &header);
    let (positions, polygons) = elements(&header, &mut values).map_err(|error| values.cause_of(error))?;
    polygons.finish(positions)
}

/// Reads all elements, up to the end of the file.
fn elements(header: &Header, values: &mut Values<'_>) -> Result<(Vec<DVec3>, Polygons), FormatError> {
    let vertices = header.elements.iter().find(|element| element.name == "vertex").map_or(0, |e| e.count);
    let mut positions = Vec::new();
    let mut polygons = Polygons::new(0);
    for element in &header.elements {
        values.check_room(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, values, &mut positions)?,
            "face" => read_faces(element, values, &mut polygons)?,
            "tristrips" => strips::read(element, values, vertices, &mut polygons)?,
            _ => skip(element, values)?,
        }
    }
    values.finish()?;
    Ok((positions, polygons))
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
        positions.push(values.row(|values| {
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
            Ok(position)
        })?);
    }
    Ok(())
}

fn read_faces(
    element: &Element,
    values: &mut Values<'_>,
    polygons: &mut Polygons,
) -> Result<(), FormatError> {
    let (wanted, item) = corner_list(element)?;
    let mut corners = Vec::new();
    for _ in 0..element.count {
        let place = values.place();
        corners.clear();
        read_row(element, values, wanted, |values| {
            corners.push(values.integer(item)?);
            Ok(())
        })?;
        polygons.push(&corners, place)?;
    }
    Ok(())
}

/// Elements whose lists of vertex numbers are lines.
const LINES: [&str; 6] = ["edge", "edges", "line", "lines", "polyline", "polylines"];

fn skip(element: &Element, values: &mut Values<'_>) -> Result<(), FormatError> {
    if element.properties.is_empty() {
        return Ok(()); // rows without bytes can have any count
    }
    check_without_faces(element)?;
    let none = element.properties.len();
    (0..element.count).try_for_each(|_| {
        values.begin_row();
        read_numbers(element, values, none, |_| Ok(()))
    })
}

/// Returns an error if an element that is skipped may have faces: lists of integers whose name is that of vertex numbers.
/// Scanners also write lists of texture coordinates for each face (`texture_vertex_indices`), which name no vertices.
fn check_without_faces(element: &Element) -> Result<(), FormatError> {
    let is_list = |p: &Property| match p.kind {
        Kind::List { item, .. } => {
            let is_named = p.name.contains("vert") || p.name.contains("ind");
            item.range().is_some() && is_named && !p.name.starts_with("tex")
        }
        Kind::Number(_) => false,
    };
    if element.count == 0 || LINES.contains(&element.name.as_str()) || !element.properties.iter().any(is_list)
    {
        return Ok(());
    }
    let cause = format!(
        "the element {} has lists of vertex numbers, as faces have, but is not supported: convert it to an element 'face', or \
         remove it",
        quoted(&element.name)
    );
    Err(FormatError::line(element.line, cause))
}

#[cfg(test)]
mod tests;
