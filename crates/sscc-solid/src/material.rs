//! Elastic materials, complete or with unknown properties.

use std::fmt;

/// Linear isotropic elastic material, in any consistent units; SI units give frequencies in Hz. The values are within
/// the limits of [`Material::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    density: f64,
    youngs_modulus: f64,
    poisson_ratio: f64,
}

/// Known properties of a material, from a file or a caller. [`Material::new`] checks them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartialMaterial {
    /// Mass per volume (kg/m^3).
    pub density: Option<f64>,
    /// Young's modulus (N/m^2).
    pub youngs_modulus: Option<f64>,
    /// Poisson's ratio.
    pub poisson_ratio: Option<f64>,
}

/// Material of a file: name and known properties.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedMaterial {
    /// Name in the file; the reference number if the format has no names; else `default`.
    pub name: String,
    /// Properties in the file's units: SI in all files of VegaFEM.
    pub stated: PartialMaterial,
    /// Kind of a material whose stiffness is not computed, such as an orthotropic one. A solid needs another stiffness for
    /// it.
    pub unsupported: Option<String>,
}

/// A property of a material is outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {value:e}: it must be {range}")]
pub struct MaterialError {
    /// Name of the property.
    pub what: &'static str,
    /// Value.
    pub value: f64,
    /// Allowed range.
    pub range: &'static str,
}

impl Material {
    /// Firm rubber: 1,000 kg/m^3, 1e6 N/m^2, 0.4. Shapes of modes depend on Poisson's ratio alone.
    pub const DEFAULT: Self = Self { density: 1000.0, youngs_modulus: 1e6, poisson_ratio: 0.4 };

    /// Returns the material with these properties; unset ones are those of the default material.
    ///
    /// # Errors
    /// When density or Young's modulus is outside 1e-60 to 1e60, or Poisson's ratio is not between -0.9999 and 0.4999.
    pub const fn new(known: &PartialMaterial) -> Result<Self, MaterialError> {
        let PartialMaterial { density, youngs_modulus, poisson_ratio } = *known;
        let density = or(density, Self::DEFAULT.density);
        let youngs_modulus = or(youngs_modulus, Self::DEFAULT.youngs_modulus);
        let poisson_ratio = or(poisson_ratio, Self::DEFAULT.poisson_ratio);
        let range = "above 0 (1e-60 to 1e60)";
        if !is_positive(density) {
            return Err(MaterialError { what: "density", value: density, range });
        }
        if !is_positive(youngs_modulus) {
            return Err(MaterialError { what: "Young's modulus", value: youngs_modulus, range });
        }
        // At 0.5 the material is incompressible and its stiffness infinite.
        if !(poisson_ratio > -0.9999 && poisson_ratio < 0.4999) {
            let range = "above -0.9999 and below 0.4999";
            return Err(MaterialError { what: "Poisson's ratio", value: poisson_ratio, range });
        }
        Ok(Self { density, youngs_modulus, poisson_ratio })
    }

    /// Mass per volume (kg/m^3).
    #[inline]
    pub const fn density(&self) -> f64 {
        self.density
    }

    /// Young's modulus (N/m^2).
    #[inline]
    pub const fn youngs_modulus(&self) -> f64 {
        self.youngs_modulus
    }

    /// Poisson's ratio.
    #[inline]
    pub const fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// Lamé's first parameter (N/m^2).
    #[inline]
    pub fn lame_lambda(&self) -> f64 {
        let nu = self.poisson_ratio;
        self.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Lamé's second parameter, the shear modulus (N/m^2).
    #[inline]
    pub fn lame_mu(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl PartialMaterial {
    /// Returns these properties, with missing ones taken from the other.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        Self {
            density: self.density.or(other.density),
            youngs_modulus: self.youngs_modulus.or(other.youngs_modulus),
            poisson_ratio: self.poisson_ratio.or(other.poisson_ratio),
        }
    }
}

impl From<Material> for PartialMaterial {
    fn from(material: Material) -> Self {
        let Material { density, youngs_modulus, poisson_ratio } = material;
        Self {
            density: Some(density),
            youngs_modulus: Some(youngs_modulus),
            poisson_ratio: Some(poisson_ratio),
        }
    }
}

/// Known properties as text, such as `youngs=1e6 poisson=0.4 density=1000`.
impl fmt::Display for PartialMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = [
            self.youngs_modulus.map(|x| format!("youngs={x:e}")),
            self.poisson_ratio.map(|x| format!("poisson={x}")),
            self.density.map(|x| format!("density={x}")),
        ];
        f.write_str(&numbers.into_iter().flatten().collect::<Vec<_>>().join(" "))
    }
}

const fn or(number: Option<f64>, default: f64) -> f64 {
    match number {
        Some(number) => number,
        None => default,
    }
}

/// Whether a density or a modulus is in range; false for NaN.
const fn is_positive(x: f64) -> bool {
    x >= 1e-60 && x <= 1e60
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOFT: PartialMaterial =
        PartialMaterial { youngs_modulus: Some(5.0), density: Some(7.0), poisson_ratio: None };

    #[test]
    fn missing_properties_come_from_the_other_material_then_from_the_default() {
        let given = PartialMaterial { youngs_modulus: Some(3.0), ..PartialMaterial::default() };
        let both = Material::new(&given.or(&SOFT)).unwrap();
        assert_eq!((both.density(), both.youngs_modulus(), both.poisson_ratio()), (7.0, 3.0, 0.4));
        assert_eq!(Material::new(&PartialMaterial::default()).unwrap(), Material::default());
        assert_eq!(Material::new(&both.into()).unwrap(), both);
    }

    #[test]
    fn properties_out_of_range_are_rejected() {
        let rejected = |known: PartialMaterial| Material::new(&known).unwrap_err().to_string();
        for (value, shown) in [(0.0, "0e0"), (-1.0, "-1e0"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
            let density = rejected(PartialMaterial { density: Some(value), ..SOFT });
            assert_eq!(density, format!("density is {shown}: it must be above 0 (1e-60 to 1e60)"));
            let youngs = rejected(PartialMaterial { youngs_modulus: Some(value), ..SOFT });
            assert!(youngs.starts_with(&format!("Young's modulus is {shown}: ")), "{youngs}");
        }
        for value in [0.5, -1.0, f64::NAN] {
            let poisson = rejected(PartialMaterial { poisson_ratio: Some(value), ..SOFT });
            assert!(poisson.ends_with("it must be above -0.9999 and below 0.4999"), "{poisson}");
        }
    }

    #[test]
    fn known_properties_are_displayed() {
        assert_eq!(SOFT.to_string(), "youngs=5e0 density=7");
        let default = PartialMaterial::from(Material::DEFAULT).to_string();
        assert_eq!(default, "youngs=1e6 poisson=0.4 density=1000");
    }
}
