//! Reads the models of a scene: `[models.NAME]`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use sscc_dynamics::{Damping, MATERIALS};
use sscc_io::gltf::is_gltf;
use sscc_io::split_mesh_name;
use sscc_solid::PartialMaterial;
use sscc_tasks::{Fix, ModelFiles, ModesSpec, Recipe, Resize, Shape, UNITS};

use super::section::Section;
use crate::error::Result;

/// Maximum number of modes of a body.
pub const MAX_RANK: usize = 500;

/// Maximum number of cubes along the longest side of a lattice.
const MAX_CELLS: usize = 2000;

/// A model of a scene.
#[derive(Clone, Debug)]
pub struct ModelSpec {
    /// Shape, material and modes.
    pub recipe: Recipe,
    /// Whether the dynamics are linear, with the stiffness at rest. Not used for a file with modes: see
    /// [`ModelFiles::is_linear`].
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
        let Recipe { shape, modes, cells, fix, amplitudes, .. } = &mut self.recipe;
        (*shape, *modes, *cells) = (Shape::SMALL_SPRING, ModesSpec::Linear(QUICK_RANK), None);
        (*fix, *amplitudes) = (None, None);
        self.is_linear = true;
    }
}

const KEYS: [&str; 17] = [
    "shape",
    "file",
    "solid",
    "modes",
    "forces",
    "size",
    "scale",
    "units",
    "resolution",
    "kind",
    "rank",
    "fix",
    "material",
    "damping",
    "dynamics",
    "amplitudes",
    "spread",
];

/// Keys for modes that are computed. They are refused for a file with modes.
const COMPUTED: [&str; 5] = ["kind", "rank", "resolution", "solid", "fix"];

/// The two names of the key of the amplitudes of modes.
const AMPLITUDES: [&str; 2] = ["amplitudes", "spread"];

/// Names of shapes: embedded shapes, and real models that embedded shapes may replace.
const SHAPES: [&str; 4] = ["spring", "spring-4k", "bunny", "dragon"];

/// Reads all models of a scene. `folder` is the folder of the scene.
pub fn read(scene: &Section<'_>, folder: &Path) -> Result<Vec<ModelSpec>> {
    let mut models = Vec::new();
    let mut names = HashMap::new();
    for (name, section) in scene.named("models", &KEYS)? {
        let model = one(name, &section, folder)?;
        if let Some(other) = names.insert(model.array_name(), name) {
            let cause = format!("'{name}' and '{other}' differ by _ and - only: rename one of them");
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
    let dynamics = model.word("dynamics", &[("linear", true), ("nonlinear", false)])?;
    let shape = shape(model, folder, dynamics)?;
    let is_given = matches!(shape, Shape::Model(_));
    if let (true, Some(key)) = (is_given, COMPUTED.into_iter().find(|key| model.has(key))) {
        return Err(model.refused(key, "the file has its modes already: leave this key out"));
    }
    let (modes, is_linear) = if is_given { (ModesSpec::Given, false) } else { modes(model)? };
    if let (ModesSpec::Linear(_), Some(false)) = (modes, dynamics) {
        return Err(model.refused(
            "dynamics",
            "linear modes have no nonlinear forces: use dynamics = \"linear\", or kind = \"nonlinear\"",
        ));
    }
    let fix = fix(model, folder)?;
    if matches!(modes, ModesSpec::Polynomial) && fix.is_some() {
        return Err(model.refused("fix", "polynomial modes have no fixed vertices: use another kind"));
    }
    let (material, default_damping) = material(model)?;
    let recipe = Recipe {
        name: name.into(),
        shape,
        modes,
        material,
        cells: model.count("resolution", MAX_CELLS)?,
        resize: resize(model)?,
        fix,
        amplitudes: amplitudes(model, modes.rank())?,
    };
    let damping = damping(model)?.unwrap_or(default_damping);
    Ok(ModelSpec { recipe, is_linear: dynamics.unwrap_or(is_linear), damping })
}

/// Reads `shape`, or `file` with the files beside it.
fn shape(model: &Section<'_>, folder: &Path, is_linear: Option<bool>) -> Result<Shape> {
    let (shape, file) = (model.word("shape", &SHAPES.map(|name| (name, name)))?, model.text("file")?);
    let path = |key: &str| -> Result<Option<PathBuf>> { Ok(model.text(key)?.map(|file| folder.join(file))) };
    let (solid, modes, forces) = (path("solid")?, path("modes")?, path("forces")?);
    let beside = ["solid", "modes", "forces"].into_iter().find(|key| model.has(key));
    let file = match (shape, file) {
        (Some(_), Some(_)) => {
            return Err(model.refused("file", "the model has both shape and file: leave one of them out"));
        }
        (None, None) => {
            return Err(model.refused("shape", "it is missing: give shape = \"NAME\" or file = \"PATH\""));
        }
        (Some(shape), None) => {
            if let Some(key) = beside {
                return Err(model.refused(key, "this key needs file = \"PATH\""));
            }
            return Ok(match shape {
                "spring" => Shape::SPRING,
                "spring-4k" => Shape::SMALL_SPRING,
                "bunny" => Shape::Bunny,
                _ => Shape::Dragon,
            });
        }
        (None, Some(file)) => folder.join(file),
    };
    let ending = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let has_modes = modes.is_some()
        || is_gltf(&split_mesh_name(&file).0)
        || ["safetensors", "npz"].contains(&ending.as_str());
    match (has_modes, solid) {
        (true, None) => Ok(Shape::Model(ModelFiles { path: file, modes, forces, is_linear })),
        (true, Some(_)) => Err(model.refused("solid", "the file has its modes already: leave this key out")),
        (false, _) if forces.is_some() => Err(model.refused(
            "forces",
            "forces belong to modes: give the file of the modes, too: modes = \"FILE.U\"",
        )),
        (false, None) => Ok(Shape::File(file)),
        (false, Some(solid)) => Ok(Shape::Embedded { surface: file, solid }),
    }
}

/// Reads `kind` and `rank`: the modes to compute, and whether their dynamics are linear.
fn modes(model: &Section<'_>) -> Result<(ModesSpec, bool)> {
    let rank = model.count("rank", MAX_RANK)?;
    let word = model.word("kind", &["linear", "nonlinear", "polynomial"].map(|name| (name, name)))?;
    match model.require("kind", word)? {
        "linear" => Ok((ModesSpec::Linear(rank.unwrap_or(20)), true)),
        "nonlinear" => Ok((ModesSpec::Nonlinear(rank.unwrap_or(30)), false)),
        _ if rank.is_some_and(|rank| rank != 24) => {
            Err(model.refused("rank", "there are at most 24 polynomial modes: leave rank out"))
        }
        _ => Ok((ModesSpec::Polynomial, true)),
    }
}

/// Reads `size`, `scale` or `units`.
fn resize(model: &Section<'_>) -> Result<Resize> {
    let (size, scale) = (model.positive("size")?, model.positive("scale")?);
    match (size, scale, model.word("units", &UNITS)?) {
        (None, None, None) => Ok(Resize::Keep),
        (Some(size), None, None) => Ok(Resize::LongestSide(size)),
        (None, Some(factor), None) | (None, None, Some(factor)) => Ok(Resize::Factor(factor)),
        (Some(_), Some(_), _) => {
            Err(model.refused("scale", "the model has both size and scale: leave one of them out"))
        }
        (_, _, Some(_)) => {
            Err(model.refused("units", "the model has both units and size or scale: leave one of them out"))
        }
    }
}

/// Reads `fix`: a list of vertices, a box, or a file.
fn fix(model: &Section<'_>, folder: &Path) -> Result<Option<Fix>> {
    if !model.has("fix") {
        return Ok(None);
    }
    if model.is_text("fix") {
        let text = model.text("fix")?.unwrap_or_default();
        let fix = Fix::parse(text, folder, "the value");
        return fix.map(Some).map_err(|error| model.refused("fix", error));
    }
    let numbers = model.numbers("fix")?.unwrap_or_default();
    let whole = |x: &f64| *x >= 0.0 && *x <= f64::from(u32::MAX) && x.fract() == 0.0;
    if !numbers.iter().all(whole) {
        return Err(model.refused("fix", "vertex numbers, counted from 0, were expected"));
    }
    Ok(Some(Fix::Numbers(numbers.into_iter().map(|x| x as u32).collect())))
}

/// Reads `amplitudes = [...]`, one for each mode.
fn amplitudes(model: &Section<'_>, rank: Option<usize>) -> Result<Option<Vec<f64>>> {
    let key = model.either(AMPLITUDES)?;
    let Some(amplitudes) = model.numbers(key)? else { return Ok(None) };
    if let Some(rank) = rank.filter(|rank| amplitudes.len() != *rank) {
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

/// Reads a material: by its name, with the damping of that name, or by its numbers. Missing numbers are those of the file.
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
