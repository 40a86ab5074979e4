//! Solids: volumetric meshes of tetrahedra and cubes, from files of Medit, VegaFEM, gmsh and TetGen.
//!
//! Every vertex of the file is kept, in the file's order, used by an element or not. Elements keep the file's
//! order among their kind, and the order of their corners. What is read is checked as far as it can be without
//! geometry: numbers, indices, corners named twice, elements listed twice. Whether elements are inverted, flat or
//! overlap is *not* looked at: that is a question for whoever gives them a stiffness.
//!
//! Second-order elements, prisms and pyramids are refused, never left out: a body would have holes.

mod builder;
pub mod gmsh;
pub mod medit;
mod statements;
pub mod tetgen;
pub mod vega;
mod words;

use std::path::Path;

use glam::DVec3;

use crate::IoError;
use crate::file::{ending, read_whole, unsupported};

/// The endings that [`read_solid`] knows.
const SUPPORTED: &str = ".mesh (Medit), .veg (VegaFEM), .msh (gmsh), .node and .ele (TetGen)";

/// The name of the material of elements about which the file says nothing.
const DEFAULT: &str = "default";

/// A volumetric mesh. Indices count from 0. Lengths are in the file's unit, which no format states.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Rest positions, within [`sscc::limits`], at least one.
    pub vertices: Vec<DVec3>,
    /// The corners of each tetrahedron, four different vertices. Most files order them such that `(b - a) x
    /// (c - a)` points to d, but nothing here looks.
    pub tets: Vec<[u32; 4]>,
    /// The corners of each cube (hexahedron), eight different vertices in VegaFEM's order: for the unit cube 000,
    /// 100, 110, 010 (xyz), then 001, 101, 111, 011. Medit and gmsh have the same order. There is at least one
    /// tetrahedron or cube.
    pub cubes: Vec<[u32; 8]>,
    /// The faces that the file lists beside the elements: maybe none, maybe some that lie inside. Quadrilaterals
    /// become two triangles, fanned from their first corner.
    pub surface: Vec<[u32; 3]>,
    /// At least one.
    pub materials: Vec<Material>,
    /// The index of each element's material: those of the tetrahedra, then those of the cubes.
    pub element_material: Vec<u32>,
}

/// A linear isotropic material, as far as the file knows it. Units are the file's; SI in all files of VegaFEM.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Material {
    /// Its name in the file; the reference number of formats that only have numbers; else `default`.
    pub name: String,
    /// Mass per volume (kg/m^3), above 0.
    pub density: Option<f64>,
    /// Young's modulus (N/m^2), above 0.
    pub youngs_modulus: Option<f64>,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson_ratio: Option<f64>,
}

impl Material {
    /// A name of which nothing more is known.
    fn named(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }
}

/// Reads a volumetric mesh; the format goes by the file name's ending, in any case: `.mesh` ([`medit`]), `.veg`
/// ([`vega`]), `.msh` ([`gmsh`]), `.node` or `.ele` with the other beside it ([`tetgen`]).
///
/// # Errors
/// When the ending is none of these, or the file (or one that belongs to it) cannot be read or is malformed; when
/// a coordinate is beyond [`sscc::limits`], an index names no vertex, an element names a vertex twice, is there
/// twice or is of another kind than 4-node tetrahedra and 8-node hexahedra, or there is no element.
pub fn read_solid(path: &Path) -> Result<Solid, IoError> {
    let parse = match ending(path).as_str() {
        "mesh" => medit::parse,
        "msh" => gmsh::parse,
        "veg" => return vega::read(path),
        "node" | "ele" => return tetgen::read(path),
        _ => return Err(unsupported(path, "volumetric mesh", SUPPORTED)),
    };
    parse(&read_whole(path)?).map_err(|error| error.of(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_decides() {
        let directory = tempfile::tempdir().unwrap();
        let message = |name: &str| {
            let path = directory.path().join(name);
            std::fs::write(&path, "x\n").unwrap();
            read_solid(&path).unwrap_err().to_string()
        };
        assert!(message("a.MESH").contains("line 1: a Medit file begins with"));
        assert!(message("a.msh").contains("line 1: a gmsh file begins with"));
        assert!(message("a.veg").contains("line 1: a section"));
        assert!(message("a.stl").contains("unknown kind of volumetric mesh file; supported: .mesh (Medit)"));
        for name in ["b.msh", "b.stl"] {
            let missing = read_solid(&directory.path().join(name)).unwrap_err().to_string();
            assert!(missing.ends_with(&format!("{name}: not found")), "{missing}");
        }
    }
}
