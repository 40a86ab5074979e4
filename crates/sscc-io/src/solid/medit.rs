//! Reader for Medit's `.mesh` files, text.

use glam::DVec3;
use sscc_solid::VolumeMesh;

use super::builder::Builder;
use super::volume_or_surface::VolumeOrSurface;
use super::words::Words;
use crate::FormatError;
use crate::error::quoted;

/// Supported versions of the format. They differ only in the width of binary numbers.
const VERSIONS: std::ops::RangeInclusive<i64> = 1..=4;

/// Beginnings of the names of unsupported solid elements, such as `TetrahedraP2` of higher order.
const UNSUPPORTED_ELEMENTS: [&str; 5] = ["Tetrahedra", "Hexahedra", "Prisms", "Pyramids", "Pentahedra"];

/// Beginnings of the names of faces of higher order, such as `TrianglesP2`.
const HIGHER_FACES: [&str; 2] = ["Triangles", "Quadrilaterals"];

/// Parses a Medit file: `MeshVersionFormatted` 1 to 4, `Dimension 3`, then sections in any order. `Vertices`,
/// `Tetrahedra`, `Hexahedra`, `Triangles` and `Quadrilaterals` are read, all others are skipped. Comments
/// (`#`) are skipped, and `End` may be missing.
///
/// Reference numbers of elements become names of materials, in order of first use. Those of vertices and faces are
/// skipped.
///
/// # Errors
/// When the version or dimension is not supported, a section is shorter than its count or repeated, solid elements have
/// another kind, or text follows `End`; else as [`read_volume_mesh`](super::read_volume_mesh).
pub fn parse(bytes: &[u8]) -> Result<VolumeMesh, FormatError> {
    parse_any(bytes)?.into_volume().map(|(mesh, _)| mesh)
}

/// As [`parse`], but for a file without tetrahedra and cubes returns the surface of its faces.
///
/// # Errors
/// As [`parse`]; when such a file has faces of higher order.
pub fn parse_any(bytes: &[u8]) -> Result<VolumeOrSurface, FormatError> {
    let mut words = Words::new(bytes, true)?;
    header(&mut words)?;
    let mut builder = Builder::new(1);
    let mut dimension = false;
    let mut seen = Vec::new();
    while let Some(keyword) = words.next_word()? {
        if seen.contains(&keyword) {
            return words.refused(format!("the section {keyword} is repeated"));
        }
        match keyword {
            "Dimension" => match words.integer("the dimension")? {
                3 => dimension = true,
                other => return words.refused(format!("dimension {other} is not supported, only 3")),
            },
            "Vertices" if !dimension => return words.refused("'Dimension 3' is missing before the vertices"),
            "Vertices" => vertices(&mut words, &mut builder)?,
            "Tetrahedra" => elements(&mut words, |words| {
                let (corners, material) = (corners(words)?, material(words, &mut builder)?);
                builder.tet(corners, material, words.place())
            })?,
            "Hexahedra" => elements(&mut words, |words| {
                let (corners, material) = (corners(words)?, material(words, &mut builder)?);
                builder.cube(corners, material, words.place())
            })?,
            "Triangles" => elements(&mut words, |words| face::<3>(words, &mut builder))?,
            "Quadrilaterals" => elements(&mut words, |words| face::<4>(words, &mut builder))?,
            "End" => match words.next_word()? {
                Some(_) => return words.refused("text follows 'End'"),
                None => break,
            },
            _ => {
                skip(keyword, &mut words, &mut builder)?;
                continue; // skipped sections may be repeated
            }
        }
        seen.push(keyword);
    }
    builder.finish_any()
}

fn header(words: &mut Words) -> Result<(), FormatError> {
    let magic = words.word("the header")?;
    if magic != "MeshVersionFormatted" {
        let cause = format!("a Medit file begins with 'MeshVersionFormatted', not {}", quoted(magic));
        return words.refused(cause);
    }
    let version = words.integer("the version")?;
    if !VERSIONS.contains(&version) {
        return words.refused(format!("version {version} of the format is not supported, only 1 to 4"));
    }
    Ok(())
}

fn vertices(words: &mut Words, builder: &mut Builder) -> Result<(), FormatError> {
    elements(words, |words| {
        let mut next = || words.number("the last vertex");
        let position = DVec3::new(next()?, next()?, next()?);
        next()?; // the reference number
        builder.vertex(position, words.place())
    })
}

/// Reads the items of a section, as many as its count. Nothing is allocated by the count.
fn elements(
    words: &mut Words,
    mut item: impl FnMut(&mut Words) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let count = words.count("the number of items in a section")?;
    (0..count).try_for_each(|_| item(words))
}

fn face<const N: usize>(words: &mut Words, builder: &mut Builder) -> Result<(), FormatError> {
    let corners = corners::<N>(words)?;
    words.integer("the reference number of a face")?;
    builder.face(corners, words.place())
}

fn material(words: &mut Words, builder: &mut Builder) -> Result<u32, FormatError> {
    let reference = words.integer("the reference number of an element")?;
    Ok(builder.material(&reference.to_string()))
}

/// Returns corners from 0; the file counts from 1.
fn corners<const N: usize>(words: &mut Words) -> Result<[u64; N], FormatError> {
    let mut corners = [0; N];
    for corner in &mut corners {
        *corner = match words.integer("the last element")? {
            index @ 1.. => index as u64 - 1,
            other => {
                return words
                    .refused(format!("the element names vertex {other}, but vertices are counted from 1"));
            }
        };
    }
    Ok(corners)
}

/// Skips an unsupported section, up to a word that begins with a letter.
fn skip(keyword: &str, words: &mut Words, builder: &mut Builder) -> Result<(), FormatError> {
    let is_name = |word: &str| word.starts_with(|c: char| c.is_ascii_alphabetic());
    if !is_name(keyword) {
        return words.refused(format!("the name of a section was expected, not {}", quoted(keyword)));
    }
    if UNSUPPORTED_ELEMENTS.iter().any(|name| keyword.starts_with(name)) && words.peek()? != Some("0") {
        let cause =
            format!("{} is not supported: only Tetrahedra and Hexahedra of first order are", quoted(keyword));
        return words.refused(cause);
    }
    let has_faces = HIGHER_FACES.iter().any(|start| keyword.starts_with(start));
    if has_faces && words.peek()? != Some("0") {
        builder.unread_faces(&quoted(keyword), words.place());
    }
    while words.peek()?.is_some_and(|word| !is_name(word)) {
        words.next_word()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETS: &str = "MeshVersionFormatted 2\n# a comment\nDimension\n3\nVertices 5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n\
        0 0 1 0\n1 1 1 0\nTriangles\n1\n1 2 3 9\nTetrahedra\n2\n1 2 3 4 7\n2 3 4 5 -1\nRidges 1\n1\nEnd\n";

    const CUBE: &str = "MeshVersionFormatted 1 Dimension 3 Hexahedra 1 1 2 3 4 5 6 7 8 0 Quadrilaterals 1 1 4 3 2 0 \
        Vertices 8 0 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 0 1 0 1 0 1 0 1 1 1 0 0 1 1 0 Tetrahedra 0";

    fn message(text: &str) -> String {
        parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn sections_are_read_in_any_order() {
        let mesh = parse(TETS.as_bytes()).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.vertices()[4]), (5, DVec3::ONE));
        assert_eq!((mesh.tets(), mesh.surface()), (&[[0, 1, 2, 3], [1, 2, 3, 4]][..], &[[0, 1, 2]][..]));
        let names: Vec<_> = mesh.materials().iter().map(|m| m.name.as_str()).collect();
        assert_eq!((names, mesh.element_material()), (vec!["7", "-1"], &[0, 1][..]));
        let mesh = parse(CUBE.as_bytes()).unwrap();
        assert_eq!(mesh.cubes(), [[0, 1, 2, 3, 4, 5, 6, 7]]);
        assert_eq!(mesh.vertices()[6], DVec3::ONE);
        assert_eq!(mesh.surface(), [[0, 3, 2], [0, 2, 1]]);
        assert_eq!(parse(TETS.replace('\n', "\r\n").as_bytes()).unwrap().vertices().len(), 5);
    }

    #[test]
    fn files_without_elements_are_surfaces() {
        let text = &TETS[..TETS.find("Tetrahedra").unwrap()];
        let surface = |text: &str| parse_any(text.as_bytes()).map(|found| found.into_surface().unwrap().0);
        let mesh = surface(text).unwrap();
        assert_eq!((mesh.rest_positions().len(), mesh.faces()), (5, &[[0, 1, 2]][..]));
        let refused = message(text);
        assert_eq!(
            refused,
            "the mesh has no elements: it is a surface of 1 triangles; add tetrahedra or hexahedra"
        );
        let higher = surface(&format!("{text}TrianglesP2 1\n1 2 3 4 5 1 0\n")).unwrap_err().to_string();
        assert!(higher.starts_with("line 14: 'TrianglesP2' is not supported"), "{higher}");
        assert!(surface(&format!("{text}TrianglesP2 0\n")).is_ok());
        assert_eq!(surface(TETS).unwrap().faces().len(), 6);
        assert_eq!(surface(&TETS.replace('\n', "\r")).unwrap(), surface(TETS).unwrap());
    }

    #[test]
    fn errors_name_the_line() {
        let with = |from, to| message(&TETS.replace(from, to));
        assert_eq!(message("OFF\n"), "line 1: a Medit file begins with 'MeshVersionFormatted', not 'OFF'");
        assert_eq!(with("ted 2", "ted 5"), "line 1: version 5 of the format is not supported, only 1 to 4");
        assert_eq!(with("\n3\nV", "\n2\nV"), "line 4: dimension 2 is not supported, only 3");
        assert_eq!(with("Dimension\n3\n", ""), "line 3: 'Dimension 3' is missing before the vertices");
        assert_eq!(with("1 0 0 0", "nan 0 0 0"), "line 7: 'nan' is not a finite number");
        assert_eq!(
            with("1 0 0 0", "2e60 0 0 0"),
            "line 7: a coordinate is not finite, or beyond 2^200: repair it, or change the unit"
        );
        assert_eq!(
            with("2 3 4 5 -1", "2 3 4 0 -1"),
            "line 17: the element names vertex 0, but vertices are counted from 1"
        );
        assert_eq!(
            with("2 3 4 5 -1", "2 3 4 6 -1"),
            "line 17: the element names vertex 6 (counted from 1), but there are 5"
        );
        assert_eq!(
            with("2 3 4 5 -1", "2 3 4 3 -1"),
            "line 17: the element names vertex 3 (counted from 1) twice"
        );
        assert_eq!(with("2 3 4 5 -1", "2 3 4 5 a"), "line 17: 'a' is not an integer");
        assert_eq!(with("Ridges", "Vertices"), "line 18: the section Vertices is repeated");
        assert_eq!(with("Ridges", "12"), "line 18: the name of a section was expected, not '12'");
        assert!(with("Ridges", "Prisms").starts_with("line 18: 'Prisms' is not supported: only Tetrahedra"));
        assert!(with("Ridges", "TetrahedraP2").contains("'TetrahedraP2' is not supported"));
        assert_eq!(with("End", "End\n7"), "line 21: text follows 'End'");
        assert!(with("Tetrahedra", "Edges").contains("the mesh has no elements"));
        assert!(with("Tetrahedra", "Edges").contains("a surface of 1 triangles"));
        assert_eq!(with("Vertices 5", "Vertices 99999999999"), "line 11: 'Triangles' is not a number");
        assert_eq!(
            message("MeshVersionFormatted 1\nDimension 3\nVertices 9"),
            "the file ends before the last vertex"
        );
    }

    #[test]
    fn truncations_are_rejected_or_complete() {
        let whole = parse(TETS.as_bytes()).unwrap();
        // The reader uses nothing after the last tetrahedron.
        let complete = TETS.find(" -1\n").unwrap() + 3;
        for len in 0..TETS.len() {
            match parse(&TETS.as_bytes()[..len]) {
                Ok(mesh) => assert!(len >= complete && mesh == whole, "{len}"),
                Err(_) => assert!(len < complete || len > complete + 1, "{len}"),
            }
        }
    }
}
