//! Writer for VTK: a pose as `.vtu`.

use std::path::Path;

use glam::DVec3;
use sscc::TriMesh;

use crate::pose::check_pose;
use crate::{IoError, write_whole};

/// VTK's type of a triangle.
const TRIANGLE: u8 = 5;

/// Writes a pose as an unstructured grid of triangles: positions as Float64, and the cell data `colliding`, 1 for
/// colliding triangles and 0 for others.
///
/// # Errors
/// As [`write_obj_pose`](crate::write_obj_pose).
pub fn write_vtu_pose(
    path: &Path,
    mesh: &TriMesh,
    positions: &[DVec3],
    colliding: &[bool],
) -> Result<(), IoError> {
    check_pose(path, mesh, positions, colliding)?;
    write_whole(path, &vtu(mesh, positions, colliding))
}

/// Returns the file. Arrays follow the XML as raw bytes, each after its length.
pub(crate) fn vtu(mesh: &TriMesh, positions: &[DVec3], colliding: &[bool]) -> Vec<u8> {
    let faces = mesh.faces();
    let coordinates = positions.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect();
    let corners = faces.iter().flatten().flat_map(|v| i64::from(*v).to_le_bytes()).collect();
    let ends = (1..=faces.len() as i64).flat_map(|end| (3 * end).to_le_bytes()).collect();
    let marks = colliding.iter().map(|collides| u8::from(*collides)).collect();
    let arrays: [Vec<u8>; 5] = [marks, coordinates, corners, ends, vec![TRIANGLE; faces.len()]];
    let mut offset = 0;
    let offsets = arrays.each_ref().map(|array| {
        let start = offset;
        offset += size_of::<u64>() + array.len();
        start
    });
    let array = |kind: &str, name: &str, components: u8, offset: usize| {
        // If the file states one component, meshio reads a table of one column.
        let components =
            if components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\"{components} format=\"appended\" offset=\"{offset}\"/>"
        )
    };
    let [marks, points, corners, ends, types] = offsets;
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n\
         <CellData Scalars=\"colliding\">\n{}\n</CellData>\n<Points>\n{}\n</Points>\n<Cells>\n{}\n{}\n{}\n</Cells>\n\
         </Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
        positions.len(),
        faces.len(),
        array("UInt8", "colliding", 1, marks),
        array("Float64", "Points", 3, points),
        array("Int64", "connectivity", 1, corners),
        array("Int64", "offsets", 1, ends),
        array("UInt8", "types", 1, types),
    );
    let mut bytes = head.into_bytes();
    for array in &arrays {
        bytes.extend((array.len() as u64).to_le_bytes());
        bytes.extend(array);
    }
    bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_mesh;

    fn mesh() -> TriMesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.1, 1e-300, -1.0 / 3.0)];
        TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]).unwrap()
    }

    #[test]
    fn a_pose_is_read_again() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.vtu");
        let mesh = mesh();
        write_vtu_pose(&path, &mesh, mesh.rest_positions(), &[false, true]).unwrap();
        let read = load_mesh(&path, None).unwrap();
        assert_eq!((read.faces(), read.rest_positions()), (mesh.faces(), mesh.rest_positions()));
        let refused = write_vtu_pose(&path, &mesh, &[DVec3::NAN; 4], &[false; 2]);
        assert!(refused.unwrap_err().to_string().ends_with("is not finite"));
    }
}
