//! Writers for a deformed pose as a mesh file, with its colliding triangles marked.

use std::fmt::Write;
use std::path::Path;

use glam::DVec3;
use sscc::TriMesh;

use crate::{IoError, write_whole};

/// Colour (RGB) of free triangles in a PLY file.
const FREE: [u8; 3] = [200, 200, 200];

/// Colour (RGB) of colliding triangles in a PLY file.
const COLLIDING: [u8; 3] = [220, 30, 30];

/// Writes a pose as OBJ: the triangles in the order of the mesh, in the groups `free` and `colliding` (a group can
/// occur several times). Positions (V, model unit) are written exactly.
///
/// # Errors
/// When the number of positions is not V or that of marks is not N, a position is not finite, or the file cannot be
/// written.
pub fn write_obj_pose(
    path: &Path,
    mesh: &TriMesh,
    positions: &[DVec3],
    colliding: &[bool],
) -> Result<(), IoError> {
    check_pose(path, mesh, positions, colliding)?;
    write_whole(path, obj(mesh, positions, colliding).as_bytes())
}

/// Writes a pose as binary PLY: positions as float64, and a colour per face, red for colliding triangles.
///
/// # Errors
/// As [`write_obj_pose`].
pub fn write_ply_pose(
    path: &Path,
    mesh: &TriMesh,
    positions: &[DVec3],
    colliding: &[bool],
) -> Result<(), IoError> {
    check_pose(path, mesh, positions, colliding)?;
    write_whole(path, &ply(mesh, positions, colliding))
}

pub(crate) fn check_pose(
    path: &Path,
    mesh: &TriMesh,
    positions: &[DVec3],
    colliding: &[bool],
) -> Result<(), IoError> {
    let (vertices, faces) = (mesh.rest_positions().len(), mesh.faces().len());
    let cause = if positions.len() != vertices {
        format!("there are {} positions for {vertices} vertices", positions.len())
    } else if colliding.len() != faces {
        format!("there are {} marks for {faces} triangles", colliding.len())
    } else if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
        format!("the position of vertex {vertex} (counted from 0) is not finite")
    } else {
        return Ok(());
    };
    Err(IoError::request(path, cause))
}

fn obj(mesh: &TriMesh, positions: &[DVec3], colliding: &[bool]) -> String {
    // Writing to a String never fails. `{:?}` prints the shortest decimal that parses to the same number, with an
    // exponent where that is shorter.
    let mut text = String::new();
    for p in positions {
        let _ = writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    let mut group = None;
    for ([a, b, c], collides) in mesh.faces().iter().zip(colliding) {
        if group != Some(collides) {
            group = Some(collides);
            let _ = writeln!(text, "g {}", if *collides { "colliding" } else { "free" });
        }
        let [a, b, c] = [a, b, c].map(|v| u64::from(*v) + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

fn ply(mesh: &TriMesh, positions: &[DVec3], colliding: &[bool]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nelement face {}\nproperty list uchar uint vertex_indices\nproperty uchar red\n\
         property uchar green\nproperty uchar blue\nend_header\n",
        positions.len(),
        mesh.faces().len()
    )
    .into_bytes();
    bytes.extend(positions.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
    for (corners, collides) in mesh.faces().iter().zip(colliding) {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(if *collides { COLLIDING } else { FREE });
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_mesh;
    use proptest::prelude::*;

    fn mesh() -> TriMesh {
        TriMesh::new(vec![DVec3::ZERO; 4], vec![[0, 1, 2], [1, 3, 2], [3, 0, 1], [2, 2, 0]]).unwrap()
    }

    const MARKS: [bool; 4] = [true, false, false, true];

    #[test]
    fn triangles_are_marked_in_their_order() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::new(0.1, -0.0, 1e-300), DVec3::splat(-1e60)];
        let text = obj(&mesh(), &positions, &MARKS);
        assert_eq!(
            text,
            "v 0.0 0.0 0.0\nv 1.0 0.0 0.0\nv 0.1 -0.0 1e-300\nv -1e60 -1e60 -1e60\ng colliding\nf 1 2 3\n\
             g free\nf 2 4 3\nf 4 1 2\ng colliding\nf 3 3 1\n"
        );
        let bytes = ply(&mesh(), &positions, &MARKS);
        let faces: Vec<_> = bytes[bytes.len() - 64..].chunks_exact(16).map(|row| &row[13..]).collect();
        assert_eq!(faces, [COLLIDING, FREE, FREE, COLLIDING]);
    }

    #[test]
    fn invalid_poses_are_rejected() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("pose.ply");
        let message = |positions: &[DVec3], marks: &[bool]| {
            write_obj_pose(&path, &mesh(), positions, marks).unwrap_err().to_string()
        };
        assert!(
            message(&[DVec3::ZERO; 3], &MARKS).ends_with("pose.ply: there are 3 positions for 4 vertices")
        );
        assert!(message(&[DVec3::ZERO; 4], &[true; 3]).ends_with("3 marks for 4 triangles"));
        assert!(message(&[DVec3::NAN; 4], &MARKS).ends_with("vertex 0 (counted from 0) is not finite"));
        assert!(write_ply_pose(&path, &mesh(), &[], &MARKS).is_err());
        assert!(!path.exists());
        write_ply_pose(&path, &mesh(), &[DVec3::ONE; 4], &MARKS).unwrap();
        assert_eq!(read_mesh(&path).unwrap().faces(), mesh().faces());
    }

    proptest! {
        #[test]
        fn positions_round_trip_bit_for_bit(values in prop::array::uniform12(-1e60..1e60), small in -1.0..1.0) {
            let mut values = values;
            values[5] = small;
            values[6] *= 1e-90;
            values[7] = -0.0;
            let positions: Vec<_> = values.as_chunks().0.iter().map(|p| DVec3::from_array(*p)).collect();
            let mesh = mesh();
            let text = obj(&mesh, &positions, &MARKS);
            for read in [
                crate::mesh::obj::parse(text.as_bytes()).unwrap(),
                crate::mesh::ply::parse(&ply(&mesh, &positions, &MARKS)).unwrap(),
            ] {
                let bits = |p: &[DVec3]| p.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
                prop_assert_eq!(bits(read.rest_positions()), bits(&positions));
                prop_assert_eq!(read.faces(), mesh.faces());
            }
        }
    }
}
