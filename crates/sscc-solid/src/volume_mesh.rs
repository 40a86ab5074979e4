//! Volumetric meshes of files, with valid indices but unchecked geometry.

use glam::DVec3;
use sscc::limits;

use crate::{NamedMaterial, SolidError};

/// Content of a volumetric mesh, before the checks. Indices count from 0. Lengths are in the file's unit, which no
/// format specifies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumeMeshParts {
    /// Rest positions, within [`sscc::limits`], at least one.
    pub vertices: Vec<DVec3>,
    /// Corners of each tetrahedron, four different vertices. In most files `(b - a) x (c - a)` points to d.
    pub tets: Vec<[u32; 4]>,
    /// Vertices in the middle of the edges of each tetrahedron, between its corners 0 1, 1 2, 0 2, 0 3, 2 3 and 1 3, as in
    /// gmsh; empty for tetrahedra of first order.
    pub middles: Vec<[u32; 6]>,
    /// Corners of each cube (hexahedron), eight different vertices in the order of VegaFEM, Medit and gmsh: for the
    /// unit cube 000, 100, 110, 010 (xyz), then 001, 101, 111, 011. There is at least one tetrahedron or cube.
    pub cubes: Vec<[u32; 8]>,
    /// Faces that the file lists in addition to the elements; there may be none, and some may be inside. Quadrilaterals
    /// become two triangles, fanned from their first corner.
    pub surface: Vec<[u32; 3]>,
    /// The materials that the file names.
    pub materials: Vec<NamedMaterial>,
    /// Index of each element's material: tetrahedra first, then cubes.
    pub element_material: Vec<u32>,
}

/// Volumetric mesh of a file with valid indices. Elements may be flat, inverted or overlap, and vertices may belong to
/// no element. [`VolumeMesh::solid`] converts it into a [`Solid`](crate::Solid).
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeMesh {
    parts: VolumeMeshParts,
}

impl VolumeMesh {
    /// Creates a mesh from these parts.
    ///
    /// # Errors
    /// When there is no vertex, more than 2^32 - 1, or no element, only some tetrahedra are of second order, an index
    /// is out of range, a coordinate is beyond [`sscc::limits`], an element or a face names a vertex twice, an element
    /// is duplicated, or an element has no material.
    pub fn new(parts: VolumeMeshParts) -> Result<Self, SolidError> {
        let VolumeMeshParts { vertices, tets, middles, cubes, surface, materials, element_material } = &parts;
        if vertices.is_empty() {
            return Err(SolidError::NoVertices);
        }
        let count = vertices.len();
        if u32::try_from(count).is_err() {
            return Err(SolidError::TooManyVertices { count });
        }
        if let Some(vertex) = vertices.iter().position(|p| !limits::contains(*p)) {
            return Err(SolidError::Vertex { vertex });
        }
        check_corners(tets, count)?;
        check_corners(middles, count)?;
        check_corners(cubes, count)?;
        check_corners(surface, count)?;
        if !middles.is_empty() && middles.len() != tets.len() {
            return Err(SolidError::MixedOrders { tets: tets.len(), second_order: middles.len() });
        }
        if tets.is_empty() && cubes.is_empty() {
            return Err(SolidError::NoElements);
        }
        check_different("tetrahedra", tets)?;
        check_different("cubes", cubes)?;
        check_materials(tets.len() + cubes.len(), materials, element_material)?;
        Ok(Self { parts })
    }

    /// Replaces the materials.
    ///
    /// # Errors
    /// When an element has no material.
    pub fn with_materials(
        mut self,
        materials: Vec<NamedMaterial>,
        element_material: Vec<u32>,
    ) -> Result<Self, SolidError> {
        check_materials(self.element_count(), &materials, &element_material)?;
        self.parts.materials = materials;
        self.parts.element_material = element_material;
        Ok(self)
    }

    /// Multiplies all lengths by `factor`.
    ///
    /// # Errors
    /// When a coordinate is then beyond [`sscc::limits`].
    pub fn scaled(mut self, factor: f64) -> Result<Self, SolidError> {
        self.parts.vertices.iter_mut().for_each(|p| *p *= factor);
        match self.parts.vertices.iter().position(|p| !limits::contains(*p)) {
            Some(vertex) => Err(SolidError::Vertex { vertex }),
            None => Ok(self),
        }
    }

    /// Returns the rest positions (the file's unit).
    pub fn vertices(&self) -> &[DVec3] {
        &self.parts.vertices
    }

    /// Returns the corners of each tetrahedron, in the file's order.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.parts.tets
    }

    /// Returns the vertices in the middle of the edges of each tetrahedron; empty for tetrahedra of first order.
    pub fn middles(&self) -> &[[u32; 6]] {
        &self.parts.middles
    }

    /// Returns the corners of each cube.
    pub fn cubes(&self) -> &[[u32; 8]] {
        &self.parts.cubes
    }

    /// Returns the faces that the file lists in addition to the elements, as triangles.
    pub fn surface(&self) -> &[[u32; 3]] {
        &self.parts.surface
    }

    /// Returns the materials that the file names.
    pub fn materials(&self) -> &[NamedMaterial] {
        &self.parts.materials
    }

    /// Returns the index of each element's material, tetrahedra first.
    pub fn element_material(&self) -> &[u32] {
        &self.parts.element_material
    }

    /// Returns the number of elements.
    pub fn element_count(&self) -> usize {
        self.parts.tets.len() + self.parts.cubes.len()
    }
}

/// Returns an error for an invalid index or a repeated corner.
fn check_corners<const N: usize>(items: &[[u32; N]], vertices: usize) -> Result<(), SolidError> {
    for corners in items {
        if let Some(index) = corners.iter().find(|index| **index as usize >= vertices) {
            return Err(SolidError::ElementIndex { index: *index, vertices });
        }
        if let Some(twice) = (1..N).find(|k| corners[..*k].contains(&corners[*k])) {
            return Err(SolidError::RepeatedCorner { index: corners[twice] });
        }
    }
    Ok(())
}

/// Returns an error for duplicate elements. gmsh writes such files in version 2.2, for volumes in two physical groups.
fn check_different<const N: usize>(kind: &'static str, elements: &[[u32; N]]) -> Result<(), SolidError> {
    let mut sorted: Vec<_> = elements.iter().copied().zip(0_usize..).collect();
    sorted.iter_mut().for_each(|(corners, _)| corners.sort_unstable());
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(SolidError::SameCorners { kind, first: pair[0].1, second: pair[1].1 }),
        None => Ok(()),
    }
}

fn check_materials(
    elements: usize,
    materials: &[NamedMaterial],
    element_material: &[u32],
) -> Result<(), SolidError> {
    let known = |m: &u32| (*m as usize) < materials.len();
    if element_material.len() != elements || !element_material.iter().all(known) {
        return Err(SolidError::ElementMaterials { elements, found: element_material.len() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra on either side of a face.
    fn parts() -> VolumeMeshParts {
        let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]];
        VolumeMeshParts {
            vertices: corners.map(|c| DVec3::from_array(c.map(f64::from))).to_vec(),
            tets: vec![[0, 1, 2, 3], [1, 2, 3, 4]],
            surface: vec![[0, 1, 2]],
            materials: vec![NamedMaterial::default()],
            element_material: vec![0, 0],
            ..VolumeMeshParts::default()
        }
    }

    #[test]
    fn invalid_parts_are_rejected() {
        let rejected = |change: &dyn Fn(&mut VolumeMeshParts)| {
            let mut parts = parts();
            change(&mut parts);
            VolumeMesh::new(parts).unwrap_err()
        };
        assert!(VolumeMesh::new(parts()).is_ok());
        assert_eq!(rejected(&|p| p.vertices.clear()), SolidError::NoVertices);
        assert_eq!(rejected(&|p| p.tets.clear()), SolidError::NoElements);
        assert_eq!(rejected(&|p| p.vertices[3].y = f64::NAN), SolidError::Vertex { vertex: 3 });
        assert_eq!(rejected(&|p| p.vertices[0].x = 2e60), SolidError::Vertex { vertex: 0 });
        let index = |index| SolidError::ElementIndex { index, vertices: 5 };
        assert_eq!(rejected(&|p| p.tets[1][2] = 5), index(5));
        assert_eq!(rejected(&|p| p.surface[0][2] = u32::MAX), index(u32::MAX));
        assert_eq!(rejected(&|p| p.tets[1][2] = 1), SolidError::RepeatedCorner { index: 1 });
        let same = SolidError::SameCorners { kind: "tetrahedra", first: 0, second: 1 };
        assert_eq!(rejected(&|p| p.tets[1] = [3, 1, 0, 2]), same);
        assert_eq!(same.to_string(), "tetrahedra 0 and 1 (counted from 0) have the same corners");
        let scaled = VolumeMesh::new(parts()).unwrap().scaled(0.5).unwrap();
        assert_eq!((scaled.vertices()[4], scaled.tets()), (DVec3::splat(0.5), &parts().tets[..]));
        assert_eq!(scaled.scaled(1e300), Err(SolidError::Vertex { vertex: 1 }));
        let materials = |found| SolidError::ElementMaterials { elements: 2, found };
        assert_eq!(rejected(&|p| p.element_material.truncate(1)), materials(1));
        assert_eq!(rejected(&|p| p.element_material[1] = 1), materials(2));
        let other = VolumeMesh::new(parts()).unwrap().with_materials(vec![], vec![0, 0]);
        assert_eq!(other.unwrap_err(), materials(2));
    }
}
