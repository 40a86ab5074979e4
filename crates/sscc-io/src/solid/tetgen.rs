//! Reader for TetGen's pair of files: `.node` with the vertices, `.ele` with the tetrahedra.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc_solid::VolumeMesh;

use super::builder::Builder;
use super::statements::{corners, fields, index, position, statements, value};
use crate::error::shown_name;
use crate::file::{ending, read_whole};
use crate::{FormatError, IoError, Place};

/// Vertices of a `.node` file.
#[derive(Clone, Debug, PartialEq)]
pub struct Nodes {
    positions: Vec<DVec3>,
    /// Number of the first vertex: 0 or 1.
    first: u64,
}

/// Reads a `.node` and a `.ele` file of the same name beside each other, with endings in any case; either may be given.
///
/// # Errors
/// When one of them is missing, cannot be read or is malformed; when the folder has two files that could be the other one.
pub fn read(path: &Path) -> Result<VolumeMesh, IoError> {
    let (nodes, elements) = match ending(path).as_str() {
        "ele" => (beside(path, "node")?, path.to_owned()),
        _ => (path.to_owned(), beside(path, "ele")?),
    };
    let vertices = parse_nodes(&read_whole(&nodes)?).map_err(|error| error.of(&nodes))?;
    parse(&vertices, &read_whole(&elements)?).map_err(|error| error.of(&elements))
}

/// Returns the path of the same name with another ending, in capitals if the given one is; in any case if only such a file
/// exists.
pub(crate) fn companion(path: &Path, other: &str) -> PathBuf {
    let capitals =
        path.extension().is_some_and(|e| e.to_string_lossy().bytes().all(|b| b.is_ascii_uppercase()));
    let usual = path.with_extension(if capitals { other.to_ascii_uppercase() } else { other.to_owned() });
    if usual.exists() {
        return usual;
    }
    companions(path, other).into_iter().next().unwrap_or(usual)
}

/// Returns the other file of a pair, which need not exist; None for other files.
pub(crate) fn other_of_pair(path: &Path) -> Option<PathBuf> {
    match ending(path).as_str() {
        "node" => Some(companion(path, "ele")),
        "ele" => Some(companion(path, "node")),
        _ => None,
    }
}

/// Returns the file of the same name with another ending, in any case.
///
/// # Errors
/// When there is none, or two of them.
fn beside(path: &Path, other: &str) -> Result<PathBuf, IoError> {
    // If the given file is missing, its reader reports it.
    if !path.exists() {
        return Ok(companion(path, other));
    }
    let refused = |cause: String| Err(IoError::request(path, cause));
    match &companions(path, other)[..] {
        [] => refused(format!("the .{other} file of the same name does not exist beside it")),
        [one] => Ok(one.clone()),
        [one, two, ..] => refused(format!(
            "two .{other} files of the same name are beside it, {} and {}: rename or remove one",
            shown_name(one),
            shown_name(two)
        )),
    }
}

/// Returns the existing files of the same name with another ending, in any case. Where the case of names does not count, all
/// spellings are one file.
fn companions(path: &Path, other: &str) -> Vec<PathBuf> {
    let mut known = BTreeSet::new();
    let is_new = |path: &PathBuf| fs::canonicalize(path).is_ok_and(|real| known.insert(real));
    spellings(other).map(|ending| path.with_extension(ending)).filter(is_new).collect()
}

/// Returns all spellings of a short ending in small letters and capitals.
fn spellings(ending: &str) -> impl Iterator<Item = String> {
    (0..1_u32 << ending.len()).map(move |capitals| {
        let is_capital = |at: usize| (capitals >> at) & 1 == 1;
        let letters = ending.chars().enumerate();
        letters.map(|(at, c)| if is_capital(at) { c.to_ascii_uppercase() } else { c }).collect::<String>()
    })
}

/// Parses a `.node` file: the number of vertices (then the dimension, the number of attributes, whether there are
/// markers), and a line for each vertex with its number and x, y, z. Attributes, markers and comments (`#`) are skipped.
/// Numbers are consecutive. The `.ele` file must use the same first number, 0 or 1.
///
/// # Errors
/// When the dimension is not 3, the number of lines differs from the header, the numbers are not consecutive, or a
/// coordinate is malformed or beyond [`sscc::limits`].
pub fn parse_nodes(bytes: &[u8]) -> Result<Nodes, FormatError> {
    let mut nodes = Nodes { positions: Vec::new(), first: 0 };
    table(bytes, "vertices", check_dimension, |number, text, line| {
        let at = |cause: String| FormatError::line(line, cause);
        let mut rest = fields(text).skip(1);
        let position = position(&mut rest).map_err(at)?;
        if nodes.positions.is_empty() {
            nodes.first = number;
        }
        if number != nodes.first + nodes.positions.len() as u64 || nodes.first > 1 {
            let expected = nodes.positions.len() as u64 + nodes.first.min(1);
            let cause = format!(
                "vertices are numbered from 0 or 1 without gaps: {expected} was expected, not {number}"
            );
            return Err(at(cause));
        }
        if !sscc::limits::contains(position) {
            return Err(at("a coordinate is larger than 2^200".into()));
        }
        nodes.positions.push(position);
        Ok(())
    })?;
    Ok(nodes)
}

/// Parses a `.ele` file for these vertices: the number of tetrahedra (then the number of corners, which must be 4, and
/// whether there is an attribute), and a line for each with its number, its corners, and the optional attribute. The
/// attribute becomes the name of the material.
///
/// # Errors
/// When elements have another number of nodes than 4, the number of lines differs from the header, or a declared
/// attribute is missing; else as [`read_volume_mesh`](super::read_volume_mesh).
pub fn parse(nodes: &Nodes, bytes: &[u8]) -> Result<VolumeMesh, FormatError> {
    let mut builder = Builder::new(nodes.first);
    for position in &nodes.positions {
        builder.vertex(*position, Place::Whole)?;
    }
    let header = |header: &[u64]| match header.get(1).copied().unwrap_or(4) {
        4 => Ok(header.get(2).is_some_and(|attributes| *attributes > 0)),
        other => Err(format!("tetrahedra of {other} nodes are not supported: only 4 are")),
    };
    table(bytes, "tetrahedra", header, |_, text, line| {
        let at = |cause: String| FormatError::line(line, cause);
        let mut rest = fields(text).skip(1);
        let mut corners = corners::<4>(&mut rest).map_err(at)?;
        for corner in &mut corners {
            *corner = corner
                .checked_sub(nodes.first)
                .ok_or_else(|| at("the element names vertex 0, but vertices are counted from 1".into()))?;
        }
        let material = match rest.next() {
            Some(attribute) => builder.material(&value(attribute).map_err(at)?.to_string()),
            None => builder.default_material(),
        };
        builder.tet(corners, material, Place::Line(line))
    })?;
    builder.finish()
}

fn check_dimension(header: &[u64]) -> Result<bool, String> {
    match header.get(1) {
        None | Some(3) => Ok(false),
        Some(other) => Err(format!("vertices of dimension {other} are not supported: only 3 is")),
    }
}

/// Parses a header that begins with a count, and as many lines that begin with a number. `check` receives the numbers of
/// the header and returns whether each line ends with an attribute. `item` receives number, text and line.
fn table(
    bytes: &[u8],
    what: &str,
    check: impl FnOnce(&[u64]) -> Result<bool, String>,
    mut item: impl FnMut(u64, &str, usize) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let mut lines = statements(bytes)?;
    let Some(header) = lines.next() else {
        return Err(FormatError::whole("the file ends before the header"));
    };
    let (first_line, text) = header?;
    let at_header = |cause: String| FormatError::line(first_line, cause);
    // The header has at most four numbers.
    let header: Vec<u64> = fields(text).take(4).map(index).collect::<Result<_, _>>().map_err(at_header)?;
    let declared = header.first().copied().unwrap_or_default();
    let attributes = check(&header).map_err(at_header)?;
    let mut found = 0;
    for line in lines {
        let (line, text) = line?;
        if found == declared {
            let cause = format!("the file has more lines than the {declared} {what} of the header");
            return Err(FormatError::line(line, cause));
        }
        let number = index(fields(text).next().unwrap_or_default());
        let number = number.map_err(|cause| FormatError::line(line, cause))?;
        if attributes && fields(text).nth(5).is_none() {
            return Err(FormatError::line(line, "the attribute that the header declares is missing"));
        }
        item(number, text, line)?;
        found += 1;
    }
    if found < declared {
        return Err(at_header(format!("the file has {found} of the {declared} {what} declared here")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODE: &str =
        "# nodes\n5 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1\n3 0 1 0 0.5 1\n4 0 0 1 0.5 1\n5 1 1 1 0.5 0\n";
    const ELE: &str = "2  4  1\n  1  1 2 3 4  10\n  2  2 3 4 5  20\n# Generated\n";

    fn both(node: &str, ele: &str) -> Result<VolumeMesh, String> {
        let nodes = parse_nodes(node.as_bytes()).map_err(|error| format!("node {error}"))?;
        parse(&nodes, ele.as_bytes()).map_err(|error| format!("ele {error}"))
    }

    #[test]
    fn the_first_number_is_0_or_1() {
        let mesh = both(NODE, ELE).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.tets()), (5, &[[0, 1, 2, 3], [1, 2, 3, 4]][..]));
        assert_eq!((mesh.materials()[1].name.as_str(), mesh.element_material()), ("20", &[0, 1][..]));
        let from_0 = both("4\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "1 4 0\n0 0 1 2 3\n").unwrap();
        assert_eq!((from_0.tets()[0], from_0.materials()[0].name.as_str()), ([0, 1, 2, 3], "default"));
    }

    #[test]
    fn errors_name_the_line() {
        let node = |from, to| both(&NODE.replace(from, to), ELE).unwrap_err();
        let ele = |from, to| both(NODE, &ELE.replace(from, to)).unwrap_err();
        assert_eq!(
            node("5 3 1", "5 2 1"),
            "node line 2: vertices of dimension 2 are not supported: only 3 is"
        );
        assert_eq!(node("5 3 1", "6 3 1"), "node line 2: the file has 5 of the 6 vertices declared here");
        assert_eq!(
            node("5 3 1", "4 3 1"),
            "node line 7: the file has more lines than the 4 vertices of the header"
        );
        let gaps = "vertices are numbered from 0 or 1 without gaps:";
        assert_eq!(node("4 0 0 1", "9 0 0 1"), format!("node line 6: {gaps} 4 was expected, not 9"));
        assert_eq!(node("\n1 0 0 0", "\n2 0 0 0"), format!("node line 3: {gaps} 1 was expected, not 2"));
        assert_eq!(node("4 0 0 1", "4 0 0 inf"), "node line 6: 'inf' is not a finite number");
        assert_eq!(node("4 0 0 1", "4 0 0 1e61"), "node line 6: a coordinate is larger than 2^200");
        assert_eq!(node("4 0 0 1 0.5 1", "4 0 0"), "node line 6: a vertex has a number and 3 coordinates");
        assert_eq!(
            ele("2  4  1", "2 10 1"),
            "ele line 1: tetrahedra of 10 nodes are not supported: only 4 are"
        );
        assert_eq!(
            ele("5  20", "6 20"),
            "ele line 3: the element names vertex 6 (counted from 1), but there are 5"
        );
        assert_eq!(
            ele("5  20", "0 20"),
            "ele line 3: the element names vertex 0, but vertices are counted from 1"
        );
        assert_eq!(ele("5  20", "4 20"), "ele line 3: the element names vertex 4 (counted from 1) twice");
        assert_eq!(ele("5  20", "-1 20"), "ele line 3: '-1' is not a number of a vertex or element");
        assert_eq!(ele("5  20", "5"), "ele line 3: the attribute that the header declares is missing");
        assert_eq!(ele("5  20", "5 x"), "ele line 3: 'x' is not a number");
        let all = u64::MAX;
        assert!(
            ele("2  4", &format!("{all} 4")).contains(&format!("2 of the {all} tetrahedra declared here"))
        );
        assert_eq!(both("# nothing\n", ELE).unwrap_err(), "node the file ends before the header");
        assert_eq!(both("0\n", "0\n").unwrap_err(), "ele the mesh has no vertices");
    }

    #[test]
    fn every_truncation_is_rejected() {
        // The parser ignores the end of the last line.
        for len in 0..NODE.len() - " 0.5 0\n".len() {
            assert!(both(&NODE[..len], ELE).is_err(), "{len}");
        }
        for len in 0..ELE.find("20").unwrap() {
            assert!(both(NODE, &ELE[..len]).is_err(), "{len}");
        }
    }

    #[test]
    fn either_file_of_the_pair_can_be_given() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        std::fs::write(path("a.1.node"), NODE).unwrap();
        let missing = read(&path("a.1.node")).unwrap_err().to_string();
        assert!(missing.ends_with("a.1.node: the .ele file of the same name does not exist beside it"));
        std::fs::write(path("a.1.ele"), ELE.replace("5  20", "6 20")).unwrap();
        assert!(
            read(&path("a.1.node"))
                .unwrap_err()
                .to_string()
                .contains("a.1.ele: line 3: the element names vertex 6")
        );
        std::fs::write(path("a.1.ele"), ELE).unwrap();
        let mesh = read(&path("a.1.node")).unwrap();
        assert_eq!((read(&path("a.1.ele")).unwrap(), mesh.tets().len()), (mesh.clone(), 2));
        std::fs::write(path("B.NODE"), NODE).unwrap();
        std::fs::write(path("B.ELE"), ELE).unwrap();
        assert_eq!(read(&path("B.ELE")).unwrap(), mesh);
        assert!(read(&path("c.ele")).unwrap_err().to_string().contains("not found"));
    }

    #[test]
    fn endings_of_a_pair_may_be_in_any_case() {
        for [node, ele] in
            [["a.NODE", "a.ele"], ["A.Node", "A.ele"], ["a.node", "a.ELE"], ["b.nODe", "b.eLE"]]
        {
            let directory = tempfile::tempdir().unwrap();
            let [node, ele] = [node, ele].map(|name| directory.path().join(name));
            std::fs::write(&node, NODE).unwrap();
            for (given, other) in [(&node, "ele"), (&ele, "node")] {
                let missing = read(given).unwrap_err().to_string();
                let cause = format!("the .{other} file of the same name does not exist beside it");
                assert!(missing.ends_with(&cause) || missing.contains("not found"), "{missing}");
            }
            std::fs::write(&ele, ELE).unwrap();
            assert_eq!(read(&node).unwrap(), both(NODE, ELE).unwrap(), "{}", node.display());
            assert_eq!(read(&ele).unwrap(), both(NODE, ELE).unwrap(), "{}", ele.display());
            // A data set lists a pair once, because it finds the vertices beside the elements.
            assert!(companion(&ele, "node").is_file() && other_of_pair(&node).unwrap().is_file());
        }
    }

    #[test]
    fn two_files_that_could_be_the_other_one_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        for name in ["a.node", "a.NODE", "a.Ele"] {
            std::fs::write(path(name), if name == "a.Ele" { ELE } else { NODE }).unwrap();
        }
        if std::fs::read_dir(directory.path()).unwrap().count() < 3 {
            return; // the case of names does not count here
        }
        let message = read(&path("a.Ele")).unwrap_err().to_string();
        let cause =
            "a.Ele: two .node files of the same name are beside it, a.node and a.NODE: rename or remove one";
        assert!(message.ends_with(cause), "{message}");
        // If the vertices are named, they are known.
        assert_eq!(read(&path("a.NODE")).unwrap().tets().len(), 2);
        std::fs::write(path("a.ELE"), ELE).unwrap();
        let message = read(&path("a.node")).unwrap_err().to_string();
        assert!(
            message.contains("two .ele files of the same name are beside it, a.Ele and a.ELE"),
            "{message}"
        );
    }
}
