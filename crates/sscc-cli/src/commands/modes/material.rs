//! Parses `--material`: a name, or numbers.

use anyhow::{Error, Result, anyhow};
use sscc_dynamics::MATERIALS;
use sscc_solid::PartialMaterial;
use sscc_tasks::did_you_mean;
use sscc_tasks::text::quoted;

/// The keys of the numbers, in the order of the texts.
const KEYS: [&str; 3] = ["youngs", "poisson", "density"];

/// Parses the name of a material, or some of `youngs=1e6,poisson=0.4,density=1000`.
///
/// # Errors
/// When a name or a key is unknown (the error suggests one that is near), a key has no number or is repeated, a value
/// is not a number, or a name is not the only part.
pub fn parse(typed: &str) -> Result<PartialMaterial> {
    if let Some(known) = MATERIALS.iter().find(|material| material.name == typed.trim()) {
        return Ok(known.elastic.into());
    }
    let mut material = PartialMaterial::default();
    for part in typed.split(',') {
        let Some((key, number)) = part.split_once('=') else { return Err(unknown_name(part)) };
        let key = key.trim();
        let entry = match key {
            "youngs" => &mut material.youngs_modulus,
            "poisson" => &mut material.poisson_ratio,
            "density" => &mut material.density,
            _ => return Err(unknown_key(key)),
        };
        let value = number
            .trim()
            .parse()
            .map_err(|_| anyhow!("--material: {key}: {} is not a number", quoted(number)))?;
        if entry.replace(value).is_some() {
            return Err(anyhow!("--material: '{key}' is named twice"));
        }
    }
    Ok(material)
}

/// Returns the error for a part without `=`: a key without a number, a name beside other parts, or text that is neither
/// a key nor the name of a material.
fn unknown_name(part: &str) -> Error {
    let part = part.trim();
    if KEYS.contains(&part) {
        return anyhow!("--material: '{part}' has no number: {part}=NUMBER was expected");
    }
    let names = MATERIALS.map(|material| material.name);
    if names.contains(&part) {
        return anyhow!(
            "--material: the name '{part}' must be the only part: leave out the rest, or give numbers only"
        );
    }
    anyhow!(
        "--material: {} is neither youngs=E, poisson=NU or density=RHO nor a known material ({}){}",
        quoted(part),
        names.join(", "),
        did_you_mean(part, names.into_iter().chain(KEYS))
    )
}

fn unknown_key(key: &str) -> Error {
    let meant = did_you_mean(key, KEYS);
    anyhow!(
        "--material: there is no {}: youngs=E, poisson=NU or density=RHO was expected{meant}",
        quoted(key)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_names_or_numbers_and_errors_list_both() {
        for known in MATERIALS {
            assert_eq!(parse(known.name).unwrap(), known.elastic.into());
        }
        let soft = PartialMaterial { youngs_modulus: Some(3.0), ..PartialMaterial::default() };
        assert_eq!(parse("youngs=3").unwrap(), soft);
        let message = |typed: &str| parse(typed).unwrap_err().to_string();
        for typed in ["stel", "stel,density=3", "E", ""] {
            let refused = message(typed);
            assert!(MATERIALS.iter().all(|known| refused.contains(known.name)), "{refused}");
            assert!(refused.contains("youngs=E, poisson=NU or density=RHO"), "{refused}");
        }
        assert_eq!(message("youngs"), "--material: 'youngs' has no number: youngs=NUMBER was expected");
        assert_eq!(message("youngs=x"), "--material: youngs: 'x' is not a number");
        assert_eq!(message("density=1,density=2"), "--material: 'density' is named twice");
        assert!(message("steel,density=3").contains("the name 'steel' must be the only part"));
    }

    #[test]
    fn errors_have_the_nearest_name() {
        let message = |typed: &str| parse(typed).unwrap_err().to_string();
        for (typed, meant) in [
            ("possion=0.3", "poisson"),
            ("youngs=1e6,possion=0.3", "poisson"),
            ("young=1e6", "youngs"),
            ("densty=3", "density"),
            ("stel", "steel"),
            ("Steel", "steel"),
            ("aluminum", "aluminium"),
            ("rubbr", "rubber"),
        ] {
            assert!(message(typed).ends_with(&format!("; did you mean '{meant}'?")), "{}", message(typed));
        }
        assert!(message(&"x".repeat(100_000)).len() < 400);
    }
}
