//! The origin of the numbers of a body's material: the caller, the solid's file, or the default material.

use sscc_solid::{Material, PartialMaterial};

/// The origin of the numbers of a body's material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialOrigin {
    /// Text for the model's provenance.
    pub provenance: String,
    /// Requested numbers that override numbers of the file.
    pub replaced: Option<PartialMaterial>,
}

impl MaterialOrigin {
    /// Describes a material: `stated` are the numbers of a file for the materials of the body's elements, and the
    /// numbers of `given` replace them.
    pub fn new(given: &PartialMaterial, stated: &[PartialMaterial]) -> Self {
        let known = stated.iter().fold(PartialMaterial::default(), |known, stated| known.or(stated));
        let replaced = PartialMaterial {
            youngs_modulus: given.youngs_modulus.filter(|_| known.youngs_modulus.is_some()),
            poisson_ratio: given.poisson_ratio.filter(|_| known.poisson_ratio.is_some()),
            density: given.density.filter(|_| known.density.is_some()),
        };
        let default = PartialMaterial::from(Material::DEFAULT);
        let missing = PartialMaterial {
            youngs_modulus: default.youngs_modulus.filter(|_| known.youngs_modulus.is_none()),
            poisson_ratio: default.poisson_ratio.filter(|_| known.poisson_ratio.is_none()),
            density: default.density.filter(|_| known.density.is_none()),
        };
        // These numbers do not come from the file.
        let others = given.or(&missing);
        let provenance = if others == given.or(&default) {
            others.to_string()
        } else if others == PartialMaterial::default() {
            "materials of the file".into()
        } else {
            format!("materials of the file with {others}")
        };
        Self { provenance, replaced: Some(replaced).filter(|r| *r != PartialMaterial::default()) }
    }
}

#[cfg(test)]
mod tests {
    use sscc_dynamics::MATERIALS;

    use super::*;

    fn file(youngs_modulus: Option<f64>, density: Option<f64>) -> PartialMaterial {
        PartialMaterial { youngs_modulus, density, ..Default::default() }
    }

    #[test]
    fn provenance_names_the_numbers_that_are_not_from_the_file() {
        let known = |name: &str| -> PartialMaterial {
            MATERIALS.iter().find(|material| material.name == name).unwrap().elastic.into()
        };
        let [steel, glass] = ["steel", "glass"].map(known);
        let youngs = PartialMaterial { youngs_modulus: Some(3.0), ..Default::default() };
        let density = PartialMaterial { density: Some(3.0), ..Default::default() };
        let origin = |given: Option<PartialMaterial>, file: &[PartialMaterial]| {
            let given = given.unwrap_or_default();
            let MaterialOrigin { provenance, replaced } = MaterialOrigin::new(&given, file);
            (provenance, replaced.map(|replaced| replaced.to_string()))
        };
        let expected =
            |provenance: &str, replaced: Option<&str>| (provenance.into(), replaced.map(Into::into));
        let (unknown, soft) = (file(None, None), file(Some(5.0), None));
        let whole = PartialMaterial { poisson_ratio: Some(0.1), ..file(Some(5.0), Some(7.0)) };
        let usual = "youngs=1e6 poisson=0.4 density=1000";
        for file in [&[][..], &[unknown]] {
            assert_eq!(origin(None, file), expected(usual, None));
            assert_eq!(origin(Some(steel), file), expected(&steel.to_string(), None));
        }
        assert_eq!(origin(None, &[whole]), expected("materials of the file", None));
        assert_eq!(origin(Some(glass), &[whole]).1.unwrap(), "youngs=6.2e10 poisson=0.2 density=2600");
        let both = &[unknown, soft];
        assert_eq!(origin(None, both), expected("materials of the file with poisson=0.4 density=1000", None));
        assert_eq!(
            origin(Some(density), both),
            expected("materials of the file with poisson=0.4 density=3", None)
        );
        assert_eq!(
            origin(Some(youngs), both),
            expected("youngs=3e0 poisson=0.4 density=1000", Some("youngs=3e0"))
        );
    }
}
