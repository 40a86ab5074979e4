//! Table of materials for sound, with density, stiffness and damping.

use sscc_solid::{Material, PartialMaterial};

use crate::Damping;

/// Material of a sounding body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoundMaterial {
    /// Name in scene files.
    pub name: &'static str,
    /// Density and elastic constants, in SI units.
    pub elastic: Material,
    /// Rayleigh damping of the vibrations.
    pub damping: Damping,
}

/// Creates a row of the table: name, density (kg/m^3), Young's modulus (N/m^2), Poisson's ratio, damping coefficients (1/s, s).
#[expect(clippy::panic, reason = "evaluated by the compiler")]
const fn row(name: &'static str, d: f64, y: f64, nu: f64, alpha: f64, beta: f64) -> SoundMaterial {
    let known = PartialMaterial { density: Some(d), youngs_modulus: Some(y), poisson_ratio: Some(nu) };
    // A value outside its range fails the build.
    let Ok(elastic) = Material::new(&known) else { panic!("numbers of a material") };
    SoundMaterial { name, elastic, damping: Damping { mass: alpha, stiffness: beta } }
}

/// Materials of everyday objects. Elastic constants of the first eight are round values in the range of handbooks; constants of
/// the others are usual values of the grades that `docs/command.md` names. Damping was chosen by ear for
/// the first eight; each other material has the damping of the most similar one. No value was measured.
pub const MATERIALS: [SoundMaterial; 16] = [
    row("steel", 7850.0, 2.0e11, 0.29, 5.0, 3e-8),
    row("aluminium", 2700.0, 7.0e10, 0.33, 4.0, 5e-8),
    row("glass", 2600.0, 6.2e10, 0.20, 1.0, 1e-7),
    row("ceramic", 2700.0, 7.2e10, 0.19, 6.0, 1e-7),
    row("wood", 750.0, 1.1e10, 0.25, 60.0, 2e-6),
    row("plastic", 1070.0, 1.4e9, 0.35, 30.0, 1e-6),
    row("polycarbonate", 1190.0, 2.4e9, 0.37, 0.5, 4e-7),
    row("rubber", 1000.0, 1.0e6, 0.40, 20.0, 5e-5),
    row("spring-steel", 7850.0, 2.06e11, 0.264, 5.0, 3e-8),
    row("stainless-steel", 7900.0, 2.0e11, 0.30, 5.0, 3e-8),
    row("titanium", 4430.0, 1.138e11, 0.342, 4.0, 5e-8),
    row("brass", 8530.0, 1.1e11, 0.34, 4.0, 5e-8),
    row("copper", 8890.0, 1.17e11, 0.34, 4.0, 5e-8),
    row("nylon", 1130.0, 3.0e9, 0.39, 30.0, 1e-6),
    row("pla", 1240.0, 3.6e9, 0.36, 30.0, 1e-6),
    row("concrete", 2400.0, 3.1e10, 0.20, 6.0, 1e-7),
];

impl SoundMaterial {
    /// Returns the material with this name; None if no material has it.
    pub fn from_name(name: &str) -> Option<Self> {
        MATERIALS.into_iter().find(|material| material.name == name)
    }
}
