//! Reader for Wavefront OBJ files.
//!
//! The module has its own parser: general parsers renumber vertices by first use and drop unused ones, so that modes
//! for the `v` lines of the file no longer fit.

mod keywords;

use std::borrow::Cow;

use glam::DVec3;
use sscc::TriMesh;

use self::keywords::check_skipped;
use crate::error::quoted;
use crate::named_groups::{DEFAULT, GroupCollector, GroupsBy, NamedGroups, own_name};
use crate::polygons::{Polygons, Soup};
use crate::text::{Lines, decoded, number, split_word, without_comment};
use crate::{FormatError, Place};

/// Parses an OBJ file: `v` and `f` lines, and the older word `fo` for `f`. Other lines (normals, texture coordinates,
/// groups, materials, lines, points, curves) are skipped.
///
/// A weight or colour after `v x y z` is skipped. Corners in `f` lines have the form `a`, `a/b`, `a//c` or `a/b/c`, where
/// `a` counts from 1, or backwards from -1, the last vertex so far. A `v` or `f` line that ends in a backslash continues
/// on the next line. `#` begins a comment. Words that are no keywords of OBJ can be private extensions, and are skipped, too.
///
/// # Errors
/// When a line is malformed, an index is 0 or names no vertex, a face has fewer than 3 corners, there are no vertices or
/// no faces, or [`TriMesh::new`] rejects the mesh; when a line makes a free-form surface or calls another file, whose
/// faces would be missing; when a line begins with a malformed keyword of a vertex or face (`F`, `v:`, `f4`), or one after a
/// face with a vertex number.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, FormatError> {
    soup(bytes)?.into_mesh()
}

/// Parses the groups of an OBJ file's triangles. Names are those of the lines, without spaces at their ends; bytes that
/// are not UTF-8 are replaced. A `#` after the keyword belongs to the name (`Material #1`). A name in the form of the
/// numbers of unnamed parts of glTF files (`#0`) gets one more `#`.
///
/// # Errors
/// As [`parse`]; when there are more than 65,536 groups.
pub fn groups(bytes: &[u8], by: GroupsBy) -> Result<NamedGroups, FormatError> {
    let keyword: &[u8] = match by {
        GroupsBy::Group => b"g",
        GroupsBy::Object | GroupsBy::Mesh => b"o",
        GroupsBy::Material => b"usemtl",
    };
    let (mut collector, mut name) = (GroupCollector::default(), DEFAULT.to_owned());
    let soup = read(bytes, |found, arguments, triangles| {
        if found == keyword {
            collector.extend_to(triangles, &name)?;
            let next = String::from_utf8_lossy(arguments.trim_ascii());
            name = if next.is_empty() { DEFAULT.to_owned() } else { own_name(&next) };
        }
        Ok(())
    })?;
    collector.extend_to(soup.fans.len(), &name)?;
    soup.into_mesh()?;
    Ok(collector.finish())
}

pub(super) fn soup(bytes: &[u8]) -> Result<Soup, FormatError> {
    read(bytes, |_, _, _| Ok(()))
}

/// Reads `v` and `f` lines. `on_other` receives the keyword of each other line, the text after it with its comment, and
/// the number of triangles before it.
fn read(
    bytes: &[u8],
    mut on_other: impl FnMut(&[u8], &[u8], usize) -> Result<(), FormatError>,
) -> Result<Soup, FormatError> {
    let mut positions = Vec::new();
    let mut polygons = Polygons::new(1);
    let mut corners = Vec::new();
    // Whether a face was the last statement.
    let mut follows_face = false;
    let mut lines = Lines::new(bytes)?;
    while let Some((line, whole)) = lines.next() {
        let text = without_comment(whole).trim_ascii_end();
        let (keyword, _) = split_word(text.strip_suffix(b"\\").unwrap_or(text));
        match keyword {
            b"v" => {
                let statement = joined(text, &mut lines);
                positions.push(position(decoded(arguments(&statement), line)?, line)?);
            }
            b"f" | b"fo" => {
                let statement = joined(text, &mut lines);
                corners.clear();
                for word in decoded(arguments(&statement), line)?.split_ascii_whitespace() {
                    corners.push(corner(word, positions.len(), line)?);
                }
                polygons.push(&corners, Place::Line(line))?;
            }
            _ => {
                check_skipped(keyword, follows_face, line)?;
                let whole = whole.trim_ascii();
                let other = &whole.strip_suffix(b"\\").unwrap_or(whole)[keyword.len()..];
                // A number sign next to the keyword begins a comment.
                let other = if other.starts_with(b"#") { &[][..] } else { other };
                on_other(keyword, other, polygons.triangle_count())?;
            }
        }
        if !keyword.is_empty() {
            follows_face = matches!(keyword, b"f" | b"fo");
        }
    }
    polygons.finish(positions)
}

/// Returns a line with its continuation lines. Only `v` and `f` lines are joined: a comment or a path may end in a
/// backslash, and must not consume the next line.
fn joined<'a>(text: &'a [u8], lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let Some(start) = text.strip_suffix(b"\\") else {
        return Cow::Borrowed(text);
    };
    let mut all = start.to_vec();
    for (_, next) in lines {
        let next = without_comment(next).trim_ascii_end();
        all.push(b' ');
        match next.strip_suffix(b"\\") {
            Some(part) => all.extend(part),
            None => {
                all.extend(next);
                break;
            }
        }
    }
    Cow::Owned(all)
}

/// Returns the text after the keyword.
fn arguments(statement: &[u8]) -> &[u8] {
    split_word(statement).1
}

fn position(text: &str, line: usize) -> Result<DVec3, FormatError> {
    let mut values = [0.0; 3];
    let mut found = 0;
    for word in text.split_ascii_whitespace() {
        match values.get_mut(found) {
            Some(value) => *value = number(word, line)?,
            // Colours and weights are not used, and may be NaN.
            None if word.parse::<f64>().is_err() => _ = number(word, line)?,
            None => {}
        }
        found += 1;
    }
    // x y z, optionally followed by a weight, a colour, or both.
    if !matches!(found, 3 | 4 | 6 | 7) {
        let cause =
            format!("a vertex has 3 coordinates (with weight or colour 4, 6 or 7), this one has {found}");
        return Err(FormatError::line(line, cause));
    }
    Ok(DVec3::new(values[0], values[1], values[2]))
}

/// Returns the vertex of a corner, from 0. `vertices` is the number of vertices so far.
fn corner(word: &str, vertices: usize, line: usize) -> Result<u64, FormatError> {
    let refused = |cause: &str| Err(FormatError::line(line, format!("corner {}: {cause}", quoted(word))));
    let mut parts = word.split('/');
    let Some(Ok(index)) = parts.next().map(str::parse::<i64>) else {
        return refused("not a vertex number");
    };
    let mut others = 0;
    for part in parts {
        others += 1;
        if others > 2 || !(part.is_empty() || part.parse::<i64>().is_ok()) {
            return refused("not of the form a, a/b, a//c or a/b/c");
        }
    }
    match index {
        0 => refused("vertices are counted from 1"),
        1.. => Ok(index as u64 - 1),
        _ => match (vertices as u64).checked_sub(index.unsigned_abs()) {
            Some(vertex) => Ok(vertex),
            None => refused(&format!("only {vertices} vertices come before it")),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn faces(text: &str) -> Vec<[u32; 3]> {
        parse(format!("{SQUARE}{text}").as_bytes()).unwrap().faces().to_vec()
    }

    fn message(text: &str) -> String {
        parse(format!("{SQUARE}{text}").as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn all_forms_of_corners_are_read() {
        for line in ["f 1 2 3 4", "f 1/9 2/9 3/9 4/9", "f 1//7 2//7 3//7 4//7", "f 1/1/1 2/2/2 3/3/3 4/4/4"] {
            assert_eq!(faces(line), [[0, 1, 2], [0, 2, 3]], "{line}");
        }
        assert_eq!(faces("f -4 -3 -2\nf 4/-1 -4 3\n"), [[0, 1, 2], [3, 0, 2]]);
        assert_eq!(faces("f\t1 2   3 # comment\r\n"), [[0, 1, 2]]);
    }

    #[test]
    fn other_lines_are_skipped() {
        let text = b"# caf\xe9 C:\\dir\\\nmtllib \xff\\\nvn 0 0 1\nvt 0 0\nv 0 0 0 1\nv 1 0 0 .5 .5 .5\n\
            g a\nv 0 1 0\ns off\nl 1 2\nf 1 2 3";
        let mesh = parse(text).unwrap();
        assert_eq!((mesh.rest_positions().len(), mesh.faces()), (3, &[[0, 1, 2]][..]));
    }

    #[test]
    fn every_line_with_faces_is_read_or_refused() {
        assert_eq!(faces("f 1 2 3\nfo 1/1 3/3 \\\n 4\n"), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(message("fo 1 2"), "line 5: a face needs at least 3 corners, this one has 2");
        for keyword in ["surf", "bzp", "bsp", "cdp"] {
            let line = format!("f 1 2 3\n{keyword} 0 1 0 1 1 2 3 4\n");
            let cause = "free-form surfaces are not supported: convert them to polygons";
            assert_eq!(message(&line), format!("line 6: '{keyword}': {cause}"));
        }
        assert!(message("f 1 2 3\ncall more.obj 7\n").starts_with("line 6: 'call': other files"));
        assert!(message("csh cat more.obj\nf 1 2 3\n").starts_with("line 5: 'csh': other files"));
        // Curves have no faces.
        assert_eq!(faces("cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nend\nf 1 2 3\n"), [[0, 1, 2]]);
    }

    /// Two triangles that cross, the first as a face.
    const CROSSING: &str = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 2 1 1\nf 1 2 3\n";

    fn crossing(text: impl AsRef<[u8]>) -> Result<Vec<[u32; 3]>, String> {
        match parse(&[CROSSING.as_bytes(), text.as_ref()].concat()) {
            Ok(mesh) => Ok(mesh.faces().to_vec()),
            Err(error) => Err(error.to_string()),
        }
    }

    #[test]
    fn a_single_cr_ends_a_line_in_a_file_with_other_line_ends() {
        for before in
            ["usemtl red", "# note", "g b", "v 9 9 9 # c", "vn 0 0 1", "s off", "xyz_extension 1", ""]
        {
            let found = crossing(format!("{before}\rf 4 5 6\n"));
            assert_eq!(found.unwrap(), [[0, 1, 2], [3, 4, 5]], "{before}");
            let wrong = crossing(format!("{before}\rf 4 5 60\n")).unwrap_err();
            assert!(wrong.starts_with("line 9: the face names vertex 60"), "{before}: {wrong}");
        }
        // The reverse: LF in a file whose other lines end with CR.
        let text = format!("{}# note\nf 4 5 6", CROSSING.replace('\n', "\r"));
        assert_eq!(parse(text.as_bytes()).unwrap().faces(), [[0, 1, 2], [3, 4, 5]]);
        // Groups change at these lines.
        let text = format!("{CROSSING}usemtl red\rf 4 5 6\n");
        let found = groups(text.as_bytes(), GroupsBy::Material).unwrap();
        assert_eq!((found.names.join("|").as_str(), found.of_triangle), ("default|red", vec![0, 1]));
    }

    #[test]
    fn byte_order_marks_of_joined_files_are_skipped() {
        for text in ["\u{feff}f 4 5 6\n", "\u{feff}\u{feff}f 4 5 6\n", "\u{feff}# c\r\n\u{feff}f 4 5 6\n"] {
            assert_eq!(crossing(text).unwrap(), [[0, 1, 2], [3, 4, 5]], "{text:?}");
        }
        let refused = crossing(" \u{feff}f 4 5 6\n").unwrap_err();
        assert!(refused.starts_with("line 8: "), "{refused}");
        assert!(
            refused.ends_with("is not a keyword of OBJ: write 'f', or begin the line with '#'"),
            "{refused}"
        );
    }

    #[test]
    fn malformed_keywords_of_vertices_and_faces_are_refused() {
        let way_out = "or begin the line with '#'";
        for (text, word) in
            [("F 4 5 6", "f"), ("V 9 9 9\nf 4 5 6", "v"), ("Fo 4 5 6", "fo"), ("BZP 1 2", "bzp")]
        {
            let found = text.split(' ').next().unwrap();
            let cause = format!("line 8: '{found}' is not a keyword of OBJ: write '{word}', {way_out}");
            assert_eq!(crossing(text).unwrap_err(), cause);
        }
        for text in [
            "f\u{a0}4 5 6",
            "f\x0b4 5 6",
            "f\u{0}4 5 6",
            "f4 5 6",
            "f-3 -2 -1",
            "f:4 5 6",
            "\u{200b}f\u{a0}4 5 6",
        ] {
            let refused = crossing(format!("{text}\n")).unwrap_err();
            assert!(
                refused.starts_with("line 8: '") && refused.contains("write 'f' and a space, or"),
                "{refused}"
            );
        }
        assert!(crossing(b"f\xa04 5 6\n").unwrap_err().contains("write 'f' and a space"));
        assert!(crossing("v\u{a0}9 9 9\n").unwrap_err().contains("write 'v' and a space"));
        assert!(crossing("v9 9 9\n").unwrap_err().contains("write 'v' and a space"));
        // The groups are of the same triangles.
        let text = format!("{CROSSING}g a\nF 4 5 6\n");
        let refused = groups(text.as_bytes(), GroupsBy::Group).unwrap_err().to_string();
        assert!(refused.starts_with("line 9: 'F' is not a keyword"), "{refused}");
    }

    #[test]
    fn private_extensions_of_real_files_are_skipped() {
        for line in [
            "vc 1 0 0",
            "c 1.0 1.0 1.0",
            "xyz_weights 1 2",
            "v_color 1 1 1",
            "f_tag 7",
            "#MRGB ff0000",
            "VN 0 0 1",
            "vcolor 1",
            "Faces: 88",
            "version 2",
            "Ka 1 1 1",
            "newmtl red",
            "g f 4 5 6",
            "o V 1 2",
            "// F 4 5 6",
            "----",
            "l 1 2 \\\n3 4",
            "curv2 1 2 \\\n3",
            "fl\u{e4}che 1",
            "\u{a0}",
            "\x1a",
        ] {
            let found = crossing(format!("{line}\nf 4 5 6\n"));
            assert_eq!(found.unwrap(), [[0, 1, 2], [3, 4, 5]], "{line:?}");
        }
    }

    /// The corners would be missing in the face.
    #[test]
    fn corners_in_a_line_without_a_backslash_before_it_are_refused() {
        let refused = message("f 1 2 3\n4\n");
        assert!(
            refused.starts_with("line 6: '4' begins a line after a face: end the line before it"),
            "{refused}"
        );
        for text in [
            "f 1 2 3 \\\n# c\n4\n",
            "f 1 2 3 \\\n\n4\n",
            "f 1 2 3 \\\r\r\n4\n",
            "f 1 2 3\r\r4/4 1\n",
            "f 1 2 3\n-1",
        ] {
            assert!(message(text).contains("begins a line after a face"), "{text:?}");
        }
        assert_eq!(faces("f 1 2 3\n// 4\n3D\ng a\n4\n"), [[0, 1, 2]]);
    }

    #[test]
    fn concave_polygons_are_cut_at_their_notch() {
        // An arrow-shaped pentagon, and a triangle.
        let text = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3\nf 1 2 3 4 5\nf 3 4 5\n";
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.faces().len(), 5);
        assert_eq!((mesh.faces()[0], mesh.faces()[4]), ([0, 1, 2], [2, 3, 4]));
        let area = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|corner| mesh.rest_positions()[corner as usize]);
            (b - a).cross(c - a).z / 2.0
        };
        let areas: Vec<f64> = mesh.faces()[1..4].iter().map(|face| area(*face)).collect();
        assert!(areas.iter().all(|area| *area > 0.0) && areas.iter().sum::<f64>() == 10.0, "{areas:?}");
        let by_group = groups(text.replace("f 3", "g last\nf 3").as_bytes(), GroupsBy::Group).unwrap();
        assert_eq!(by_group.of_triangle, [0, 0, 0, 0, 1]);
    }

    #[test]
    fn lines_may_end_with_cr_alone() {
        let text = format!("{SQUARE}# a comment\nf 1 2 \\\n3\nf 1 3 5\n").replace('\n', "\r");
        assert_eq!(
            parse(text.as_bytes()).unwrap_err().to_string(),
            "line 8: the face names vertex 5 (counted from 1), but there are 4"
        );
        assert_eq!(parse(text.replace("3 5", "3 4").as_bytes()).unwrap().faces(), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn groups_follow_their_lines() {
        let lines = b"f 1 2 3\ng a\nusemtl red\nf 1 2 3 4\ng b\ng  b c \no x\nf 1 2 3\ng a\nf 2 3 4\ng\nusemtl \xff\n\
            f 1 3 4\no unused";
        let text = [SQUARE.as_bytes(), lines].concat();
        let of = |by| {
            let found = groups(&text, by).unwrap();
            (found.names.join("|"), found.of_triangle)
        };
        assert_eq!(of(GroupsBy::Group), ("default|a|b c".into(), vec![0, 1, 1, 2, 1, 0]));
        assert_eq!(of(GroupsBy::Object), ("default|x".into(), vec![0, 0, 0, 1, 1, 1]));
        assert_eq!(of(GroupsBy::Material), ("default|red|\u{fffd}".into(), vec![0, 1, 1, 1, 1, 2]));
        assert_eq!(
            groups(b"v 0 0 0\ng a\n", GroupsBy::Group).unwrap_err().to_string(),
            "the mesh has no triangles"
        );
        for len in 0..text.len() {
            let (cut, by) = (&text[..len], GroupsBy::Material);
            let triangles = parse(cut).map(|mesh| mesh.faces().len());
            assert_eq!(groups(cut, by).map(|found| found.of_triangle.len()), triangles);
        }
    }

    /// 3ds Max numbers materials so: cut names would be one group.
    #[test]
    fn names_may_have_number_signs() {
        let lines = "#g no\nusemtl Material #1\nf 1 2 3\nusemtl Material #2 \\\nf 1 3 4 # usemtl no\n \
            # usemtl no\nf 2 3 4\nusemtl #3\nf 1 2 4\nusemtl\nf 1 2 3\n";
        let found = groups(format!("{SQUARE}{lines}").as_bytes(), GroupsBy::Material).unwrap();
        assert_eq!(found.names, ["Material #1", "Material #2", "##3", "default"]);
        assert_eq!(found.of_triangle, [0, 1, 1, 2, 3]);
    }

    #[test]
    fn unused_vertices_are_kept_and_may_come_last() {
        let mesh = parse(b"v 9 9 9\nf 2 3 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
        assert_eq!(mesh.rest_positions()[0], DVec3::splat(9.0));
        assert_eq!(mesh.faces(), [[1, 2, 3]]);
    }

    #[test]
    fn backslash_continues_a_line() {
        assert_eq!(faces("f 1 \\\n2 \\ # comment\n 3\nf\\\n1 3 4"), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(faces("f 1 2 3\\\n"), [[0, 1, 2]]);
        // The statement after a continued line keeps its line number.
        assert!(message("f 1 2 \\\n3\nf 1 2\n").starts_with("line 7: "));
    }

    #[test]
    fn colours_and_weights_may_be_no_numbers() {
        let mesh = parse(b"v 0 0 0 nan nan nan\nv 1 0 0 inf\nv 0 1 0 1 nan 0 1e999\nf 1 2 3\n").unwrap();
        assert_eq!(mesh.rest_positions(), [DVec3::ZERO, DVec3::X, DVec3::Y]);
    }

    #[test]
    fn errors_name_the_line() {
        assert_eq!(message("f 1 2 0"), "line 5: corner '0': vertices are counted from 1");
        assert_eq!(message("f 1 2 5"), "line 5: the face names vertex 5 (counted from 1), but there are 4");
        assert_eq!(message("f 1 2 -5"), "line 5: corner '-5': only 4 vertices come before it");
        assert_eq!(message("f 1 2"), "line 5: a face needs at least 3 corners, this one has 2");
        assert_eq!(message("f"), "line 5: a face needs at least 3 corners, this one has 0");
        assert_eq!(
            message("v 1 2"),
            "line 5: a vertex has 3 coordinates (with weight or colour 4, 6 or 7), this one has 2"
        );
        assert_eq!(message("v 1 nan 2"), "line 5: 'nan' is not a finite number");
        assert_eq!(message("v 1 1e999 2"), "line 5: '1e999' is not a finite number");
        assert_eq!(message("v 1 x 2"), "line 5: 'x' is not a number");
        assert_eq!(message("v 1 2 3 x"), "line 5: 'x' is not a number");
        for line in ["f 1 2 3/a", "f 1 2 3/1/1/1", "f 1 2 x", "f 1 2 3.0", "f 1 2 99999999999999999999"] {
            assert!(message(line).starts_with("line 5: corner "), "{line}");
        }
        assert_eq!(message(""), "the mesh has no triangles");
        assert!(message("v 1e61 0 0\nf 1 2 3").contains("vertex 4 (counted from 0)"));
        assert_eq!(parse(b"hello").unwrap_err().to_string(), "the mesh has no vertices");
        assert_eq!(parse(b"v 1 \xff 2").unwrap_err().to_string(), "line 1: not UTF-8 text");
        assert!(message("f -9223372036854775808 1 2").contains("only 4"));
    }

    #[test]
    fn no_truncation_panics() {
        let text = format!("{SQUARE}f 1/1/1 2//2 3/3 \\\n -1\nf 1 2 3\n");
        for len in 0..text.len() {
            let _ = parse(&text.as_bytes()[..len]);
        }
    }
}
