//! Reads the models of a scene: `[models.NAME]`.

use std::path::Path;

use sscc_dynamics::{Damping, MATERIALS};
use sscc_solid::PartialMaterial;

use super::section::Section;
use crate::error::Result;
use crate::recipes::{ModesSpec, Recipe, Shape};

/// Maximum number of modes of a body.
pub const MAX_RANK: usize = 500;

/// Maximum number of cubes along the longest side of a lattice.
const MAX_CELLS: usize = 2000;

/// A model of a scene.
#[derive(Clone, Debug)]
pub struct ModelSpec {
    /// Shape, material and modes.
    pub recipe: Recipe,
    /// Whether the dynamics are linear: the stiffness is that at rest.
    pub is_linear: bool,
    /// Damping of its modes.
    pub damping: Damping,
}

/// Number of modes of the small spring.
pub const QUICK_RANK: usize = 20;

impl ModelSpec {
    /// Returns the name of the array of its bodies' q in `trajectories.npz`.
    pub fn array_name(&self) -> String {
        format!("q_{}", self.recipe.name.replace('-', "_"))
    }

    /// Replaces the model by the small spring.
    pub fn quicken(&mut self) {
        let Recipe { shape, modes, cells, amplitudes, .. } = &mut self.recipe;
        (*shape, *modes, *cells) = (Shape::SMALL_SPRING, ModesSpec::Linear(QUICK_RANK), None);
        *amplitudes = None;
        self.is_linear = true;
    }
}

const KEYS: [&str; 11] = [
    "shape",
    "file",
    "size",
    "resolution",
    "kind",
    "rank",
    "material",
    "damping",
    "dynamics",
    "amplitudes",
    "spread",
];

/// The names of the key of the amplitudes of modes.
const AMPLITUDES: [&str; 2] = ["amplitudes", "spread"];

/// Names of embedded shapes, and of those that they stand in for.
const SHAPES: [&str; 4] = ["spring", "spring-4k", "bunny", "dragon"];

/// Reads all models of a scene. `folder` is that of the scene.
pub fn read(scene: &Section<'_>, folder: &Path) -> Result<Vec<ModelSpec>> {
    let mut models: Vec<ModelSpec> = Vec::new();
    for (name, section) in scene.named("models", &KEYS)? {
        let model = one(name, &section, folder)?;
        if let Some(other) = models.iter().find(|other| other.array_name() == model.array_name()) {
            let cause =
                format!("'{name}' and '{}' differ by _ and - only: rename one of them", other.recipe.name);
            return Err(section.refused("models", cause));
        }
        models.push(model);
    }
    Ok(models)
}

fn one(name: &str, model: &Section<'_>, folder: &Path) -> Result<ModelSpec> {
    if name.is_empty() || !name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-') {
        return Err(model.refused("models", "the name of a model may have letters, digits, _ and - only"));
    }
    let shape = match (model.word("shape", &SHAPES.map(|name| (name, name)))?, model.text("file")?) {
        (Some(_), Some(_)) => {
            return Err(model.refused("file", "the model has both shape and file: leave one of them out"));
        }
        (None, None) => {
            return Err(model.refused("shape", "it is missing: give shape = \"NAME\" or file = \"PATH\""));
        }
        (None, Some(file)) => Shape::File(folder.join(file)),
        (Some("spring"), _) => Shape::SPRING,
        (Some("spring-4k"), _) => Shape::SMALL_SPRING,
        (Some("bunny"), _) => Shape::Bunny,
        (Some(_), _) => Shape::Dragon,
    };
    let rank = model.count("rank", MAX_RANK)?;
    let word = model.word("kind", &["linear", "nonlinear", "polynomial"].map(|name| (name, name)))?;
    let (modes, is_linear) = match model.require("kind", word)? {
        "linear" => (ModesSpec::Linear(rank.unwrap_or(20)), true),
        "nonlinear" => (ModesSpec::Nonlinear(rank.unwrap_or(30)), false),
        _ if rank.is_some_and(|rank| rank != 24) => {
            return Err(model.refused("rank", "polynomial modes are always 24: leave rank out"));
        }
        _ => (ModesSpec::Polynomial, true),
    };
    let dynamics = model.word("dynamics", &[("linear", true), ("nonlinear", false)])?;
    if let (ModesSpec::Linear(_), Some(false)) = (modes, dynamics) {
        return Err(model.refused(
            "dynamics",
            "linear modes have no nonlinear forces: use dynamics = \"linear\", or kind = \"nonlinear\"",
        ));
    }
    let (material, default_damping) = material(model)?;
    let recipe = Recipe {
        name: name.into(),
        shape,
        modes,
        material,
        cells: model.count("resolution", MAX_CELLS)?,
        size: model.positive("size")?,
        amplitudes: amplitudes(model, modes.rank())?,
    };
    let damping = damping(model)?.unwrap_or(default_damping);
    Ok(ModelSpec { recipe, is_linear: dynamics.unwrap_or(is_linear), damping })
}

/// Reads `amplitudes = [...]`, one of each mode.
fn amplitudes(model: &Section<'_>, rank: usize) -> Result<Option<Vec<f64>>> {
    let key = model.either(AMPLITUDES)?;
    let Some(amplitudes) = model.numbers(key)? else { return Ok(None) };
    if amplitudes.len() != rank {
        return Err(model.refused(key, format!("{} numbers for {rank} modes", amplitudes.len())));
    }
    if amplitudes.iter().any(|amplitude| *amplitude <= 0.0) {
        return Err(model.refused(key, "numbers above 0 were expected"));
    }
    Ok(Some(amplitudes))
}

/// Reads `damping = { mass, stiffness }`.
pub fn damping(section: &Section<'_>) -> Result<Option<Damping>> {
    let Some(damping) = section.section("damping", &["mass", "stiffness"])? else { return Ok(None) };
    Ok(Some(Damping {
        mass: damping.not_negative("mass")?.unwrap_or(0.0),
        stiffness: damping.not_negative("stiffness")?.unwrap_or(0.0),
    }))
}

/// Reads a material: by its name, with the damping of that name, or by its numbers. Missing numbers are those of the
/// file.
fn material(model: &Section<'_>) -> Result<(PartialMaterial, Damping)> {
    if model.is_text("material") {
        let known = MATERIALS.map(|material| (material.name, material));
        let found = model.require("material", model.word("material", &known)?)?;
        return Ok((found.elastic.into(), found.damping));
    }
    let Some(material) = model.section("material", &["youngs", "poisson", "density"])? else {
        return Ok((PartialMaterial::default(), Damping::default()));
    };
    let poisson = material.number("poisson")?;
    if poisson.is_some_and(|nu| nu <= -1.0 || nu >= 0.5) {
        return Err(material.refused("poisson", "a number between -1 and 0.5 was expected"));
    }
    let (youngs, density) = (material.positive("youngs")?, material.positive("density")?);
    Ok((PartialMaterial { youngs_modulus: youngs, poisson_ratio: poisson, density }, Damping::default()))
}
