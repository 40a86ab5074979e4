//! Reader for the Object File Format (OFF), text.

use glam::DVec3;
use sscc::TriMesh;

use crate::error::quoted;
use crate::polygons::{Polygons, Soup};
use crate::text::{Lines, count, decoded, number, without_comment};
use crate::{FormatError, Place};

/// Parses an OFF file: the word `OFF`, the counts of vertices, faces and edges (on the same line or the next), one line
/// for each vertex, and one for each face (`n i_1 .. i_n`, from 0). Comments (`#`), colours, and the normals and texture
/// coordinates of the variants `[ST][C][N]OFF` are skipped. The blank between `OFF` and the counts may be missing.
///
/// # Errors
/// When the file is binary or has another dimension (`4OFF`, `nOFF`), the number of lines differs from the counts, a line
/// is malformed, a face has fewer than 3 corners, an index names no vertex, or [`TriMesh::new`] rejects the mesh.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, FormatError> {
    soup(bytes)?.into_mesh()
}

pub(super) fn soup(bytes: &[u8]) -> Result<Soup, FormatError> {
    let mut lines = Statements(Lines::new(bytes)?);
    let (line, header) = lines.required("the header")?;
    let mut words = header.split_ascii_whitespace();
    let magic = words.next().unwrap_or_default();
    let (magic, count) = magic.split_at(magic.trim_end_matches(|c: char| c.is_ascii_digit()).len());
    check_magic(if magic.is_empty() { count } else { magic }, line)?;
    // Some files have no blank between the word and the first count.
    let first = Some(count).filter(|count| !count.is_empty());
    let mut words = first.into_iter().chain(words).peekable();
    let (line, [vertices, faces]) = if words.peek().is_some() {
        (line, counts(words, line)?)
    } else {
        let (line, text) = lines.required("the counts")?;
        (line, counts(text.split_ascii_whitespace(), line)?)
    };
    // The counts give the number of lines that follow. They do not determine an allocation.
    let mut positions = Vec::new();
    for done in 0..vertices {
        let (line, text) = lines.next_item("vertices", done, vertices, line)?;
        positions.push(position(text, line)?);
    }
    let mut polygons = Polygons::new(0);
    for done in 0..faces {
        let (line, text) = lines.next_item("faces", done, faces, line)?;
        polygons.push(&corners(text, line)?, Place::Line(line))?;
    }
    if let Some(extra) = lines.next() {
        let cause =
            format!("the file has more lines than the {vertices} vertices and {faces} faces of the header");
        return Err(FormatError::line(extra?.0, cause));
    }
    polygons.finish(positions)
}

/// Lines without comments and blank lines.
struct Statements<'a>(Lines<'a>);

impl<'a> Iterator for Statements<'a> {
    type Item = Result<(usize, &'a str), FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        let (line, text) = self
            .0
            .by_ref()
            .map(|(line, text)| (line, without_comment(text).trim_ascii()))
            .find(|l| !l.1.is_empty())?;
        Some(decoded(text, line).map(|text| (line, text)))
    }
}

impl<'a> Statements<'a> {
    fn required(&mut self, what: &str) -> Result<(usize, &'a str), FormatError> {
        self.next().unwrap_or_else(|| Err(FormatError::whole(format!("the file ends before {what}"))))
    }

    fn next_item(
        &mut self,
        what: &str,
        done: usize,
        all: usize,
        header: usize,
    ) -> Result<(usize, &'a str), FormatError> {
        self.next().unwrap_or_else(|| {
            Err(FormatError::line(header, format!("the file has {done} of the {all} {what} declared here")))
        })
    }
}

fn check_magic(word: &str, line: usize) -> Result<(), FormatError> {
    let Some(variant) = word.strip_suffix("OFF") else {
        return Err(FormatError::line(line, format!("an OFF file begins with 'OFF', not {}", quoted(word))));
    };
    let rest = variant.strip_prefix("ST").unwrap_or(variant);
    let rest = rest.strip_prefix('C').unwrap_or(rest);
    if rest.strip_prefix('N').unwrap_or(rest).is_empty() {
        return Ok(());
    }
    Err(FormatError::line(line, format!("the OFF variant {} is not supported", quoted(word))))
}

/// Parses the counts of vertices and faces. The count of edges is unused and may be missing.
fn counts<'a>(mut words: impl Iterator<Item = &'a str>, line: usize) -> Result<[usize; 2], FormatError> {
    let mut next = || match words.next() {
        Some("BINARY") => Err(FormatError::line(line, "binary OFF is not supported: save it as text")),
        Some(word) => count(word, line),
        None => Err(FormatError::line(line, "the counts of vertices and faces are missing")),
    };
    Ok([next()?, next()?])
}

fn position(text: &str, line: usize) -> Result<DVec3, FormatError> {
    let mut words = text.split_ascii_whitespace();
    let mut next = || match words.next() {
        Some(word) => number(word, line),
        None => Err(FormatError::line(line, "a vertex has 3 coordinates")),
    };
    Ok(DVec3::new(next()?, next()?, next()?))
}

fn corners(text: &str, line: usize) -> Result<Vec<u64>, FormatError> {
    let mut words = text.split_ascii_whitespace();
    let declared = count(words.next().unwrap_or_default(), line)?;
    let mut corners = Vec::new();
    for word in words.take(declared) {
        corners.push(count(word, line)? as u64);
    }
    if corners.len() < declared {
        let cause =
            format!("the face declares {declared} corners, but only {} numbers follow", corners.len());
        return Err(FormatError::line(line, cause));
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "OFF # a comment\n4 1 0\n0 0 0\n1 0 0\n\n# another\n1 1 0\n0 1 0\n4 0 1 2 3\n";

    fn message(text: &str) -> String {
        parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn variants_are_read() {
        let square = parse(SQUARE.as_bytes()).unwrap();
        assert_eq!(square.faces(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(parse(SQUARE.replace("OFF # a comment\n", "OFF ").as_bytes()).unwrap(), square);
        assert_eq!(parse(SQUARE.replace("OFF # a comment\n", "OFF").as_bytes()).unwrap(), square);
        assert_eq!(parse(SQUARE.replace("OFF # a comment\n4 1 0", "COFF4 1").as_bytes()).unwrap(), square);
        assert_eq!(parse(SQUARE.replace('\n', "\r").as_bytes()).unwrap(), square);
        let coloured = SQUARE.replace("OFF #", "COFF #").replace("1 0 0\n", "1 0 0 255 0 0 255\n");
        assert_eq!(parse(coloured.as_bytes()).unwrap(), square);
        assert_eq!(parse(SQUARE.replace("2 3\n", "2 3 0.5 0.5 0.5").as_bytes()).unwrap(), square);
        assert_eq!(parse(SQUARE.replace('\n', "\r\n").as_bytes()).unwrap(), square);
    }

    #[test]
    fn errors_name_the_line() {
        assert_eq!(message("PLY\n"), "line 1: an OFF file begins with 'OFF', not 'PLY'");
        assert_eq!(message("4OFF\n"), "line 1: the OFF variant '4OFF' is not supported");
        assert_eq!(message("4OFF6 2 0\n"), "line 1: the OFF variant '4OFF' is not supported");
        assert_eq!(message("OFFx 2 0\n"), "line 1: an OFF file begins with 'OFF', not 'OFFx'");
        assert_eq!(message("OFF BINARY\n"), "line 1: binary OFF is not supported: save it as text");
        assert_eq!(message("OFF\n"), "the file ends before the counts");
        assert_eq!(message("OFF\n3 x 0\n"), "line 2: 'x' is not a count");
        assert_eq!(message("OFF\n-3 1 0\n"), "line 2: '-3' is not a count");
        assert_eq!(message("OFF\n3\n"), "line 2: the counts of vertices and faces are missing");
        assert_eq!(
            message("OFF\n99999999999 1 0\n0 0 0\n"),
            "line 2: the file has 1 of the 99999999999 vertices declared here"
        );
        let with = |from, to| message(&SQUARE.replace(from, to));
        assert_eq!(with("4 1 0\n", "4 2 0\n"), "line 2: the file has 1 of the 2 faces declared here");
        assert_eq!(with("1 1 0\n", "1 inf 0\n"), "line 7: 'inf' is not a finite number");
        assert_eq!(with("1 1 0\n", "1 1\n"), "line 7: a vertex has 3 coordinates");
        assert_eq!(
            with("4 0 1 2 3", "5 0 1 2 3"),
            "line 9: the face declares 5 corners, but only 4 numbers follow"
        );
        assert_eq!(
            with("4 0 1 2 3", "4 0 1 2 4"),
            "line 9: the face names vertex 4 (counted from 0), but there are 4"
        );
        assert_eq!(with("4 0 1 2 3", "4 0 1 2 -1"), "line 9: '-1' is not a count");
        assert_eq!(with("4 0 1 2 3", "2 0 1"), "line 9: a face needs at least 3 corners, this one has 2");
        assert_eq!(
            with("4 0 1 2 3", "9999999999999 0 1"),
            "line 9: the face declares 9999999999999 corners, but only 2 numbers follow"
        );
        assert_eq!(
            with("2 3\n", "2 3\n7"),
            "line 10: the file has more lines than the 4 vertices and 1 faces of the header"
        );
    }

    #[test]
    fn every_truncation_is_rejected() {
        // Beyond the last corner, only the end of the line is missing.
        for len in 0..SQUARE.len() - 2 {
            assert!(parse(&SQUARE.as_bytes()[..len]).is_err(), "{len}");
        }
    }
}
