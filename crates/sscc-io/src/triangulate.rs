//! Triangulation of the polygons of a mesh that a caller has read.

use glam::DVec3;

use crate::polygons::Polygons;
use crate::{FormatError, LoadedMesh, Place};

/// Returns the mesh of polygons: `counts` has the number of corners of each, `corners` their vertices, one polygon after the
/// other, from 0. Polygons become triangles as in the readers of mesh files, with the same warnings.
///
/// # Errors
/// When the counts do not add up to the corners; when a polygon has fewer than three corners or a vertex that does not
/// exist, or takes too long to triangulate; when there are no positions or no polygons; when a position is not finite
/// or beyond [`LARGEST`](sscc::limits::LARGEST).
pub fn triangulate(
    positions: Vec<DVec3>,
    counts: &[u64],
    corners: &[u64],
) -> Result<LoadedMesh, FormatError> {
    let mut polygons = Polygons::new(0);
    let mut rest = corners;
    for (number, count) in counts.iter().enumerate() {
        let count = usize::try_from(*count).unwrap_or(usize::MAX);
        let Some((polygon, after)) = rest.split_at_checked(count) else {
            return Err(FormatError::whole("the polygons have more corners than are given"));
        };
        rest = after;
        polygons.push(polygon, Place::Part(format!("polygon {number} (counted from 0)")))?;
    }
    if !rest.is_empty() {
        return Err(FormatError::whole("the polygons have fewer corners than are given"));
    }
    let (mesh, warnings) = polygons.finish(positions)?.into_mesh_with_warnings()?;
    Ok(LoadedMesh { mesh, warnings })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_are_cut_as_in_files() {
        let arrow = [(2.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let faces = |counts: &[u64], corners: &[u64]| {
            triangulate(arrow.to_vec(), counts, corners).map(|found| found.mesh.faces().to_vec())
        };
        // The fan from the first corner is not the surface.
        let mut found = faces(&[4], &[1, 2, 3, 0]).unwrap();
        found.iter_mut().for_each(|face| face.sort_unstable());
        found.sort_unstable();
        assert_eq!(found, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(faces(&[3, 3], &[0, 1, 2, 2, 3, 0]).unwrap(), [[0, 1, 2], [2, 3, 0]]);
        let message = |counts: &[u64], corners: &[u64]| faces(counts, corners).unwrap_err().to_string();
        assert_eq!(message(&[4], &[0, 1, 2]), "the polygons have more corners than are given");
        assert_eq!(message(&[3], &[0, 1, 2, 3]), "the polygons have fewer corners than are given");
        assert!(message(&[u64::MAX], &[0, 1, 2]).contains("more corners"));
        assert!(message(&[2, 3], &[0, 1, 2, 3, 0]).starts_with("polygon 0 (counted from 0): a face needs"));
        assert!(message(&[3], &[0, 1, 4]).contains("names vertex 4"));
    }
}
