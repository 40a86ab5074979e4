//! Parser for the line of a material.

use sscc_solid::{NamedMaterial, PartialMaterial};

use crate::error::{cut, quoted};
use crate::solid::statements::value;

/// Parses `type, density, values`. For a type without an isotropic stiffness, only the density is read.
pub(super) fn parse_material(name: String, text: &str) -> Result<NamedMaterial, String> {
    let mut fields = text.split(',').map(str::trim_ascii);
    let kind = fields.next().unwrap_or_default();
    let mut next = |what: &str| match fields.next().filter(|field| !field.is_empty()) {
        Some(field) => value(field),
        None => Err(format!("the material {} has no {what}", quoted(kind))),
    };
    let density = next("density")?;
    if density <= 0.0 {
        return Err(format!("the density is {density}: it must be above 0"));
    }
    let stiffness = match kind {
        "ENU" => Some((next("Young's modulus")?, next("Poisson's ratio")?)),
        "MOONEYRIVLIN" => Some(at_rest(next("mu01")?, next("mu10")?, next("v1")?)?),
        _ => None,
    };
    if let Some((e, nu)) = stiffness
        && !(e > 0.0 && e.is_finite() && nu > -1.0 && nu < 0.5)
    {
        return Err(format!("E = {e}, nu = {nu}: E must be above 0 and finite, nu above -1 and below 0.5"));
    }
    let (youngs_modulus, poisson_ratio) = stiffness.unzip();
    let stated = PartialMaterial { density: Some(density), youngs_modulus, poisson_ratio };
    Ok(NamedMaterial { name, stated, unsupported: stiffness.is_none().then(|| cut(kind, 40)) })
}

/// Returns Young's modulus and Poisson's ratio of a Mooney-Rivlin material at rest. Its energy is
/// `mu01 (I2' - 3) + mu10 (I1' - 3) + v1 (J - 1)^2` with the invariants I' of a volume-preserving part, so that its
/// shear modulus is `2 (mu01 + mu10)` and its bulk modulus `2 v1`.
fn at_rest(mu01: f64, mu10: f64, v1: f64) -> Result<(f64, f64), String> {
    let (shear, bulk) = (2.0 * (mu01 + mu10), 2.0 * v1);
    if shear <= 0.0 || bulk <= 0.0 {
        return Err("mu01 + mu10 and v1 must be above 0".into());
    }
    let sum = 3.0 * bulk + shear;
    Ok((9.0 * bulk * shear / sum, (3.0 * bulk - 2.0 * shear) / (2.0 * sum)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        parse_material("a".into(), text).unwrap_err()
    }

    #[test]
    fn materials_of_all_types_are_read() {
        let material = parse_material("a".into(), "ENU, 1000, 1e9 ,0.45").unwrap();
        let stated =
            PartialMaterial { density: Some(1000.0), youngs_modulus: Some(1e9), poisson_ratio: Some(0.45) };
        assert_eq!(material, NamedMaterial { name: "a".into(), stated, unsupported: None });
        for kind in ["ORTHOTROPIC", "ORTHOTROPIC_N1", "WOOD"] {
            let other = parse_material("a".into(), &format!("{kind},900,1,2,3,0.4")).unwrap();
            assert_eq!((other.stated.density, other.stated.youngs_modulus), (Some(900.0), None));
            assert_eq!(other.unsupported.as_deref(), Some(kind));
        }
        // E = 2 G (1 + nu) = 3 K (1 - 2 nu), for G = 2 (1 + 3) and K = 2 * 12.
        let rubber = parse_material("a".into(), "MOONEYRIVLIN,900,1,3,12").unwrap().stated;
        let (e, nu) = (rubber.youngs_modulus.unwrap(), rubber.poisson_ratio.unwrap());
        assert!((e - 16.0 * (1.0 + nu)).abs() < 1e-12 && (e - 72.0 * (1.0 - 2.0 * nu)).abs() < 1e-12);
    }

    #[test]
    fn invalid_materials_are_rejected() {
        assert_eq!(message("ENU, 1000, 1e9"), "the material 'ENU' has no Poisson's ratio");
        assert_eq!(message("ENU"), "the material 'ENU' has no density");
        assert_eq!(message("ENU, 0, 1, 0"), "the density is 0: it must be above 0");
        assert_eq!(message("ENU, nan, 1, 0"), "'nan' is not a finite number");
        assert!(message("ENU, 1, 1, 0.5").starts_with("E = 1, nu = 0.5: "));
        assert!(message("ENU, 1, -1, 0.4").starts_with("E = -1, nu = 0.4: "));
        assert!(message("MOONEYRIVLIN, 1, 1, -1, 1").contains("must be above 0"));
        assert!(message("MOONEYRIVLIN, 1, 1e308, 1e308, 1e308").starts_with("E = "));
        assert_eq!(message("WOOD, x"), "'x' is not a number");
    }
}
