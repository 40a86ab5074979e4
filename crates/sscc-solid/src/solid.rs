//! Elastic solids: elements of positive volume with materials.

use std::collections::HashMap;

use glam::DVec3;
use sscc::limits;

use crate::element::{Element, cube_is_inverted};
use crate::second_order::{self, EDGES};
use crate::{Material, SolidError};

/// Minimum of six times the volume of a tetrahedron over its longest edge cubed. Below it, the stiffness is rounding.
const MIN_RELATIVE_VOLUME: f64 = 1e-10;

/// Elastic solid: tetrahedra (all of first or all of second order) and hexahedra ("cubes") of positive volume, each with a
/// material. Every vertex belongs to an element.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    vertices: Vec<DVec3>,
    tets: Vec<[u32; 4]>,
    /// All nodes of each tetrahedron; empty for tetrahedra of first order.
    tets10: Vec<[u32; 10]>,
    cubes: Vec<[u32; 8]>,
    fill: Vec<[f64; 8]>,
    materials: Vec<Material>,
    element_material: Vec<u32>,
}

impl Solid {
    /// Creates a solid. Elements index `vertices` (rest positions, model unit). The corners of a cube are ordered as
    /// for the unit cube 000, 100, 110, 010 (xyz), then 001, 101, 111, 011. Each element has a material, tetrahedra
    /// first. If all tetrahedra have a negative volume, the constructor reverses all of them.
    ///
    /// # Errors
    /// When there is no element, an element has no material, an index is out of range, a coordinate is beyond
    /// [`sscc::limits`], a vertex belongs to no element, or an element is flat or inverted.
    pub fn new(
        vertices: Vec<DVec3>,
        tets: Vec<[u32; 4]>,
        cubes: Vec<[u32; 8]>,
        materials: Vec<Material>,
        element_material: Vec<u32>,
    ) -> Result<Self, SolidError> {
        Self::with_middles(vertices, tets, &[], cubes, materials, element_material)
    }

    /// Creates a solid whose tetrahedra are of second order: `middles` are the vertices in the middle of the edges of each
    /// tetrahedron, between its corners 0 1, 1 2, 0 2, 0 3, 2 3 and 1 3. Without middles, tetrahedra are of first order.
    ///
    /// # Errors
    /// As [`Solid::new`]; when there are not middles for all tetrahedra, tetrahedra with a common edge have different ones,
    /// or a tetrahedron is inverted at a node or an integration point.
    pub fn with_middles(
        vertices: Vec<DVec3>,
        tets: Vec<[u32; 4]>,
        middles: &[[u32; 6]],
        cubes: Vec<[u32; 8]>,
        materials: Vec<Material>,
        element_material: Vec<u32>,
    ) -> Result<Self, SolidError> {
        check_middles(&tets, middles).map_err(|error| match error {
            SolidError::DifferentMiddles { .. } => {
                exchanged_middles(&vertices, &tets, middles).unwrap_or(error)
            }
            error => error,
        })?;
        let nodes = |(tet, middles): (&[u32; 4], &[u32; 6])| {
            std::array::from_fn(|k| if k < 4 { tet[k] } else { middles[k - 4] })
        };
        let tets10 = tets.iter().zip(middles).map(nodes).collect();
        let fill = vec![[1.0; 8]; cubes.len()];
        Self { vertices, tets, tets10, cubes, fill, materials, element_material }.checked()
    }

    /// Creates a solid with one material.
    ///
    /// # Errors
    /// As [`Solid::new`].
    pub fn uniform(
        vertices: Vec<DVec3>,
        tets: Vec<[u32; 4]>,
        cubes: Vec<[u32; 8]>,
        material: Material,
    ) -> Result<Self, SolidError> {
        let elements = tets.len() + cubes.len();
        Self::new(vertices, tets, cubes, vec![material], vec![0; elements])
    }

    /// Creates a solid of cubes with one material, in which a share of each octant (at corner k) is filled. The share
    /// scales mass and stiffness.
    ///
    /// # Errors
    /// As [`Solid::new`], and when there are not eight shares from 0 to 1 for each cube.
    pub fn filled(
        vertices: Vec<DVec3>,
        cubes: Vec<[u32; 8]>,
        fill: Vec<[f64; 8]>,
        material: Material,
    ) -> Result<Self, SolidError> {
        let is_share = |share: &f64| (0.0..=1.0).contains(share);
        if fill.len() != cubes.len() || !fill.as_flattened().iter().all(is_share) {
            return Err(SolidError::Fill { cubes: cubes.len() });
        }
        let element_material = vec![0; cubes.len()];
        let (tets, tets10) = (Vec::new(), Vec::new());
        Self { vertices, tets, tets10, cubes, fill, materials: vec![material], element_material }.checked()
    }

    /// Checks all data, and orients the tetrahedra.
    ///
    /// # Errors
    /// As [`Solid::new`].
    fn checked(mut self) -> Result<Self, SolidError> {
        let Self { vertices, tets, tets10, cubes, materials, element_material, .. } = &mut self;
        let elements = tets.len() + cubes.len();
        if elements == 0 {
            return Err(SolidError::NoElements);
        }
        let known = |m: &u32| (*m as usize) < materials.len();
        if element_material.len() != elements || !element_material.iter().all(known) {
            return Err(SolidError::ElementMaterials { elements, found: element_material.len() });
        }
        let mut used = vec![false; vertices.len()];
        let corners = tets.as_flattened().iter().chain(cubes.as_flattened());
        for index in corners.chain(tets10.as_flattened()) {
            match used.get_mut(*index as usize) {
                Some(used) => *used = true,
                None => return Err(SolidError::ElementIndex { index: *index, vertices: vertices.len() }),
            }
        }
        if let Some(vertex) = used.iter().position(|used| !used) {
            return Err(SolidError::OrphanVertex { vertex });
        }
        for (vertex, p) in vertices.iter().enumerate() {
            if !limits::contains(*p) {
                return Err(SolidError::Vertex { vertex });
            }
        }
        if orient(vertices, tets)? {
            // The tetrahedra have exchanged corners 2 and 3, so their nodes must be exchanged in the same way.
            let reversed = [0, 1, 3, 2, 4, 9, 7, 6, 8, 5];
            tets10.iter_mut().for_each(|nodes| *nodes = reversed.map(|k| nodes[k]));
        }
        for (tet, nodes) in tets10.iter().enumerate() {
            if second_order::is_inverted(&nodes.map(|v| vertices[v as usize])) {
                let corners = tets[tet];
                return Err(
                    match second_order::has_exchanged_middles(&nodes.map(|v| vertices[v as usize])) {
                        true => SolidError::ExchangedMiddles { tet, corners },
                        false => SolidError::InvertedSecondOrderTet { tet, corners },
                    },
                );
            }
        }
        for (cube, corners) in cubes.iter().enumerate() {
            let corners = corners.map(|v| vertices[v as usize]);
            if cube_is_inverted(&corners) {
                return Err(SolidError::InvertedCube { cube });
            }
        }
        Ok(self)
    }

    /// Returns the rest positions (model unit).
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Returns the corners of each tetrahedron; all have positive volume.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// Returns all nodes of each tetrahedron of second order: its corners, then the middles of its edges as in
    /// [`Solid::with_middles`]. Empty for tetrahedra of first order.
    pub fn tets10(&self) -> &[[u32; 10]] {
        &self.tets10
    }

    /// Returns the corners of each cube.
    pub fn cubes(&self) -> &[[u32; 8]] {
        &self.cubes
    }

    /// Returns the materials, and the number of that of each element.
    pub(crate) fn materials(&self) -> (&[Material], &[u32]) {
        (&self.materials, &self.element_material)
    }

    /// Returns the number of elements.
    pub fn element_count(&self) -> usize {
        self.tets.len() + self.cubes.len()
    }

    /// Returns an element by its number, tetrahedra first.
    ///
    /// # Panics
    /// When the element does not exist.
    pub fn element(&self, index: usize) -> Element<'_> {
        let material = &self.materials[self.element_material[index] as usize];
        if let Some(nodes) = self.tets10.get(index) {
            return Element::second_order(nodes, &nodes.map(|v| self.vertices[v as usize]), material);
        }
        if let Some(tet) = self.tets.get(index) {
            return Element::tet(tet, tet.map(|v| self.vertices[v as usize]), material);
        }
        let index = index - self.tets.len();
        let cube = &self.cubes[index];
        let corners = cube.map(|v| self.vertices[v as usize]);
        Element::cube(cube, &corners, &self.fill[index], material)
    }
}

/// Returns the error for the first tetrahedron whose middle nodes are exchanged, if there is one.
fn exchanged_middles(vertices: &[DVec3], tets: &[[u32; 4]], middles: &[[u32; 6]]) -> Option<SolidError> {
    let is_exchanged = |(tet, middles): (&[u32; 4], &[u32; 6])| {
        let mut nodes = [DVec3::ZERO; 10];
        for (node, vertex) in nodes.iter_mut().zip(tet.iter().chain(middles)) {
            *node = *vertices.get(*vertex as usize)?;
        }
        second_order::has_exchanged_middles(&nodes).then_some(())
    };
    let tet = tets.iter().zip(middles).position(|nodes| is_exchanged(nodes).is_some())?;
    Some(SolidError::ExchangedMiddles { tet, corners: tets[tet] })
}

fn check_middles(tets: &[[u32; 4]], middles: &[[u32; 6]]) -> Result<(), SolidError> {
    if !middles.is_empty() && middles.len() != tets.len() {
        return Err(SolidError::MixedOrders { tets: tets.len(), second_order: middles.len() });
    }
    let mut of_edge = HashMap::new();
    for (corners, middles) in tets.iter().zip(middles) {
        for (edge, middle) in EDGES.iter().zip(middles) {
            let mut edge = edge.map(|k| corners[k]);
            edge.sort_unstable();
            let known = *of_edge.entry(edge).or_insert(*middle);
            if known != *middle {
                return Err(SolidError::DifferentMiddles { edge, middles: [known, *middle] });
            }
        }
    }
    Ok(())
}

/// Returns six times the volume of a tetrahedron.
fn sixfold_volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a)
}

/// Reverses all tetrahedra if all are negative, by an exchange of their corners 2 and 3; returns whether it did. Returns an
/// error if one is flat or only some are negative.
fn orient(vertices: &[DVec3], tets: &mut [[u32; 4]]) -> Result<bool, SolidError> {
    let mut negative = Vec::new();
    for (tet, corners) in tets.iter().enumerate() {
        let p = corners.map(|v| vertices[v as usize]);
        let longest = (0..4).flat_map(|i| (0..i).map(move |j| p[i].distance(p[j]))).fold(0.0, f64::max);
        let volume = sixfold_volume(p);
        // NaN (an overflow) is flat, too.
        if volume.is_nan() || volume.abs() <= MIN_RELATIVE_VOLUME * longest * longest * longest {
            return Err(SolidError::FlatTet { tet, corners: *corners });
        }
        if volume < 0.0 {
            negative.push(tet);
        }
    }
    if !tets.is_empty() && negative.len() == tets.len() {
        tets.iter_mut().for_each(|corners| corners.swap(2, 3));
        return Ok(true);
    } else if let Some(tet) = negative.first() {
        // The smaller group counts as inverted.
        let minority = if 2 * negative.len() <= tets.len() {
            *tet
        } else {
            (0..tets.len()).find(|t| negative.binary_search(t).is_err()).unwrap_or(*tet)
        };
        let count = negative.len().min(tets.len() - negative.len());
        return Err(SolidError::InvertedTet { tet: minority, corners: tets[minority], count });
    }
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_solids_are_rejected() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let corners = vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.), p(1., 1., 1.)];
        let good = Material::default();
        let message = |vertices: &[DVec3], tets: Vec<[u32; 4]>| {
            Solid::uniform(vertices.to_vec(), tets, vec![], good).unwrap_err().to_string()
        };
        assert!(message(&corners, vec![]).contains("no element"));
        assert!(message(&corners, vec![[0, 1, 2, 9]]).contains("names vertex 9"));
        assert!(
            message(&corners, vec![[0, 1, 2, 3]])
                .contains("vertex 4 (counted from 0) of the solid belongs to no element")
        );
        assert!(
            message(&corners, vec![[0, 1, 2, 3], [1, 2, 3, 4], [1, 2, 4, 3]])
                .contains("is inverted, one of 1")
        );
        let flat = [p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(1., 1., 1e-14)];
        assert!(
            message(&flat, vec![[0, 1, 2, 3]])
                .contains("tetrahedron 0 (counted from 0, vertices [0, 1, 2, 3]) is flat")
        );
        let nan = [p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(f64::NAN, 1., 1.)];
        assert!(
            message(&nan, vec![[0, 1, 2, 3]])
                .contains("vertex 3 (counted from 0) of the solid has a coordinate")
        );
        // If all volumes are negative, the file uses the opposite convention.
        assert!(Solid::uniform(corners[..4].to_vec(), vec![[0, 2, 1, 3]], vec![], good).is_ok());
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let mut corners = corners.map(|c| DVec3::from_array(c.map(f64::from))).to_vec();
        let cube = vec![[0, 1, 2, 3, 4, 5, 6, 7]];
        assert!(Solid::uniform(corners.clone(), vec![], cube.clone(), good).is_ok());
        for wrong in [vec![], vec![[1.0; 8]; 2], vec![[-0.1; 8]], vec![[f64::NAN; 8]], vec![[1.5; 8]]] {
            let rejected = Solid::filled(corners.clone(), cube.clone(), wrong, good);
            assert_eq!(rejected.unwrap_err(), SolidError::Fill { cubes: 1 });
        }
        corners.swap(0, 7);
        let twisted = Solid::uniform(corners, vec![], cube, good);
        assert_eq!(twisted.unwrap_err(), SolidError::InvertedCube { cube: 0 });
    }
}
