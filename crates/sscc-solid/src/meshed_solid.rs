//! Conversion of a volumetric mesh into a solid.

use glam::DVec3;

use crate::{Material, PartialMaterial, Solid, SolidError, VolumeMesh, tets_within};

/// Solid of a volumetric mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshedSolid {
    /// The solid.
    pub solid: Solid,
    /// Vertex of the solid for each vertex of the mesh. If elements are removed, None for the vertices that belong to
    /// no other element.
    pub vertices: Vec<Option<u32>>,
    /// Properties that the mesh gives for the materials of the solid's elements.
    pub stated: Vec<PartialMaterial>,
    /// Number of removed tetrahedra: those outside of the surface that the mesh lists.
    pub outside: usize,
}

impl VolumeMesh {
    /// Returns the solid of this mesh, without tetrahedra outside of the surface that it lists ([`tets_within`]).
    /// Properties of materials are those in `given`, then those of the mesh, then those of the default material.
    ///
    /// # Errors
    /// As [`Solid::with_middles`]; when a property of a material is outside its range; when an element has a material
    /// whose stiffness is not computed, and `given` does not replace all of its stiffness.
    pub fn solid(&self, given: &PartialMaterial) -> Result<MeshedSolid, SolidError> {
        let within = tets_within(self.tets(), self.surface());
        let kept: Vec<usize> = (0..within.len()).filter(|t| within[*t]).collect();
        let outside = within.len() - kept.len();
        let tets: Vec<[u32; 4]> = kept.iter().map(|t| self.tets()[*t]).collect();
        let middles: Vec<[u32; 6]> = kept.iter().filter_map(|t| self.middles().get(*t).copied()).collect();

        // Vertices of removed elements only are removed, too.
        let mut used = vec![outside == 0; self.vertices().len()];
        let of_tets = tets.as_flattened().iter().chain(middles.as_flattened());
        of_tets.chain(self.cubes().as_flattened()).for_each(|v| used[*v as usize] = true);
        let mut count = 0;
        let mut vertices = Vec::with_capacity(used.len());
        for used in used {
            vertices.push(used.then_some(count));
            count += u32::from(used);
        }
        let number = |v: u32| vertices[v as usize].unwrap_or_default();
        let is_kept = |(p, number): (&DVec3, &Option<u32>)| number.map(|_| *p);
        let positions = self.vertices().iter().zip(&vertices).filter_map(is_kept).collect();

        let of_tets = kept.iter().map(|t| self.element_material()[*t]);
        let of_cubes = self.element_material()[within.len()..].iter().copied();
        let element_material: Vec<u32> = of_tets.chain(of_cubes).collect();
        // A file may define materials without elements.
        let mut is_used = vec![false; self.materials().len()];
        element_material.iter().for_each(|at| is_used[*at as usize] = true);
        let used =
            || self.materials().iter().zip(&is_used).filter(|(_, used)| **used).map(|(named, _)| named);
        let is_stiffness_given = given.youngs_modulus.is_some() && given.poisson_ratio.is_some();
        let unsupported = used().find_map(|named| Some((named.name.clone(), named.unsupported.clone()?)));
        if let Some((name, kind)) = unsupported.filter(|_| !is_stiffness_given) {
            return Err(SolidError::UnsupportedMaterial { name, kind });
        }
        let stated = used().map(|named| named.stated).collect();
        let materials: Result<_, _> =
            self.materials().iter().map(|named| Material::new(&given.or(&named.stated))).collect();
        let middles: Vec<[u32; 6]> = middles.iter().map(|m| m.map(number)).collect();
        let solid = Solid::with_middles(
            positions,
            tets.iter().map(|t| t.map(number)).collect(),
            &middles,
            self.cubes().iter().map(|c| c.map(number)).collect(),
            materials?,
            element_material,
        )?;
        Ok(MeshedSolid { solid, vertices, stated, outside })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MaterialError, NamedMaterial, VolumeMeshParts};

    fn named(name: &str, youngs_modulus: Option<f64>) -> NamedMaterial {
        NamedMaterial {
            name: name.into(),
            stated: PartialMaterial { youngs_modulus, ..PartialMaterial::default() },
            unsupported: None,
        }
    }

    /// Two tetrahedra on either side of a face, of two materials; a third material has no element.
    fn mesh(surface: &[[u32; 3]]) -> VolumeMesh {
        let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1]];
        let parts = VolumeMeshParts {
            vertices: corners.map(|c| DVec3::from_array(c.map(f64::from))).to_vec(),
            tets: vec![[0, 2, 1, 4], [0, 1, 2, 3]],
            middles: vec![],
            cubes: vec![],
            surface: surface.to_vec(),
            materials: vec![named("soft", Some(5.0)), named("none", Some(7.0)), named("silent", None)],
            element_material: vec![0, 2],
        };
        VolumeMesh::new(parts).unwrap()
    }

    #[test]
    fn a_solid_has_all_elements_with_their_materials() {
        let given = PartialMaterial { density: Some(3.0), ..PartialMaterial::default() };
        let MeshedSolid { solid, vertices, stated, outside } = mesh(&[]).solid(&given).unwrap();
        assert_eq!((solid.tets().len(), outside), (2, 0));
        assert_eq!(vertices, [0, 1, 2, 3, 4].map(Some));
        assert_eq!(stated.iter().map(|m| m.youngs_modulus).collect::<Vec<_>>(), [Some(5.0), None]);
        let numbers = |k: usize| {
            let material = solid.element(k).material;
            (material.youngs_modulus(), material.density(), material.poisson_ratio())
        };
        assert_eq!((numbers(0), numbers(1)), ((5.0, 3.0, 0.4), (1e6, 3.0, 0.4)));
    }

    #[test]
    fn elements_outside_of_the_listed_surface_are_removed() {
        // The surface of the second tetrahedron.
        let surface = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let found = mesh(&surface).solid(&PartialMaterial::default()).unwrap();
        assert_eq!((found.solid.tets(), found.outside), (&[[0, 1, 2, 3]][..], 1));
        assert_eq!(found.vertices, [Some(0), Some(1), Some(2), Some(3), None]);
        assert_eq!(found.stated, [PartialMaterial::default()]);
    }

    #[test]
    fn materials_whose_stiffness_is_not_computed_need_another_one() {
        let unsupported = |at: usize| {
            let mesh = mesh(&[]);
            let mut materials = mesh.materials().to_vec();
            materials[at].unsupported = Some("ORTHOTROPIC".into());
            let of_element = mesh.element_material().to_vec();
            mesh.with_materials(materials, of_element).unwrap()
        };
        let default = PartialMaterial::default();
        let refused = unsupported(2).solid(&default).unwrap_err();
        assert_eq!(
            refused,
            SolidError::UnsupportedMaterial { name: "silent".into(), kind: "ORTHOTROPIC".into() }
        );
        let youngs = PartialMaterial { youngs_modulus: Some(2.0), ..default };
        assert!(unsupported(0).solid(&youngs).is_err(), "Poisson's ratio is missing");
        let both = PartialMaterial { poisson_ratio: Some(0.3), ..youngs };
        let found = unsupported(0).solid(&both).unwrap();
        assert_eq!(found.solid.element(0).material.youngs_modulus(), 2.0);
        // A material without elements.
        assert!(unsupported(1).solid(&default).is_ok());
    }

    #[test]
    fn properties_of_all_materials_are_checked() {
        let given = PartialMaterial { poisson_ratio: Some(0.5), ..PartialMaterial::default() };
        let rejected = mesh(&[]).solid(&given).unwrap_err();
        assert!(matches!(rejected, SolidError::Material(MaterialError { what: "Poisson's ratio", .. })));
    }
}
