//! `--material`: numbers by name.

use anyhow::{Result, bail};
use sscc_modes::Material;

/// `youngs=1e6,poisson=0.4,density=1000`, any of them; the others as by default.
pub fn parse(typed: Option<&str>) -> Result<Material> {
    let mut material = Material::default();
    for part in typed.into_iter().flat_map(|text| text.split(',')) {
        let (name, number) = part.split_once('=').unwrap_or((part, ""));
        let Ok(number) = number.trim().parse::<f64>() else {
            bail!("--material: '{part}' is not youngs=E, poisson=NU or density=RHO");
        };
        match name.trim() {
            "youngs" => material.youngs_modulus = number,
            "poisson" => material.poisson_ratio = number,
            "density" => material.density = number,
            _ => bail!("--material: '{part}' is not youngs=E, poisson=NU or density=RHO"),
        }
    }
    Ok(material)
}
