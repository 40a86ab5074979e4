//! `--material`: a name, or numbers.

use anyhow::{Result, bail};
use sscc_dynamics::MATERIALS;
use sscc_sim::RequestedMaterial;

/// The name of a material, or `youngs=1e6,poisson=0.4,density=1000`, any of them.
pub fn parse(typed: &str) -> Result<RequestedMaterial> {
    if let Some(known) = MATERIALS.iter().find(|material| material.name == typed.trim()) {
        return Ok(known.elastic.into());
    }
    let mut material = RequestedMaterial::default();
    for part in typed.split(',') {
        let (name, number) = part.split_once('=').unwrap_or((part, ""));
        let slot = match name.trim() {
            "youngs" => &mut material.youngs,
            "poisson" => &mut material.poisson,
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
            assert_eq!(parse(known.name).unwrap().alone(), known.elastic);
        }
        assert_eq!(parse("youngs=3").unwrap(), RequestedMaterial { youngs: Some(3.0), ..Default::default() });
        for typed in ["stel", "steel,density=3", "youngs", "youngs=x", "E=3", ""] {
            let refused = parse(typed).unwrap_err().to_string();
            assert!(MATERIALS.iter().all(|known| refused.contains(known.name)), "{refused}");
            assert!(refused.contains("youngs=E, poisson=NU or density=RHO"), "{refused}");
        }
    }
}
