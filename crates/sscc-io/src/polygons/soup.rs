//! Content of a mesh file before the checks of a mesh.

use glam::DVec3;
use sscc::{TriMesh, limits};

use super::triangulation::{LargerPolygon, triangulate};
use crate::FormatError;

/// Positions and polygons of a file, with valid indices. A target shape may have no polygons.
pub(crate) struct Soup {
    pub positions: Vec<DVec3>,
    /// Every polygon as a fan around its first corner, in the order of the file.
    pub fans: Vec<[u32; 3]>,
    /// The polygons of more than 3 corners, in the order of the file.
    pub larger: Vec<LargerPolygon>,
    /// Whether the format splits vertices along seams.
    pub has_split_vertices: bool,
    /// Lines about content that violates the format, and how the reader interprets it.
    pub warnings: Vec<String>,
}

impl Soup {
    /// Returns the soup of triangles without larger polygons.
    pub fn of_triangles(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            positions,
            fans: triangles,
            larger: Vec::new(),
            has_split_vertices: false,
            warnings: Vec::new(),
        }
    }

    /// Returns the mesh; it must have a triangle.
    pub fn into_mesh(self) -> Result<TriMesh, FormatError> {
        self.into_mesh_with_warnings().map(|(mesh, _)| mesh)
    }

    /// Returns the mesh, and the warnings, among them lines about polygons whose triangles the file does not determine.
    pub fn into_mesh_with_warnings(self) -> Result<(TriMesh, Vec<String>), FormatError> {
        let Self { positions, mut fans, larger, has_split_vertices, mut warnings } = self;
        // Invalid positions are an error of the mesh.
        if !larger.is_empty() && positions.iter().all(|p| limits::contains(*p)) {
            warnings.extend(triangulate(&positions, &mut fans, &larger)?);
        }
        let mesh = TriMesh::new(positions, fans)?;
        Ok((if has_split_vertices { mesh.with_split_vertices() } else { mesh }, warnings))
    }

    /// Checks that these triangles are those of this file's polygons, for any positions: each triangle of the file is
    /// in its place, and those in the place of a larger polygon have its border. The error is the number of a triangle
    /// that differs.
    pub fn has_polygons_of(&self, triangles: &[[u32; 3]]) -> Result<(), usize> {
        let mut larger = self.larger.iter().peekable();
        let mut at = 0;
        while at < self.fans.len() {
            let count = match larger.peek() {
                Some(polygon) if polygon.start == at => polygon.triangles,
                _ => 1,
            };
            if count > 1 {
                larger.next();
            }
            let places = at..at + count;
            let (fan, found) = (&self.fans[places.clone()], triangles.get(places).ok_or(at)?);
            if fan != found && (count == 1 || border(fan) != border(found)) {
                return Err(at + fan.iter().zip(found).position(|(a, b)| a != b).unwrap_or_default());
            }
            at += count;
        }
        if at == triangles.len() { Ok(()) } else { Err(at) }
    }
}

/// Returns the edges of triangles, in the direction of their corners, without those that two triangles pass in opposite
/// directions; sorted.
fn border(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let of_triangle = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(of_triangle).collect();
    // Both directions of an edge are neighbours in this order, the rising ones first.
    edges.sort_unstable_by_key(|&[a, b]| (a.min(b), a.max(b), a > b));
    let mut border = Vec::new();
    for same in edges.chunk_by(|a, b| a[0].min(a[1]) == b[0].min(b[1]) && a[0].max(a[1]) == b[0].max(b[1])) {
        let rising = same.partition_point(|[a, b]| a <= b);
        let falling = same.len() - rising;
        if rising >= falling {
            border.extend(&same[..rising - falling]);
        } else {
            border.extend(&same[rising..falling]);
        }
    }
    border
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_of_the_same_polygons_are_recognised() {
        let soup = Soup {
            positions: vec![DVec3::ZERO; 8],
            fans: vec![[5, 6, 7], [0, 1, 2], [0, 2, 3], [0, 3, 4], [1, 2, 3]],
            larger: vec![LargerPolygon { start: 1, triangles: 3 }],
            has_split_vertices: false,
            warnings: Vec::new(),
        };
        let with = |polygon: [[u32; 3]; 3]| {
            let [a, b, c] = polygon;
            soup.has_polygons_of(&[[5, 6, 7], a, b, c, [1, 2, 3]])
        };
        assert_eq!(with([[0, 1, 2], [0, 2, 3], [0, 3, 4]]), Ok(()));
        assert_eq!(with([[1, 2, 3], [3, 4, 0], [3, 0, 1]]), Ok(()));
        // Another polygon, the other side, a polygon of the same corners in another order.
        assert_eq!(with([[1, 2, 3], [3, 4, 0], [3, 0, 5]]), Err(1));
        assert_eq!(with([[0, 2, 1], [0, 3, 2], [0, 4, 3]]), Err(1));
        assert_eq!(with([[0, 1, 2], [0, 2, 4], [0, 4, 3]]), Err(2));
        assert_eq!(soup.has_polygons_of(&soup.fans[..4]), Err(4));
        assert_eq!(soup.has_polygons_of(&[&soup.fans[..], &[[0, 1, 2]]].concat()), Err(5));
        let mut moved = soup.fans.clone();
        moved[0] = [6, 7, 5];
        assert_eq!(soup.has_polygons_of(&moved), Err(0));
    }
}
