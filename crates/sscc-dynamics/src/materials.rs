//! What sounds how.

use sscc_solid::{Material, PartialMaterial};

use crate::Damping;

/// A material that sounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoundMaterial {
    /// What scenes call it.
    pub name: &'static str,
    /// Density and stiffness, in SI units.
    pub elastic: Material,
    /// How fast its vibrations die away.
    pub damping: Damping,
}

/// A row of the table: kg/m^3, N/m^2, Poisson's ratio, 1/s, s.
const fn row(name: &'static str, d: f64, y: f64, nu: f64, alpha: f64, beta: f64) -> SoundMaterial {
    let known = PartialMaterial { density: Some(d), youngs_modulus: Some(y), poisson_ratio: Some(nu) };
    // Numbers out of range would be refused at compile time.
    let Ok(elastic) = Material::new(&known) else { panic!("numbers of a material") };
    SoundMaterial { name, elastic, damping: Damping { mass: alpha, stiffness: beta } }
}

/// Materials of everyday things. Round values of the order found in handbooks, and Rayleigh damping chosen to sound
/// right: none of them was measured.
pub const MATERIALS: [SoundMaterial; 8] = [
    row("steel", 7850.0, 2.0e11, 0.29, 5.0, 3e-8),
    row("aluminium", 2700.0, 7.0e10, 0.33, 4.0, 5e-8),
    row("glass", 2600.0, 6.2e10, 0.20, 1.0, 1e-7),
    row("ceramic", 2700.0, 7.2e10, 0.19, 6.0, 1e-7),
    row("wood", 750.0, 1.1e10, 0.25, 60.0, 2e-6),
    row("plastic", 1070.0, 1.4e9, 0.35, 30.0, 1e-6),
    row("polycarbonate", 1190.0, 2.4e9, 0.37, 0.5, 4e-7),
    row("rubber", 1000.0, 1.0e6, 0.40, 20.0, 5e-5),
];

impl SoundMaterial {
    /// The material of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        MATERIALS.into_iter().find(|material| material.name == name)
    }
}
