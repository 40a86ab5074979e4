//! What a body is made of: what was asked for, else what the solid's file says, else the default material.

use std::fmt;

use anyhow::{Result, bail};
use sscc_dynamics::MATERIALS;
use sscc_modes::Material;

/// A material as it was asked for. Each number may be left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AskedMaterial {
    /// Young's modulus (N/m^2).
    pub youngs: Option<f64>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// Mass per volume (kg/m^3).
    pub density: Option<f64>,
}

impl From<Material> for AskedMaterial {
    fn from(material: Material) -> Self {
        let Material { density, youngs_modulus, poisson_ratio } = material;
        Self { youngs: Some(youngs_modulus), poisson: Some(poisson_ratio), density: Some(density) }
    }
}

impl AskedMaterial {
    /// The name of a material, or `youngs=1e6,poisson=0.4,density=1000`, any of them.
    pub fn parse(typed: &str) -> Result<Self> {
        if let Some(known) = MATERIALS.iter().find(|material| material.name == typed.trim()) {
            return Ok(known.elastic.into());
        }
        let mut asked = Self::default();
        for part in typed.split(',') {
            let (name, number) = part.split_once('=').unwrap_or((part, ""));
            let slot = match name.trim() {
                "youngs" => &mut asked.youngs,
                "poisson" => &mut asked.poisson,
                "density" => &mut asked.density,
                _ => return unknown(part),
            };
            let Ok(number) = number.trim().parse() else { return unknown(part) };
            *slot = Some(number);
        }
        Ok(asked)
    }

    /// The material of a body whose file names none.
    pub fn alone(&self) -> Material {
        self.over(&sscc_io::Material::default())
    }

    /// The material of elements whose file names one. What was asked for goes first.
    pub fn over(&self, file: &sscc_io::Material) -> Material {
        let usual = Material::default();
        Material {
            density: self.density.or(file.density).unwrap_or(usual.density),
            youngs_modulus: self.youngs.or(file.youngs_modulus).unwrap_or(usual.youngs_modulus),
            poisson_ratio: self.poisson.or(file.poisson_ratio).unwrap_or(usual.poisson_ratio),
        }
    }
}

fn unknown<T>(part: &str) -> Result<T> {
    bail!(
        "--material: '{part}' is neither youngs=E, poisson=NU or density=RHO nor a known material ({})",
        MATERIALS.map(|material| material.name).join(", ")
    )
}

/// The numbers, as in `youngs=1e6 poisson=0.4 density=1000`.
impl fmt::Display for AskedMaterial {
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
pub struct Origin {
    /// For the model's provenance.
    pub provenance: String,
    /// What was asked for in place of what the file says.
    pub replaced: Option<AskedMaterial>,
}

impl Origin {
    /// `file` holds the materials that a file names for the body's elements.
    pub fn new(asked: &AskedMaterial, file: &[&sscc_io::Material]) -> Self {
        let names = |number: fn(&sscc_io::Material) -> Option<f64>| file.iter().any(|m| number(m).is_some());
        let (youngs, poisson, density) =
            (names(|m| m.youngs_modulus), names(|m| m.poisson_ratio), names(|m| m.density));
        let replaced = AskedMaterial {
            youngs: asked.youngs.filter(|_| youngs),
            poisson: asked.poisson.filter(|_| poisson),
            density: asked.density.filter(|_| density),
        };
        let usual = Material::default();
        let beside = AskedMaterial {
            youngs: asked.youngs.or((!youngs).then_some(usual.youngs_modulus)),
            poisson: asked.poisson.or((!poisson).then_some(usual.poisson_ratio)),
            density: asked.density.or((!density).then_some(usual.density)),
        };
        let provenance = if beside == asked.alone().into() {
            beside.to_string()
        } else if beside == AskedMaterial::default() {
            "materials of the file".into()
        } else {
            format!("materials of the file with {beside}")
        };
        Self { provenance, replaced: Some(replaced).filter(|r| *r != AskedMaterial::default()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(youngs_modulus: Option<f64>, density: Option<f64>) -> sscc_io::Material {
        sscc_io::Material { youngs_modulus, density, ..Default::default() }
    }

    #[test]
    fn what_was_asked_for_goes_before_the_file_and_the_file_before_the_default() {
        let usual = Material::default();
        let soft = file(Some(5.0), Some(7.0));
        let asked = AskedMaterial::parse("youngs=3").unwrap();
        let expected = Material { youngs_modulus: 3.0, density: 7.0, poisson_ratio: usual.poisson_ratio };
        assert_eq!(asked.over(&soft), expected);
        assert_eq!(asked.alone(), Material { youngs_modulus: 3.0, ..usual });
        assert_eq!(AskedMaterial::default().alone(), usual);
    }

    #[test]
    fn provenance_tells_the_numbers_that_are_not_from_the_file() {
        let origin = |typed: Option<&str>, file: &[&sscc_io::Material]| {
            let asked = typed.map(|typed| AskedMaterial::parse(typed).unwrap()).unwrap_or_default();
            let Origin { provenance, replaced } = Origin::new(&asked, file);
            (provenance, replaced.map(|replaced| replaced.to_string()))
        };
        let told = |provenance: &str, replaced: Option<&str>| (provenance.into(), replaced.map(Into::into));
        let (silent, soft, hard) =
            (file(None, None), file(Some(5.0), None), AskedMaterial::parse("steel").unwrap());
        let whole = sscc_io::Material { poisson_ratio: Some(0.1), ..file(Some(5.0), Some(7.0)) };
        let usual = "youngs=1e6 poisson=0.4 density=1000";
        for file in [&[][..], &[&silent]] {
            assert_eq!(origin(None, file), told(usual, None));
            assert_eq!(origin(Some("steel"), file), told(&hard.to_string(), None));
        }
        assert_eq!(origin(None, &[&whole]), told("materials of the file", None));
        assert_eq!(origin(Some("glass"), &[&whole]).1.unwrap(), "youngs=6.2e10 poisson=0.2 density=2600");
        let both = &[&silent, &soft];
        assert_eq!(origin(None, both), told("materials of the file with poisson=0.4 density=1000", None));
        assert_eq!(
            origin(Some("density=3"), both),
            told("materials of the file with poisson=0.4 density=3", None)
        );
        assert_eq!(
            origin(Some("youngs=3"), both),
            told("youngs=3e0 poisson=0.4 density=1000", Some("youngs=3e0"))
        );
    }

    #[test]
    fn materials_have_names() {
        for known in MATERIALS {
            assert_eq!(AskedMaterial::parse(known.name).unwrap().alone(), known.elastic);
        }
        for typed in ["stel", "steel,density=3", "youngs", "youngs=x", "E=3", ""] {
            let refused = AskedMaterial::parse(typed).unwrap_err().to_string();
            assert!(MATERIALS.iter().all(|known| refused.contains(known.name)), "{refused}");
            assert!(refused.contains("youngs=E, poisson=NU or density=RHO"), "{refused}");
        }
    }
}
