//! Elastic solids: volumetric meshes with a material.

use glam::DVec3;
use sscc::limits;

use crate::ModesError;

/// A tetrahedron whose volume is below this share of its longest edge cubed is flat: its stiffness would be rounding.
const FLAT: f64 = 1e-10;

/// A linear isotropic elastic material, in any consistent units; in SI units frequencies come out in Hz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Mass per volume (kg/m^3), above 0.
    pub density: f64,
    /// Young's modulus (N/m^2), above 0.
    pub youngs_modulus: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson_ratio: f64,
}

impl Default for Material {
    /// Firm rubber: 1,000 kg/m^3, 1e6 N/m^2, 0.4. Shapes of modes depend on Poisson's ratio alone.
    fn default() -> Self {
        Self { density: 1000.0, youngs_modulus: 1e6, poisson_ratio: 0.4 }
    }
}

impl Material {
    /// Lamé's first parameter (N/m^2).
    pub(crate) fn lame_lambda(&self) -> f64 {
        let nu = self.poisson_ratio;
        self.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Lamé's second parameter, the shear modulus (N/m^2).
    pub(crate) fn lame_mu(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// # Errors
    /// When a number is outside what a material can have.
    pub(crate) fn check(&self) -> Result<(), ModesError> {
        let bad = |what, value, range| Err(ModesError::Material { what, value, range });
        let positive = |x: f64| (1e-60..=1e60).contains(&x);
        if !positive(self.density) {
            return bad("density", self.density, "above 0 (1e-60 to 1e60)");
        }
        if !positive(self.youngs_modulus) {
            return bad("Young's modulus", self.youngs_modulus, "above 0 (1e-60 to 1e60)");
        }
        // At 0.5 the material is incompressible and its stiffness infinite.
        if !(self.poisson_ratio > -0.9999 && self.poisson_ratio < 0.4999) {
            return bad("Poisson's ratio", self.poisson_ratio, "above -0.9999 and below 0.4999");
        }
        Ok(())
    }
}

/// A volumetric mesh of tetrahedra and hexahedra ("cubes"), each of one material. Checked: what has a stiffness here
/// has a sound one.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    vertices: Vec<DVec3>,
    tets: Vec<[u32; 4]>,
    cubes: Vec<[u32; 8]>,
    fill: Vec<[f64; 8]>,
    materials: Vec<Material>,
    element_material: Vec<u32>,
}

impl Solid {
    /// Elements index `vertices` (rest positions, model unit). The corners of a cube are ordered as for the unit cube
    /// 000, 100, 110, 010 (xyz), then 001, 101, 111, 011. Each element has a material, tetrahedra first. Where all
    /// tetrahedra have a negative volume, the order of their corners is another convention, and they are turned.
    ///
    /// # Errors
    /// When there is no element, an index is out of range, a coordinate is beyond [`sscc::limits`], a vertex belongs
    /// to no element, an element is flat or inverted, or a material is outside physical limits.
    pub fn new(
        vertices: Vec<DVec3>,
        tets: Vec<[u32; 4]>,
        cubes: Vec<[u32; 8]>,
        materials: Vec<Material>,
        element_material: Vec<u32>,
    ) -> Result<Self, ModesError> {
        let fill = vec![[1.0; 8]; cubes.len()];
        Self::filled(vertices, tets, cubes, fill, materials, element_material)
    }

    /// The same of one material.
    ///
    /// # Errors
    /// As [`Solid::new`].
    pub fn uniform(
        vertices: Vec<DVec3>,
        tets: Vec<[u32; 4]>,
        cubes: Vec<[u32; 8]>,
        material: Material,
    ) -> Result<Self, ModesError> {
        let elements = tets.len() + cubes.len();
        Self::new(vertices, tets, cubes, vec![material], vec![0; elements])
    }

    /// As [`Solid::new`], with the share of each cube's octants (at corner k) that is filled: mass and stiffness count
    /// by that share.
    pub(crate) fn filled(
        vertices: Vec<DVec3>,
        mut tets: Vec<[u32; 4]>,
        cubes: Vec<[u32; 8]>,
        fill: Vec<[f64; 8]>,
        materials: Vec<Material>,
        element_material: Vec<u32>,
    ) -> Result<Self, ModesError> {
        let elements = tets.len() + cubes.len();
        if elements == 0 {
            return Err(ModesError::NoElements);
        }
        materials.iter().try_for_each(Material::check)?;
        let known = |m: &u32| (*m as usize) < materials.len();
        if element_material.len() != elements || !element_material.iter().all(known) {
            return Err(ModesError::ElementMaterials { elements, found: element_material.len() });
        }
        let mut used = vec![false; vertices.len()];
        for index in tets.as_flattened().iter().chain(cubes.as_flattened()) {
            match used.get_mut(*index as usize) {
                Some(used) => *used = true,
                None => return Err(ModesError::ElementIndex { index: *index, vertices: vertices.len() }),
            }
        }
        if let Some(vertex) = used.iter().position(|used| !used) {
            return Err(ModesError::OrphanVertex { vertex });
        }
        for (vertex, p) in vertices.iter().enumerate() {
            if !p.to_array().iter().all(|x| x.abs() <= limits::LARGEST) {
                return Err(ModesError::SolidVertex { vertex });
            }
        }
        orient(&vertices, &mut tets)?;
        let solid = Self { vertices, tets, cubes, fill, materials, element_material };
        for (cube, corners) in solid.cubes.iter().enumerate() {
            let corners = corners.map(|v| solid.vertices[v as usize]);
            if crate::elasticity::cube_is_inverted(&corners) {
                return Err(ModesError::InvertedCube { cube });
            }
        }
        Ok(solid)
    }

    /// Rest positions (model unit).
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Corners of each tetrahedron; all have positive volume.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// Corners of each cube.
    pub fn cubes(&self) -> &[[u32; 8]] {
        &self.cubes
    }

    /// The filled share of each cube's octants.
    pub(crate) fn fill(&self) -> &[[f64; 8]] {
        &self.fill
    }

    /// The material of an element, tetrahedra first.
    pub(crate) fn material(&self, element: usize) -> &Material {
        &self.materials[self.element_material[element] as usize]
    }
}

/// Six times the volume of a tetrahedron.
fn sixfold_volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a)
}

/// Turns all tetrahedra if all are negative; an error if one is flat or only some are negative.
fn orient(vertices: &[DVec3], tets: &mut [[u32; 4]]) -> Result<(), ModesError> {
    let mut negative = Vec::new();
    for (tet, corners) in tets.iter().enumerate() {
        let p = corners.map(|v| vertices[v as usize]);
        let longest = (0..4).flat_map(|i| (0..i).map(move |j| p[i].distance(p[j]))).fold(0.0, f64::max);
        let volume = sixfold_volume(p);
        // NaN (an overflow) is flat, too.
        if volume.is_nan() || volume.abs() <= FLAT * longest * longest * longest {
            return Err(ModesError::FlatTet { tet, corners: *corners });
        }
        if volume < 0.0 {
            negative.push(tet);
        }
    }
    if negative.len() == tets.len() {
        tets.iter_mut().for_each(|corners| corners.swap(2, 3));
    } else if let Some(tet) = negative.first() {
        // The fewer are wrong.
        let minority = if 2 * negative.len() <= tets.len() {
            *tet
        } else {
            (0..tets.len()).find(|t| negative.binary_search(t).is_err()).unwrap_or(*tet)
        };
        let count = negative.len().min(tets.len() - negative.len());
        return Err(ModesError::InvertedTet { tet: minority, corners: tets[minority], count });
    }
    Ok(())
}
