//! Surfaces of solids, and solids within surfaces.

use glam::DVec3;
use sscc::TriMesh;

use crate::{ModesError, Solid};

/// The faces of a tetrahedron of positive volume, outward.
const TET_FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

/// The faces of a cube, outward.
const CUBE_FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// The boundary of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// The faces that belong to one element only, outward, in the order of the elements; those of cubes cut in two. Its
    /// vertices are those of the solid that are on the boundary, in their order.
    pub mesh: TriMesh,
    /// The vertex of the solid that each vertex of the mesh is.
    pub vertices: Vec<u32>,
}

impl Solid {
    /// The boundary.
    ///
    /// # Errors
    /// When three elements share a face, so that some overlap.
    pub fn boundary(&self) -> Result<Boundary, ModesError> {
        let tets = self.tets().iter().flat_map(|tet| TET_FACES.map(|f| f.map(|k| tet[k]).to_vec()));
        let cubes = self.cubes().iter().flat_map(|cube| CUBE_FACES.map(|f| f.map(|k| cube[k]).to_vec()));
        let faces: Vec<Vec<u32>> = tets.chain(cubes).collect();
        let mut sorted: Vec<(Vec<u32>, usize)> = faces.iter().cloned().zip(0..).collect();
        sorted.iter_mut().for_each(|(corners, _)| corners.sort_unstable());
        sorted.sort_unstable();
        let mut outer = Vec::new();
        for same in sorted.chunk_by(|a, b| a.0 == b.0) {
            match same {
                [one] => outer.push(one.1),
                [_, _] => {}
                _ => return Err(ModesError::OverlappingElements { face: same[0].0.clone() }),
            }
        }
        outer.sort_unstable();
        let triangles = outer.into_iter().flat_map(|at| {
            let face = &faces[at];
            (2..face.len()).map(|k| [face[0], face[k - 1], face[k]])
        });
        let triangles: Vec<[u32; 3]> = triangles.collect();
        let mut used = vec![false; self.vertices().len()];
        triangles.iter().flatten().for_each(|v| used[*v as usize] = true);
        let vertices: Vec<u32> = (0..used.len() as u32).filter(|v| used[*v as usize]).collect();
        let number = |v: u32| vertices.partition_point(|w| *w < v) as u32;
        let positions: Vec<DVec3> = vertices.iter().map(|v| self.vertices()[*v as usize]).collect();
        let triangles = triangles.iter().map(|t| t.map(number)).collect();
        Ok(Boundary { mesh: TriMesh::new(positions, triangles)?, vertices })
    }
}

/// Which tetrahedra lie within a surface made of their faces: all but those that can be reached from outside without
/// crossing it. Some meshers fill the convex hull of a surface. All of them where a triangle of the surface is not a
/// face, or where the surface encloses nothing.
pub fn tets_within(tets: &[[u32; 4]], surface: &[[u32; 3]]) -> Vec<bool> {
    let all = vec![true; tets.len()];
    let sorted = |mut face: [u32; 3]| {
        face.sort_unstable();
        face
    };
    let mut walls: Vec<[u32; 3]> = surface.iter().map(|f| sorted(*f)).collect();
    walls.sort_unstable();
    let mut faces: Vec<([u32; 3], u32)> = Vec::with_capacity(4 * tets.len());
    for (index, tet) in tets.iter().enumerate() {
        faces.extend(TET_FACES.map(|f| (sorted(f.map(|k| tet[k])), index as u32)));
    }
    faces.sort_unstable();
    let is_face = |wall: &[u32; 3]| {
        let at = faces.partition_point(|f| f.0 < *wall);
        faces.get(at).is_some_and(|f| f.0 == *wall)
    };
    if walls.is_empty() || !walls.iter().all(is_face) {
        return all;
    }
    let mut within = all.clone();
    let mut neighbours = vec![Vec::new(); tets.len()];
    let mut reached = Vec::new();
    for same in faces.chunk_by(|a, b| a.0 == b.0) {
        let wall = walls.binary_search(&same[0].0).is_ok();
        match same {
            [a, b] if !wall => {
                neighbours[a.1 as usize].push(b.1);
                neighbours[b.1 as usize].push(a.1);
            }
            [one] if !wall => reached.push(one.1),
            _ => {}
        }
    }
    while let Some(tet) = reached.pop() {
        if std::mem::replace(&mut within[tet as usize], false) {
            reached.extend(neighbours[tet as usize].iter().copied());
        }
    }
    if within.iter().any(|x| *x) { within } else { all }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Material;

    #[test]
    fn the_boundary_of_a_cube_and_a_tetrahedron_is_closed() {
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
        assert!(matches!(overlapping.unwrap().boundary(), Err(ModesError::OverlappingElements { .. })));
    }

    #[test]
    fn what_lies_outside_a_surface_is_told() {
        // Two tetrahedra on either side of a face; the surface is that of the first.
        let tets = [[0, 1, 2, 3], [0, 2, 1, 4]];
        let first = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(tets_within(&tets, &first), [true, false]);
        assert_eq!(tets_within(&tets, &first[..3]), [true, true], "open: it encloses nothing");
        assert_eq!(tets_within(&tets, &[[0, 1, 9]]), [true, true], "no face of a tetrahedron");
        assert_eq!(tets_within(&tets, &[]), [true, true]);
    }
}
