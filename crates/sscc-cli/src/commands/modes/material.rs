//! Parses `--material`: a name, or numbers.

use anyhow::{Result, bail};
use sscc_dynamics::MATERIALS;
use sscc_solid::PartialMaterial;

/// Parses the name of a material, or some of `youngs=1e6,poisson=0.4,density=1000`.
pub fn parse(typed: &str) -> Result<PartialMaterial> {
    if let Some(known) = MATERIALS.iter().find(|material| material.name == typed.trim()) {
        return Ok(known.elastic.into());
    }
    let mut material = PartialMaterial::default();
    for part in typed.split(',') {
        let (name, number) = part.split_once('=').unwrap_or((part, ""));
        let slot = match name.trim() {
            "youngs" => &mut material.youngs_modulus,
            "poisson" => &mut material.poisson_ratio,
            "density" => &mut material.density,
            _ => return unknown(part),
        };
        let Ok(number) = number.trim().parse() else { return unknown(part) };
        *slot = Some(number);
    }
    Ok(material)
}

fn unknown<T>(part: &str) -> Result<T> {
    bail!(
        "--material: '{part}' is neither youngs=E, poisson=NU or density=RHO nor a known material ({})",
        MATERIALS.map(|material| material.name).join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_have_names() {
        for known in MATERIALS {
            assert_eq!(parse(known.name).unwrap(), known.elastic.into());
        }
        let soft = PartialMaterial { youngs_modulus: Some(3.0), ..PartialMaterial::default() };
        assert_eq!(parse("youngs=3").unwrap(), soft);
        for typed in ["stel", "steel,density=3", "youngs", "youngs=x", "E=3", ""] {
            let refused = parse(typed).unwrap_err().to_string();
            assert!(MATERIALS.iter().all(|known| refused.contains(known.name)), "{refused}");
            assert!(refused.contains("youngs=E, poisson=NU or density=RHO"), "{refused}");
        }
    }
}
