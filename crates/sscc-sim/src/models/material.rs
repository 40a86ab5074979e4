//! The material of a body: the requested numbers, else those of the solid's file, else the default ones.

use std::fmt;

use sscc_modes::Material;

/// A requested material. Each number may be left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RequestedMaterial {
    /// Young's modulus (N/m^2).
    pub youngs: Option<f64>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// Mass per volume (kg/m^3).
    pub density: Option<f64>,
}

impl From<Material> for RequestedMaterial {
    fn from(material: Material) -> Self {
        let Material { density, youngs_modulus, poisson_ratio } = material;
        Self { youngs: Some(youngs_modulus), poisson: Some(poisson_ratio), density: Some(density) }
    }
}

impl RequestedMaterial {
    /// The material of a body whose file names none.
    pub fn alone(&self) -> Material {
        self.over(&sscc_io::Material::default())
    }

    /// The material of elements whose file names one. Requested numbers go first.
    pub fn over(&self, file: &sscc_io::Material) -> Material {
        let usual = Material::default();
        Material {
            density: self.density.or(file.density).unwrap_or(usual.density),
            youngs_modulus: self.youngs.or(file.youngs_modulus).unwrap_or(usual.youngs_modulus),
            poisson_ratio: self.poisson.or(file.poisson_ratio).unwrap_or(usual.poisson_ratio),
        }
    }
}

/// The numbers, as in `youngs=1e6 poisson=0.4 density=1000`.
impl fmt::Display for RequestedMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = [
            self.youngs.map(|x| format!("youngs={x:e}")),
            self.poisson.map(|x| format!("poisson={x}")),
            self.density.map(|x| format!("density={x}")),
        ];
        f.write_str(&numbers.into_iter().flatten().collect::<Vec<_>>().join(" "))
    }
}

/// Where the numbers of a body's material come from.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialOrigin {
    /// For the model's provenance.
    pub provenance: String,
    /// Requested numbers that override numbers of the file.
    pub replaced: Option<RequestedMaterial>,
}

impl MaterialOrigin {
    /// `file` holds the materials that a file names for the body's elements.
    pub fn new(asked: &RequestedMaterial, file: &[&sscc_io::Material]) -> Self {
        let names = |number: fn(&sscc_io::Material) -> Option<f64>| file.iter().any(|m| number(m).is_some());
        let (youngs, poisson, density) =
            (names(|m| m.youngs_modulus), names(|m| m.poisson_ratio), names(|m| m.density));
        let replaced = RequestedMaterial {
            youngs: asked.youngs.filter(|_| youngs),
            poisson: asked.poisson.filter(|_| poisson),
            density: asked.density.filter(|_| density),
        };
        let usual = Material::default();
        let beside = RequestedMaterial {
            youngs: asked.youngs.or((!youngs).then_some(usual.youngs_modulus)),
            poisson: asked.poisson.or((!poisson).then_some(usual.poisson_ratio)),
            density: asked.density.or((!density).then_some(usual.density)),
        };
        let provenance = if beside == asked.alone().into() {
            beside.to_string()
        } else if beside == RequestedMaterial::default() {
            "materials of the file".into()
        } else {
            format!("materials of the file with {beside}")
        };
        Self { provenance, replaced: Some(replaced).filter(|r| *r != RequestedMaterial::default()) }
    }
}

#[cfg(test)]
mod tests {
    use sscc_dynamics::MATERIALS;

    use super::*;

    fn file(youngs_modulus: Option<f64>, density: Option<f64>) -> sscc_io::Material {
        sscc_io::Material { youngs_modulus, density, ..Default::default() }
    }

    #[test]
    fn what_was_asked_for_goes_before_the_file_and_the_file_before_the_default() {
        let usual = Material::default();
        let soft = file(Some(5.0), Some(7.0));
        let asked = RequestedMaterial { youngs: Some(3.0), ..Default::default() };
        let expected = Material { youngs_modulus: 3.0, density: 7.0, poisson_ratio: usual.poisson_ratio };
        assert_eq!(asked.over(&soft), expected);
        assert_eq!(asked.alone(), Material { youngs_modulus: 3.0, ..usual });
        assert_eq!(RequestedMaterial::default().alone(), usual);
    }

    #[test]
    fn provenance_tells_the_numbers_that_are_not_from_the_file() {
        let known = |name: &str| -> RequestedMaterial {
            MATERIALS.iter().find(|material| material.name == name).unwrap().elastic.into()
        };
        let [steel, glass] = ["steel", "glass"].map(known);
        let youngs = RequestedMaterial { youngs: Some(3.0), ..Default::default() };
        let density = RequestedMaterial { density: Some(3.0), ..Default::default() };
        let origin = |asked: Option<RequestedMaterial>, file: &[&sscc_io::Material]| {
            let asked = asked.unwrap_or_default();
            let MaterialOrigin { provenance, replaced } = MaterialOrigin::new(&asked, file);
            (provenance, replaced.map(|replaced| replaced.to_string()))
        };
        let told = |provenance: &str, replaced: Option<&str>| (provenance.into(), replaced.map(Into::into));
        let (silent, soft) = (file(None, None), file(Some(5.0), None));
        let whole = sscc_io::Material { poisson_ratio: Some(0.1), ..file(Some(5.0), Some(7.0)) };
        let usual = "youngs=1e6 poisson=0.4 density=1000";
        for file in [&[][..], &[&silent]] {
            assert_eq!(origin(None, file), told(usual, None));
            assert_eq!(origin(Some(steel), file), told(&steel.to_string(), None));
        }
        assert_eq!(origin(None, &[&whole]), told("materials of the file", None));
        assert_eq!(origin(Some(glass), &[&whole]).1.unwrap(), "youngs=6.2e10 poisson=0.2 density=2600");
        let both = &[&silent, &soft];
        assert_eq!(origin(None, both), told("materials of the file with poisson=0.4 density=1000", None));
        assert_eq!(
            origin(Some(density), both),
            told("materials of the file with poisson=0.4 density=3", None)
        );
        assert_eq!(
            origin(Some(youngs), both),
            told("youngs=3e0 poisson=0.4 density=1000", Some("youngs=3e0"))
        );
    }
}
