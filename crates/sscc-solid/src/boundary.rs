//! Boundary mesh of a solid.

use glam::DVec3;
use sscc::{Modes, TriMesh};

use crate::element::{CUBE_FACES, TET_FACES};
use crate::second_order::middle;
use crate::{Solid, SolidError, VolumeMesh, tets_within};

/// Boundary of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Faces that belong to exactly one element, outward, in the order of the elements; faces of cubes are split into
    /// two triangles, faces of second-order tetrahedra into four, through the middles of their edges. Vertices are those of
    /// the solid on the boundary, in their order.
    pub mesh: TriMesh,
    /// Vertex of the solid for each vertex of the mesh.
    pub vertices: Vec<u32>,
}

impl Solid {
    /// Returns the boundary. Costs O(n log n) in the number of faces.
    ///
    /// # Errors
    /// When three or more elements share a face, so that elements overlap; when no face belongs to exactly one element.
    pub fn boundary(&self) -> Result<Boundary, SolidError> {
        let triangles = outer_triangles(
            self.tets(),
            |tet, k| self.tets10().get(tet).map(|nodes| nodes[k]),
            self.cubes(),
        )?;
        let mut used = vec![false; self.vertices().len()];
        triangles.iter().flatten().for_each(|v| used[*v as usize] = true);
        let vertices: Vec<u32> = (0..used.len() as u32).filter(|v| used[*v as usize]).collect();
        let number = |v: u32| vertices.partition_point(|w| *w < v) as u32;
        let positions: Vec<DVec3> = vertices.iter().map(|v| self.vertices()[*v as usize]).collect();
        let triangles = triangles.iter().map(|t| t.map(number)).collect();
        Ok(Boundary { mesh: TriMesh::new(positions, triangles)?, vertices })
    }
}

impl VolumeMesh {
    /// Returns the surface of the elements with all vertices of the file. Elements may be flat, inverted or overlap;
    /// tetrahedra outside of the surface that the file lists are left out. Triangles are in the order of
    /// [`Solid::boundary`].
    ///
    /// # Errors
    /// When three or more elements share a face; when no face belongs to exactly one element.
    pub fn surface_mesh(&self) -> Result<TriMesh, SolidError> {
        let within = tets_within(self.tets(), self.surface());
        let kept: Vec<usize> = (0..within.len()).filter(|tet| within[*tet]).collect();
        let tets: Vec<[u32; 4]> = kept.iter().map(|tet| self.tets()[*tet]).collect();
        let middles = |tet: usize| self.middles().get(*kept.get(tet)?);
        let node = |tet: usize, k: usize| middles(tet).map(|middles| middles[k - 4]);
        Ok(TriMesh::new(self.vertices().to_vec(), outer_triangles(&tets, node, self.cubes())?)?)
    }
}

/// Returns the faces of exactly one element as triangles, in the order of the elements, outward where an element is not
/// inverted. `node` returns a middle node (from 4) of a tetrahedron of second order.
fn outer_triangles(
    tets: &[[u32; 4]],
    node: impl Fn(usize, usize) -> Option<u32>,
    cubes: &[[u32; 8]],
) -> Result<Vec<[u32; 3]>, SolidError> {
    let faces_of_tets = 4 * tets.len();
    let tets = tets.iter().flat_map(|tet| TET_FACES.map(|f| f.map(|k| tet[k]).to_vec()));
    let cubes = cubes.iter().flat_map(|cube| CUBE_FACES.map(|f| f.map(|k| cube[k]).to_vec()));
    let faces: Vec<Vec<u32>> = tets.chain(cubes).collect();
    let mut sorted: Vec<(Vec<u32>, usize)> = faces.iter().cloned().zip(0..).collect();
    sorted.iter_mut().for_each(|(corners, _)| corners.sort_unstable());
    sorted.sort_unstable();
    let mut outer = Vec::new();
    for same in sorted.chunk_by(|a, b| a.0 == b.0) {
        match same {
            [one] => outer.push(one.1),
            [_, _] => {}
            _ => return Err(SolidError::OverlappingElements { face: same[0].0.clone() }),
        }
    }
    outer.sort_unstable();
    let mut triangles = Vec::new();
    for at in outer {
        let face = &faces[at];
        let [a, b, c] = TET_FACES[at % 4];
        let middles = [[a, b], [b, c], [c, a]].map(|[i, j]| node(at / 4, middle(i, j)));
        match middles {
            [Some(ab), Some(bc), Some(ca)] if at < faces_of_tets => {
                let [a, b, c] = [face[0], face[1], face[2]];
                triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            _ => triangles.extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]])),
        }
    }
    Ok(triangles)
}

impl Boundary {
    /// Restricts modes of the solid's vertices to the boundary's vertices.
    ///
    /// # Errors
    /// When a vertex of the boundary is beyond those of the modes.
    pub fn on_surface(&self, modes: &Modes) -> Result<Modes, SolidError> {
        let (rank, found) = (modes.rank(), modes.vertices());
        let needed = self.vertices.iter().max().map_or(0, |v| *v as usize + 1);
        if found < needed {
            return Err(sscc::Error::VertexCount { modes: found, mesh: needed }.into());
        }
        let displacements = self.vertices.iter().flat_map(|v| modes.of_vertex(*v)).copied().collect();
        Ok(Modes::new(rank, displacements)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, NamedMaterial, VolumeMeshParts};

    #[test]
    fn the_boundary_of_a_cube_is_closed_and_overlaps_are_rejected() {
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let mut vertices: Vec<DVec3> = corners.iter().map(|c| DVec3::from_array(c.map(f64::from))).collect();
        vertices.push(DVec3::new(0.5, 0.5, 2.0));
        let tets = vec![[4, 5, 6, 8], [4, 6, 7, 8]];
        let cube = vec![[0, 1, 2, 3, 4, 5, 6, 7]];
        let solid = Solid::uniform(vertices.clone(), tets, vec![], Material::default());
        assert!(solid.is_err(), "vertices without an element");
        let solid = Solid::uniform(vertices[..8].to_vec(), vec![], cube, Material::default()).unwrap();
        let boundary = solid.boundary().unwrap();
        assert_eq!((boundary.mesh.faces().len(), boundary.vertices.len()), (12, 8));
        let volume: f64 = boundary
            .mesh
            .faces()
            .iter()
            .map(|f| f.map(|v| vertices[v as usize]))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum();
        assert!((volume - 1.0).abs() < 1e-15);
        let three = vec![[0, 1, 3, 4], [0, 1, 3, 5], [0, 1, 3, 2]];
        let overlapping = Solid::uniform(
            [[0., 0., 0.], [1., 0., 0.], [0., 0., 3.], [0., 1., 0.], [0., 0., 1.], [0., 0., 2.]]
                .map(DVec3::from_array)
                .to_vec(),
            three,
            vec![],
            Material::default(),
        );
        assert!(matches!(overlapping.unwrap().boundary(), Err(SolidError::OverlappingElements { .. })));
    }

    #[test]
    fn the_surface_of_a_volume_mesh_has_the_vertices_of_the_file() {
        let corners = [[9, 9, 9], [0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [1, 1, 1], [2, 2, 2]];
        let parts = VolumeMeshParts {
            vertices: corners.map(|c| DVec3::from_array(c.map(f64::from))).to_vec(),
            // Vertex 0 belongs to no element, vertex 5 is inside, and the last element is flat.
            tets: vec![[1, 3, 2, 5], [1, 2, 4, 5], [2, 3, 4, 5], [1, 4, 3, 5], [1, 2, 3, 6]],
            materials: vec![NamedMaterial { unsupported: Some("x".into()), ..NamedMaterial::default() }],
            element_material: vec![0; 5],
            ..VolumeMeshParts::default()
        };
        let mesh = VolumeMesh::new(parts.clone()).unwrap().surface_mesh().unwrap();
        assert_eq!((mesh.rest_positions(), mesh.faces().len()), (&parts.vertices[..], 6));
        assert!(mesh.faces().as_flattened().iter().all(|v| ![0, 5].contains(v)));
        let three = VolumeMeshParts {
            tets: vec![[1, 2, 3, 4], [1, 2, 3, 5], [1, 2, 3, 6]],
            element_material: vec![0; 3],
            ..parts
        };
        let refused = VolumeMesh::new(three).unwrap().surface_mesh();
        assert!(matches!(refused, Err(SolidError::OverlappingElements { .. })));
    }

    #[test]
    fn modes_of_the_solid_are_restricted_to_its_boundary() {
        // Four tetrahedra within a larger one: vertex 4 is inside.
        let corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [1, 1, 1]];
        let vertices = corners.map(|c| DVec3::from_array(c.map(f64::from))).to_vec();
        let tets = vec![[0, 2, 1, 4], [0, 1, 3, 4], [1, 2, 3, 4], [0, 3, 2, 4]];
        let solid = Solid::uniform(vertices, tets, vec![], Material::default()).unwrap();
        let boundary = solid.boundary().unwrap();
        assert_eq!(boundary.vertices, [0, 1, 2, 3]);
        let modes = Modes::from_matrix(5, 2, |row, k| (2 * row + k) as f64).unwrap();
        let found = boundary.on_surface(&modes).unwrap();
        assert_eq!(found, Modes::from_matrix(4, 2, |row, k| (2 * row + k) as f64).unwrap());
        let few = Modes::from_matrix(3, 1, |row, _| row as f64).unwrap();
        let rejected = SolidError::Core(sscc::Error::VertexCount { modes: 3, mesh: 4 });
        assert_eq!(boundary.on_surface(&few), Err(rejected));
    }
}
