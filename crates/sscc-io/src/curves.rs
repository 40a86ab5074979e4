//! Writers for contact curves as polylines.

use std::fmt::Write;
use std::path::Path;

use sscc::parts::{ContactCurve, ContactCurves};

use crate::{IoError, write_whole};

/// Writes contact curves as OBJ: for each curve an object (`o`) with its points (`v`) and one polyline (`l`), which repeats
/// the first point of a closed curve. Comments state for each curve whether it is closed, its number of segments, and its
/// deepest pair of triangles. Positions (model unit) are written exactly.
///
/// # Errors
/// When a position is not finite, there are more than 2^31 - 1 points, or the file cannot be written.
pub fn write_obj_curves(path: &Path, found: &ContactCurves) -> Result<(), IoError> {
    check(path, found)?;
    write_whole(path, obj(found).as_bytes())
}

/// Writes contact curves as binary PLY: points as float64, and an element `edge` for each segment with its points
/// (`vertex1, vertex2`), its curve and its pair of triangles (`triangle1, triangle2`). The header has the comments of
/// [`write_obj_curves`].
///
/// # Errors
/// As [`write_obj_curves`].
pub fn write_ply_curves(path: &Path, found: &ContactCurves) -> Result<(), IoError> {
    check(path, found)?;
    write_whole(path, &ply(found))
}

fn check(path: &Path, found: &ContactCurves) -> Result<(), IoError> {
    let points = || found.curves.iter().flat_map(|curve| &curve.points);
    let cause = if i32::try_from(points().count()).is_err() {
        "the contact curves have more than 2147483647 points".to_owned()
    } else if let Some(point) = points().position(|point| !point.position.is_finite()) {
        format!("the position of point {point} (counted from 0) is not finite")
    } else {
        return Ok(());
    };
    Err(IoError::request(path, cause))
}

/// The comment of the whole file.
fn summary(found: &ContactCurves) -> String {
    format!(
        "contact curves: {}; not among them: {} with one common point, {} in one plane",
        found.curves.len(),
        counted(found.points.len(), "pair"),
        counted(found.polygons.len(), "pair")
    )
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The comment of a curve.
fn comment(found: &ContactCurves, number: usize, curve: &ContactCurve) -> String {
    let form = if curve.is_closed { "closed" } else { "open" };
    let contacts = curve.contacts.iter().map(|contact| &found.contacts[*contact as usize]);
    let deepest = contacts.max_by(|a, b| a.depth.total_cmp(&b.depth));
    let deepest = deepest.map(|contact| {
        let (i, j) = contact.pair;
        format!(", deepest pair {i} {j} ({:?})", contact.depth)
    });
    let segments = counted(curve.contacts.len(), "segment");
    format!("curve {number}: {form}, {segments}{}", deepest.unwrap_or_default())
}

fn obj(found: &ContactCurves) -> String {
    // Writing to a String never fails. `{:?}` prints the shortest decimal that parses to the same number.
    let mut text = String::new();
    let _ = writeln!(text, "# {}", summary(found));
    let mut next = 1;
    for (number, curve) in found.curves.iter().enumerate() {
        let _ = writeln!(text, "# {}\no curve{number}", comment(found, number, curve));
        for point in &curve.points {
            let p = point.position;
            let _ = writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
        }
        let end = next + curve.points.len();
        text.push('l');
        for vertex in (next..end).chain(curve.is_closed.then_some(next)) {
            let _ = write!(text, " {vertex}");
        }
        text.push('\n');
        next = end;
    }
    text
}

fn ply(found: &ContactCurves) -> Vec<u8> {
    let points: usize = found.curves.iter().map(|curve| curve.points.len()).sum();
    let segments: usize = found.curves.iter().map(|curve| curve.contacts.len()).sum();
    let mut header = format!("ply\nformat binary_little_endian 1.0\ncomment {}\n", summary(found));
    for (number, curve) in found.curves.iter().enumerate() {
        let _ = writeln!(header, "comment {}", comment(found, number, curve));
    }
    let _ = write!(
        header,
        "element vertex {points}\nproperty double x\nproperty double y\nproperty double z\nelement edge {segments}\n\
         property int vertex1\nproperty int vertex2\nproperty uint curve\nproperty uint triangle1\n\
         property uint triangle2\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    for point in found.curves.iter().flat_map(|curve| &curve.points) {
        bytes.extend(point.position.to_array().into_iter().flat_map(f64::to_le_bytes));
    }
    let mut first = 0;
    for (number, curve) in found.curves.iter().enumerate() {
        let count = curve.points.len();
        for (at, contact) in curve.contacts.iter().enumerate() {
            let (i, j) = found.contacts[*contact as usize].pair;
            // The last segment of a closed curve ends at its first point. Checked: the numbers fit an i32.
            let ends = [at, (at + 1) % count].map(|point| (first + point) as u32);
            bytes.extend([ends[0], ends[1], number as u32, i, j].into_iter().flat_map(u32::to_le_bytes));
        }
        first += count;
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use sscc::parts::contact_curves;

    /// A tetrahedron that pierces a large triangle: a closed curve of three segments; and two triangles that cross at an
    /// open curve of one segment, far away.
    fn curves() -> ContactCurves {
        let far = DVec3::X * 100.0;
        let positions = [
            DVec3::new(-8.0, -8.0, 0.1),
            DVec3::new(9.0, -8.0, 0.1),
            DVec3::new(0.0, 11.0, 0.1),
            DVec3::new(-1.0, -1.0, -1.0),
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(0.0, 1.0, -1.0),
            DVec3::new(0.1, 0.0, 1.0 / 3.0),
            far,
            far + DVec3::X,
            far + DVec3::Y,
            far + DVec3::new(0.25, 0.25, -1.0),
            far + DVec3::new(0.25, 0.25, 1.0),
            far + DVec3::new(0.25, 5.0, 1.0),
        ];
        let faces = [[0, 1, 2], [3, 4, 6], [4, 5, 6], [5, 3, 6], [7, 8, 9], [10, 11, 12]];
        contact_curves(&faces, &positions, &[(0, 1), (0, 2), (0, 3), (4, 5)]).unwrap()
    }

    /// Points and segments as read from a file.
    type Lines = (Vec<DVec3>, Vec<[usize; 2]>);

    fn expected(found: &ContactCurves) -> Lines {
        let (mut points, mut segments) = (Vec::new(), Vec::new());
        for curve in &found.curves {
            let first = points.len();
            points.extend(curve.points.iter().map(|point| point.position));
            let last = points.len() - 1;
            segments.extend((first..last).map(|at| [at, at + 1]));
            segments.extend(curve.is_closed.then_some([last, first]));
        }
        (points, segments)
    }

    fn read_obj(path: &Path) -> Lines {
        let text = std::fs::read_to_string(path).unwrap();
        let mut segments = Vec::new();
        for line in text.lines().filter_map(|line| line.strip_prefix("l ")) {
            let vertices: Vec<usize> =
                line.split(' ').map(|word| word.parse::<usize>().unwrap() - 1).collect();
            segments.extend(vertices.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        (crate::mesh::read_soup(path).unwrap().positions, segments)
    }

    #[test]
    fn curves_are_read_back() {
        let directory = tempfile::tempdir().unwrap();
        let (text, binary) = (directory.path().join("c.obj"), directory.path().join("c.ply"));
        let found = curves();
        assert_eq!(
            found.curves.iter().map(|curve| (curve.is_closed, curve.contacts.len())).collect::<Vec<_>>(),
            [(true, 3), (false, 1)]
        );
        write_obj_curves(&text, &found).unwrap();
        write_ply_curves(&binary, &found).unwrap();
        let (points, segments) = expected(&found);
        assert_eq!(read_obj(&text), (points.clone(), segments.clone()));

        assert_eq!(crate::mesh::read_soup(&binary).unwrap().positions, points);
        let bytes = std::fs::read(&binary).unwrap();
        let edges: Vec<[u32; 5]> = bytes[bytes.len() - 4 * 20..]
            .chunks_exact(20)
            .map(|row| std::array::from_fn(|i| u32::from_le_bytes(row[4 * i..][..4].try_into().unwrap())))
            .collect();
        for (edge, ends) in edges.iter().zip(&segments) {
            assert_eq!([edge[0] as usize, edge[1] as usize], *ends);
        }
        let mut pairs: Vec<_> = edges.iter().map(|edge| (edge[2], edge[3], edge[4])).collect();
        pairs.sort_unstable();
        assert_eq!(pairs, [(0, 0, 1), (0, 0, 2), (0, 0, 3), (1, 4, 5)]);
    }

    #[test]
    fn comments_describe_the_curves() {
        let found = curves();
        let deepest = found.contacts[..3].iter().max_by(|a, b| a.depth.total_cmp(&b.depth)).unwrap();
        let text = obj(&found);
        let comments: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("# ")).collect();
        assert_eq!(
            comments,
            [
                "contact curves: 2; not among them: 0 pairs with one common point, 0 pairs in one plane",
                &format!(
                    "curve 0: closed, 3 segments, deepest pair {} {} ({:?})",
                    deepest.pair.0, deepest.pair.1, deepest.depth
                ),
                &format!("curve 1: open, 1 segment, deepest pair 4 5 ({:?})", found.contacts[3].depth),
            ]
        );
        let header = String::from_utf8_lossy(&ply(&found)).into_owned();
        assert!(
            comments.iter().all(|comment| header.contains(&format!("\ncomment {comment}\n"))),
            "{header}"
        );
    }

    #[test]
    fn no_curves_give_a_valid_file_and_positions_that_are_not_finite_are_rejected() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("c.ply");
        write_ply_curves(&path, &ContactCurves::default()).unwrap();
        let text = String::from_utf8(std::fs::read(&path).unwrap()).unwrap();
        assert!(text.contains("element vertex 0\n") && text.ends_with("end_header\n"), "{text}");
        let mut found = curves();
        found.curves[1].points[0].position.y = f64::NAN;
        let message = write_obj_curves(&directory.path().join("d.obj"), &found).unwrap_err().to_string();
        assert!(
            message.ends_with("d.obj: the position of point 3 (counted from 0) is not finite"),
            "{message}"
        );
        assert!(!directory.path().join("d.obj").exists());
    }
}
