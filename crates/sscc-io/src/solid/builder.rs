//! Builder for volumetric meshes: checks for all formats, with places in the file.

use std::collections::BTreeMap;

use glam::DVec3;
use sscc_solid::{NamedMaterial, SolidError, VolumeMesh, VolumeMeshParts};

use super::listed_faces::ListedFaces;
use super::volume_or_surface::VolumeOrSurface;
use crate::polygons::Polygons;
use crate::{FormatError, Place};

/// Name of the material of elements without a material.
const DEFAULT_MATERIAL: &str = "default";

/// Cause of the error if a file has no cells but points and lines.
const NO_CELLS: &str = "no cell is a triangle, a polygon, a tetrahedron or a hexahedron: save the surface or the solid, not only its \
    points and lines";

/// Vertices and elements read so far. Elements may precede their vertices, so `finish` checks the indices.
pub(super) struct Builder {
    parts: VolumeMeshParts,
    cube_material: Vec<u32>,
    by_name: BTreeMap<String, u32>,
    faces: Polygons,
    /// What `faces` does not show as triangles.
    listed: ListedFaces,
    /// Triangles of second order: corners, then the middles of their edges.
    second_order: Vec<([u64; 6], Place)>,
    /// The first face of a kind that is not read, as an error. A solid does not need it.
    unread_faces: Option<FormatError>,
    /// Largest index, from 0, and its place.
    largest: Option<(u64, Place)>,
    /// Number of the first vertex in the file: 0 or 1. Only for messages.
    pub first: u64,
}

impl Builder {
    pub fn new(first: u64) -> Self {
        Self {
            parts: VolumeMeshParts::default(),
            cube_material: Vec::new(),
            by_name: BTreeMap::new(),
            faces: Polygons::new(first),
            listed: ListedFaces::default(),
            second_order: Vec::new(),
            unread_faces: None,
            largest: None,
            first,
        }
    }

    pub fn vertices(&self) -> usize {
        self.parts.vertices.len()
    }

    pub fn elements(&self) -> usize {
        self.parts.tets.len() + self.parts.cubes.len()
    }

    pub fn vertex(&mut self, position: DVec3, place: Place) -> Result<(), FormatError> {
        if !sscc::limits::contains(position) {
            return Err(FormatError::new(
                place,
                "a coordinate is not finite, or beyond 2^200: repair it, or change the unit",
            ));
        }
        self.parts.vertices.push(position);
        Ok(())
    }

    /// Returns the index of the material of that name.
    pub fn material(&mut self, name: &str) -> u32 {
        if let Some(known) = self.by_name.get(name) {
            return *known;
        }
        let index = self.parts.materials.len() as u32;
        self.by_name.insert(name.to_owned(), index);
        self.parts.materials.push(NamedMaterial { name: name.to_owned(), ..NamedMaterial::default() });
        index
    }

    /// Returns the index of the material of elements without a material.
    pub fn default_material(&mut self) -> u32 {
        self.material(DEFAULT_MATERIAL)
    }

    /// Adds a tetrahedron; corners from 0.
    pub fn tet(&mut self, corners: [u64; 4], material: u32, place: Place) -> Result<(), FormatError> {
        self.check(&corners, place)?;
        self.parts.tets.push(corners.map(|c| c as u32));
        self.parts.element_material.push(material);
        Ok(())
    }

    /// Adds a tetrahedron of second order; nodes from 0, the middles of edges in gmsh's order.
    pub fn tet10(&mut self, nodes: [u64; 10], material: u32, place: Place) -> Result<(), FormatError> {
        self.check(&nodes, place.clone())?;
        let [a, b, c, d, middles @ ..] = nodes;
        self.parts.middles.push(middles.map(|v| v as u32));
        self.tet([a, b, c, d], material, place)
    }

    /// Adds a cube; corners from 0.
    pub fn cube(&mut self, corners: [u64; 8], material: u32, place: Place) -> Result<(), FormatError> {
        self.check(&corners, place)?;
        self.parts.cubes.push(corners.map(|c| c as u32));
        self.cube_material.push(material);
        Ok(())
    }

    /// Adds a face of 3 or 4 corners, from 0.
    pub fn face<const N: usize>(&mut self, corners: [u64; N], place: Place) -> Result<(), FormatError> {
        self.check(&corners, place.clone())?;
        self.polygon(&corners, place)
    }

    /// Adds a face of any number of corners, from 0.
    pub fn polygon(&mut self, corners: &[u64], place: Place) -> Result<(), FormatError> {
        let start = self.faces.triangle_count();
        self.faces.push(corners, place)?;
        self.listed.add_polygon(start..self.faces.triangle_count());
        Ok(())
    }

    /// Adds a triangle of second order: corners from 0, then the middles of the edges 0 1, 1 2 and 2 0.
    pub fn face_of_second_order(&mut self, nodes: [u64; 6], place: Place) -> Result<(), FormatError> {
        self.check(&nodes, place.clone())?;
        self.second_order.push((nodes, place));
        Ok(())
    }

    /// Notes faces of a kind that is not read: an error if the file has no solid elements, else a warning.
    pub fn unread_faces(&mut self, kind: &str, place: Place) {
        let cause = format!(
            "{kind} is not supported: only triangles and quadrilaterals of first order are, and triangles of 6 \
             nodes in files of gmsh and VTK"
        );
        self.unread_faces.get_or_insert_with(|| FormatError::new(place, cause));
    }

    /// Stored indices are truncated to 32 bits; `largest` keeps the true value, which `finish` rejects.
    fn check(&mut self, corners: &[u64], place: Place) -> Result<(), FormatError> {
        if let Some(twice) = repeated(corners) {
            let (vertex, first) = (twice.saturating_add(self.first), self.first);
            return Err(FormatError::new(
                place,
                format!("the element names vertex {vertex} (counted from {first}) twice"),
            ));
        }
        let largest = corners.iter().copied().max().unwrap_or_default();
        if self.largest.as_ref().is_none_or(|(known, _)| largest > *known) {
            self.largest = Some((largest, place));
        }
        Ok(())
    }

    /// Returns the solid.
    pub fn finish(self) -> Result<VolumeMesh, FormatError> {
        if self.vertices() > 0 && self.elements() == 0 && self.faces.triangle_count() == 0 {
            return Err(SolidError::NoElements.into());
        }
        self.finish_any()?.into_volume().map(|(mesh, _)| mesh)
    }

    /// Returns the solid, or the surface of a file without solid elements, if all its indices are valid.
    pub fn finish_any(mut self) -> Result<VolumeOrSurface, FormatError> {
        let vertices = self.parts.vertices.len();
        match self.largest {
            Some((index, place)) if vertices > 0 && index >= vertices as u64 => {
                let (index, first) = (index.saturating_add(self.first), self.first);
                let cause = format!(
                    "the element names vertex {index} (counted from {first}), but there are {vertices}"
                );
                return Err(FormatError::new(place, cause));
            }
            _ => {}
        }
        // Elements of second order have the middles of their edges, so their faces need corners alone. Those of no element need
        // the middles that `listed` keeps.
        let is_surface = self.elements() == 0;
        for ([a, b, c, ab, bc, ca], place) in self.second_order {
            if !is_surface {
                let middles = [ab, bc, ca].map(|middle| middle as u32);
                self.listed.add_middles(self.faces.triangle_count(), middles);
            }
            let parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
            let triangles = if is_surface { &parts[..] } else { &[[a, b, c]] };
            triangles.iter().try_for_each(|corners| self.faces.push(corners, place.clone()))?;
        }
        if is_surface && vertices > 0 {
            if let Some(error) = self.unread_faces {
                return Err(error);
            }
            if self.faces.triangle_count() == 0 {
                return Err(FormatError::whole(NO_CELLS));
            }
            let (mesh, warnings) = self.faces.finish(self.parts.vertices)?.into_mesh_with_warnings()?;
            return Ok(VolumeOrSurface::Surface { mesh, warnings });
        }
        self.parts.element_material.append(&mut self.cube_material);
        self.parts.surface = self.faces.into_fans(vertices)?;
        if let Some(error) = &self.unread_faces {
            self.listed.add_unread(error);
        }
        Ok(VolumeOrSurface::Volume { mesh: VolumeMesh::new(self.parts)?, faces: self.listed })
    }
}

/// Returns a corner that occurs twice.
pub(super) fn repeated(corners: &[u64]) -> Option<u64> {
    corners.iter().enumerate().find(|(i, corner)| corners[..*i].contains(corner)).map(|(_, corner)| *corner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_vertices(count: usize) -> Builder {
        let mut builder = Builder::new(1);
        for _ in 0..count {
            builder.vertex(DVec3::ZERO, Place::Whole).unwrap();
        }
        builder
    }

    #[test]
    fn indices_are_checked_against_all_vertices() {
        for index in [4, u64::from(u32::MAX), 1 << 32, u64::MAX] {
            let mut builder = with_vertices(4);
            builder.tet([0, 1, 2, index], 0, Place::Line(7)).unwrap();
            assert_eq!(*builder.finish().unwrap_err().place(), Place::Line(7));
        }
        let mut builder = with_vertices(4);
        builder.face([0, 1, 4], Place::Line(8)).unwrap();
        assert_eq!(*builder.finish().unwrap_err().place(), Place::Line(8));
        // Polygons beside the elements of a solid.
        for index in [4, u64::from(u32::MAX), (1 << 32) + 1, u64::MAX - 1] {
            let mut builder = with_vertices(4);
            builder.tet([0, 1, 2, 3], 0, Place::Cell(0)).unwrap();
            builder.material("a");
            builder.polygon(&[0, 1, 2, index], Place::Cell(1)).unwrap();
            let message = builder.finish_any().err().unwrap().to_string();
            let vertex = index + 1;
            assert_eq!(
                message,
                format!(
                    "cell 1 (counted from 0): the face names vertex {vertex} (counted from 1), but there are 4"
                )
            );
        }
    }

    #[test]
    fn faces_without_elements_are_a_surface() {
        let mut builder = with_vertices(6);
        builder.face([0, 1, 2], Place::Whole).unwrap();
        builder.face([2, 1, 4, 5], Place::Whole).unwrap();
        let VolumeOrSurface::Surface { mesh, .. } = builder.finish_any().unwrap() else {
            panic!("a surface")
        };
        assert_eq!((mesh.rest_positions().len(), mesh.faces()), (6, &[[0, 1, 2], [2, 1, 4], [2, 4, 5]][..]));
        let mut builder = with_vertices(6);
        builder.face([0, 1, 2], Place::Whole).unwrap();
        builder.unread_faces("'TrianglesP2'", Place::Line(3));
        let refused = builder.finish_any().unwrap_err().to_string();
        assert!(
            refused.starts_with("line 3: 'TrianglesP2' is not supported: only triangles and"),
            "{refused}"
        );
        let mut builder = with_vertices(4);
        builder.unread_faces("'TrianglesP2'", Place::Line(3));
        builder.tet([0, 1, 2, 3], 0, Place::Whole).unwrap();
        builder.material("a");
        assert!(builder.finish().is_ok(), "a solid needs no faces");
    }

    #[test]
    fn repeated_corners_are_rejected() {
        let mut builder = with_vertices(4);
        let error = builder.tet([0, 3, 2, 3], 0, Place::Line(2)).unwrap_err().to_string();
        assert_eq!(error, "line 2: the element names vertex 4 (counted from 1) twice");
        assert!(builder.cube([0, 1, 2, 3, 4, 5, 6, 0], 0, Place::Whole).is_err());
        assert!(builder.face([0, 0, 1], Place::Whole).is_err());
    }

    #[test]
    fn materials_of_tetrahedra_come_first() {
        let mut builder = with_vertices(8);
        let (a, b) = (builder.material("a"), builder.default_material());
        builder.cube([0, 1, 2, 3, 4, 5, 6, 7], a, Place::Whole).unwrap();
        builder.tet([0, 1, 2, 3], b, Place::Whole).unwrap();
        builder.face([0, 1, 2, 3], Place::Whole).unwrap();
        assert_eq!(builder.material("a"), a);
        let mesh = builder.finish().unwrap();
        assert_eq!((mesh.element_material(), mesh.materials().len()), (&[b, a][..], 2));
        assert_eq!(mesh.surface(), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn repeated_elements_are_rejected() {
        let mut builder = with_vertices(5);
        for corners in [[0, 1, 2, 3], [1, 2, 3, 4], [3, 1, 0, 2]] {
            builder.tet(corners, 0, Place::Whole).unwrap();
        }
        let error = builder.finish().unwrap_err().to_string();
        assert_eq!(error, "tetrahedra 0 and 2 (counted from 0) have the same corners");
    }

    #[test]
    fn empty_meshes_and_invalid_coordinates_are_rejected() {
        assert!(with_vertices(0).finish().unwrap_err().to_string().contains("no vertices"));
        assert!(with_vertices(4).finish().unwrap_err().to_string().contains("no elements"));
        let nothing = with_vertices(4).finish_any().unwrap_err().to_string();
        assert!(
            nothing.starts_with("no cell is a triangle, a polygon, a tetrahedron or a hexahedron: save"),
            "{nothing}"
        );
        for x in [f64::NAN, f64::INFINITY, 2e60] {
            assert!(with_vertices(0).vertex(DVec3::new(0.0, x, 0.0), Place::Whole).is_err());
        }
    }
}
