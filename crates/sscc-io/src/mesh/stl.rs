//! Reader for stereolithography files (STL), binary and text.
//!
//! STL has no shared vertices: corner `c` of triangle `t` becomes vertex `3 t + c`. So meshes have split vertices
//! ([`TriMesh::with_split_vertices`]): those of equal position are welded by default.
//!
//! The module has its own parser: it names the places of errors, and the crate `stl_io` welds equal vertices. Many
//! binary files begin with `solid`, so the size decides between the forms.

mod not_binary;
mod text;
mod words;

use glam::DVec3;
use sscc::TriMesh;

use self::words::Words;
use crate::polygons::Soup;
use crate::{FormatError, Place};

/// Size of free text and count before the triangles of a binary file.
const HEADER: usize = 84;

/// Size of one triangle: normal, three corners (f32 each) and two attribute bytes.
const TRIANGLE: usize = 50;

/// Parses an STL file. The file is binary if its size is 84 + 50 n for its count n of triangles, else text if it begins
/// with `solid` and has no zero byte among the first 1,024. Normals, attribute bytes and names of solids are skipped.
///
/// A text file consists of words between white space, and can have several solids. The name after `solid` and `endsolid`, which
/// may have any words, reaches to the end of its line, or to a facet in that line.
///
/// Programs that do not follow the format write binary files of other sizes. These are read, too: data of the length that
/// the attribute bytes declare after each triangle; fewer than 50 further bytes at the end; a count of 0 before whole
/// triangles.
///
/// # Errors
/// When the size of a binary file does not match its count, except in these cases; when a text file has unknown
/// statements or facets without exactly 3 corners, or ends early; when [`TriMesh::new`] rejects the mesh.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, FormatError> {
    soup(bytes)?.into_mesh()
}

pub(super) fn soup(bytes: &[u8]) -> Result<Soup, FormatError> {
    let (positions, warning) = match binary(bytes) {
        Err(_) if is_text(bytes) => (text::parse(bytes)?, None),
        Err(error) => return Err(not_binary::cause(bytes).unwrap_or(error)),
        Ok(read) => read,
    };
    let Ok(vertices) = u32::try_from(positions.len()) else {
        return Err(FormatError::whole(format!(
            "the mesh has {} vertices: 32-bit indices allow at most 2^32 - 1",
            positions.len()
        )));
    };
    let faces = (0..vertices / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let warnings = warning.into_iter().collect();
    Ok(Soup { warnings, has_split_vertices: true, ..Soup::of_triangles(positions, faces) })
}

fn is_text(bytes: &[u8]) -> bool {
    let begins_with_solid = Words::new(bytes).next_word().is_some_and(|word| word.is("solid"));
    begins_with_solid && !bytes.iter().take(1024).any(|b| *b == 0)
}

/// Parses a binary file; returns three corners for each triangle, and a warning.
fn binary(bytes: &[u8]) -> Result<(Vec<DVec3>, Option<String>), FormatError> {
    let Some((header, body)) = bytes.split_first_chunk::<HEADER>() else {
        let cause = "not an STL file: it is shorter than a binary header, and does not begin with 'solid'";
        return Err(FormatError::whole(cause));
    };
    let count = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    let size = u64::from(count) * TRIANGLE as u64;
    let found = body.len() as u64;
    let (whole, rest) = body.as_chunks::<TRIANGLE>();
    if size == found {
        return Ok((corners(whole), None));
    }
    if size > found || count == 0 && !rest.is_empty() {
        let cause = format!(
            "the header declares {count} triangles ({size} bytes), but {found} bytes follow: is the file cut off?"
        );
        return Err(FormatError::new(Place::Byte(80), cause));
    }
    if count == 0 {
        let warning = format!(
            "the header declares 0 triangles, but data of {} follow, which are read: was the file not finished?",
            whole.len()
        );
        return Ok((corners(whole), Some(warning)));
    }
    if let Some(triangles) = with_attributes(body, count) {
        return Ok((corners(&triangles), None));
    }
    let more = found - size;
    if more < TRIANGLE as u64 {
        let warning = format!("{more} bytes after the last of the {count} triangles are skipped");
        return Ok((corners(&whole[..count as usize]), Some(warning)));
    }
    let cause = format!(
        "{more} bytes follow the {count} triangles that the header declares, which could be more triangles: correct the \
         count at byte 80, or remove these bytes"
    );
    Err(FormatError::new(Place::Byte(HEADER + size as usize), cause))
}

/// Returns the triangles if each is followed by as many bytes as its two attribute bytes declare, up to the end.
fn with_attributes(body: &[u8], count: u32) -> Option<Vec<[u8; TRIANGLE]>> {
    let (mut triangles, mut rest) = (Vec::new(), body);
    for _ in 0..count {
        let (triangle, after) = rest.split_first_chunk::<TRIANGLE>()?;
        let attributes = u16::from_le_bytes([triangle[48], triangle[49]]);
        rest = after.get(usize::from(attributes)..)?;
        triangles.push(*triangle);
    }
    rest.is_empty().then_some(triangles)
}

/// Returns the corners of triangles.
fn corners(triangles: &[[u8; TRIANGLE]]) -> Vec<DVec3> {
    let corner = |bytes: &[u8; 12]| {
        let [x, y, z] = [0, 4, 8].map(|at| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        DVec3::from_array([x, y, z].map(|axis| f32::from_le_bytes(axis).into()))
    };
    triangles.iter().flat_map(|t| t[12..48].as_chunks().0).map(corner).collect()
}

#[cfg(test)]
mod tests;
