//! Boundary mesh of a solid.

use glam::DVec3;
use sscc::{Modes, TriMesh};

use crate::element::{CUBE_FACES, TET_FACES};
use crate::interior::{sorted, tets_within_or_apart};
use crate::second_order::middle;
use crate::{Solid, SolidError, VolumeMesh};

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
    /// Returns the surface of the elements with all vertices of the file. Elements may be flat, inverted or overlap. Where
    /// tetrahedra fill the convex hull of the surface that the file lists, those outside of it are left out
    /// ([`VolumeMesh::tets_left_out`]); a region that has no common faces with them and with those inside is kept. Listed
    /// faces of no element are not added. Triangles are in the order of [`Solid::boundary`].
    ///
    /// # Errors
    /// When three or more elements share a face; when no face belongs to exactly one element.
    pub fn surface_mesh(&self) -> Result<TriMesh, SolidError> {
        let is_kept = self.kept_tets();
        let kept: Vec<usize> = (0..is_kept.len()).filter(|tet| is_kept[*tet]).collect();
        let tets: Vec<[u32; 4]> = kept.iter().map(|tet| self.tets()[*tet]).collect();
        let middles = |tet: usize| self.middles().get(*kept.get(tet)?);
        let node = |tet: usize, k: usize| middles(tet).map(|middles| middles[k - 4]);
        Ok(TriMesh::new(self.vertices().to_vec(), outer_triangles(&tets, node, self.cubes())?)?)
    }

    /// Returns the number of tetrahedra that [`VolumeMesh::surface_mesh`] leaves out.
    pub fn tets_left_out(&self) -> usize {
        self.kept_tets().iter().filter(|is_kept| !**is_kept).count()
    }

    /// Returns for each triangle whether it is a face of an element that [`VolumeMesh::surface_mesh`] keeps, or a part of a
    /// face: half a face of a cube, on either side of a diagonal, or a quarter of a face of a tetrahedron of second
    /// order. Costs O(n log n) in the number of elements and triangles.
    pub fn has_faces(&self, triangles: &[[u32; 3]]) -> Vec<bool> {
        if triangles.is_empty() {
            return Vec::new();
        }
        let mut known: Vec<([u32; 3], bool)> = triangles.iter().map(|t| (sorted(*t), false)).collect();
        known.sort_unstable();
        known.dedup();
        self.for_each_part_of_faces(|part| {
            if let Ok(at) = known.binary_search_by_key(&sorted(part), |(corners, _)| *corners) {
                known[at].1 = true;
            }
        });
        let is_found = |triangle: &[u32; 3]| {
            let at = known.binary_search_by_key(&sorted(*triangle), |(corners, _)| *corners);
            at.is_ok_and(|at| known[at].1)
        };
        triangles.iter().map(is_found).collect()
    }

    /// Calls `call` with every triangle that [`VolumeMesh::has_faces`] accepts.
    fn for_each_part_of_faces(&self, mut call: impl FnMut([u32; 3])) {
        let is_kept = self.kept_tets();
        for (number, tet) in self.tets().iter().enumerate().filter(|(number, _)| is_kept[*number]) {
            for face in TET_FACES {
                let corners = face.map(|k| tet[k]);
                call(corners);
                if let Some(middles) = self.middles().get(number) {
                    let [i, j, k] = face;
                    let of_edges = [[i, j], [j, k], [k, i]].map(|[i, j]| middles[middle(i, j) - 4]);
                    quarters(corners, of_edges).into_iter().for_each(&mut call);
                }
            }
        }
        for cube in self.cubes() {
            for [a, b, c, d] in CUBE_FACES.map(|face| face.map(|k| cube[k])) {
                [[a, b, c], [a, c, d], [a, b, d], [b, c, d]].into_iter().for_each(&mut call);
            }
        }
    }

    /// Returns for each tetrahedron whether its faces belong to the surface.
    fn kept_tets(&self) -> Vec<bool> {
        tets_within_or_apart(self.tets(), self.surface())
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
                triangles.extend(quarters([face[0], face[1], face[2]], [ab, bc, ca]));
            }
            _ => triangles.extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]])),
        }
    }
    Ok(triangles)
}

/// Returns the four triangles of a face of second order: its corners, then the middles of its edges 0 1, 1 2 and 2 0.
fn quarters([a, b, c]: [u32; 3], [ab, bc, ca]: [u32; 3]) -> [[u32; 3]; 4] {
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
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

    /// A mesh of the given elements, one material and vertices that may be anywhere.
    fn mesh(vertices: u32, tets: &[[u32; 4]], cubes: &[[u32; 8]], surface: &[[u32; 3]]) -> VolumeMesh {
        let parts = VolumeMeshParts {
            vertices: (0..vertices).map(|v| DVec3::splat(f64::from(v))).collect(),
            tets: tets.to_vec(),
            cubes: cubes.to_vec(),
            surface: surface.to_vec(),
            materials: vec![NamedMaterial::default()],
            element_material: vec![0; tets.len() + cubes.len()],
            ..VolumeMeshParts::default()
        };
        VolumeMesh::new(parts).unwrap()
    }

    #[test]
    fn the_surface_leaves_out_only_what_fills_the_hull_of_the_listed_surface() {
        let listed = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let filling = mesh(5, &[[0, 1, 2, 3], [0, 2, 1, 4]], &[], &listed);
        assert_eq!((filling.surface_mesh().unwrap().faces().len(), filling.tets_left_out()), (4, 1));
        // A face of a tetrahedron that is left out belongs to no element of the surface.
        assert_eq!(filling.has_faces(&[[2, 1, 0], [0, 1, 4]]), [true, false]);
        let apart = mesh(8, &[[0, 1, 2, 3], [4, 5, 6, 7]], &[], &listed);
        assert_eq!((apart.surface_mesh().unwrap().faces().len(), apart.tets_left_out()), (8, 0));
        assert_eq!(apart.has_faces(&[[2, 1, 0], [4, 6, 7], [0, 1, 4]]), [true, true, false]);
    }

    #[test]
    fn triangles_are_faces_of_elements_or_parts_of_faces() {
        let cube = mesh(9, &[], &[[0, 1, 2, 3, 4, 5, 6, 7]], &[]);
        assert_eq!(
            cube.has_faces(&[[0, 1, 2], [3, 2, 0], [1, 3, 2], [0, 1, 6], [0, 1, 8]]),
            [true, true, true, false, false]
        );
        assert_eq!(cube.has_faces(&[]), [false; 0]);
        let linear = mesh(10, &[[0, 1, 2, 3]], &[], &[]);
        let second_order = VolumeMesh::new(VolumeMeshParts {
            vertices: linear.vertices().to_vec(),
            tets: linear.tets().to_vec(),
            middles: vec![[4, 5, 6, 7, 8, 9]],
            materials: vec![NamedMaterial::default()],
            element_material: vec![0],
            ..VolumeMeshParts::default()
        });
        // The middles of the edges 0 1, 1 2 and 2 0 are the vertices 4, 5 and 6.
        let triangles = [[2, 0, 1], [0, 4, 6], [6, 5, 4], [0, 4, 5]];
        assert_eq!(second_order.unwrap().has_faces(&triangles), [true, true, true, false]);
        assert_eq!(linear.has_faces(&triangles), [true, false, false, false]);
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
