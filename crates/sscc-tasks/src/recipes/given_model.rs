//! Models from files that contain modes: with their forces and their mass, in SI units.

use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::{Metric, MetricKind, Modes, ReducedModel};
use sscc_io::{LoadOptions, ModelInfo, Setting, load_model_with, read_reduced_forces};
use sscc_modes::{diagonalize, energy_metric};
use sscc_solid::{Elasticity, MassData, MassProperties, Material, PartialMaterial, Stiffness};

use crate::TaskError;
use crate::error::At;
use crate::resize::{Resize, scaled};

/// Files of a model with modes.
#[derive(Clone, Debug)]
pub struct ModelFiles {
    /// A model with modes, or a surface.
    pub path: PathBuf,
    /// Modes of the surface.
    pub modes: Option<PathBuf>,
    /// Reduced forces of the modes: VegaFEM's `.cub`.
    pub forces: Option<PathBuf>,
    /// Whether the dynamics are linear. None means as the forces of the files are.
    pub is_linear: Option<bool>,
}

/// A model from files, with all data for its motion.
pub struct GivenModel {
    /// Surface and mass-orthonormal modes.
    pub model: ReducedModel,
    /// Forces. Linear forces are diagonal.
    pub elasticity: Elasticity,
    /// Mass and support.
    pub mass: MassData,
    /// Properties that were assumed because the files do not state them.
    pub assumed: Option<String>,
    /// Lines about content of the files whose meaning is not clear.
    pub warnings: Vec<String>,
}

/// Names of the unit of length in scenes; a model that states no unit is in metres.
const METRES: [&str; 6] = ["", "m", "metre", "metres", "meter", "meters"];

/// Maximum displacement of a fixed vertex, relative to the largest displacement of all: zeros in single precision.
const STILL: f64 = 1e-9;

/// Minimum number of fixed vertices for which a body is held. Fewer may be at rest by chance.
const MIN_FIXED: usize = 3;

impl GivenModel {
    /// Loads the model. If the files state no mass, the mass is that of the volume within the surface at the density in
    /// `material`. For a held body without a density it is at that of the default material.
    ///
    /// # Errors
    /// When a file cannot be read, or files do not fit each other; when the model has no forces, is in other units than
    /// metres or has no mass; when the material contradicts the files; when nonlinear dynamics are requested for linear
    /// forces; when the model cannot be scaled.
    pub fn load(files: &ModelFiles, material: &PartialMaterial, resize: Resize) -> Result<Self, TaskError> {
        let path = &files.path;
        let refused = |cause: String| Err(TaskError::refused(path.display(), cause));
        let loaded = load_model_with(path, &LoadOptions::new(files.modes.as_deref(), None))?;
        let (model, info, warnings) = (loaded.model, loaded.info, loaded.warnings);
        if !METRES.contains(&info.units.trim().to_lowercase().as_str()) {
            let unit = crate::text::one_line(&info.units);
            return refused(format!(
                "its unit of length is '{unit}', but scenes are in metres: compute it again from a file in metres, or \
                 give the scene the solid itself with scale"
            ));
        }
        if material.youngs_modulus.is_some() || material.poisson_ratio.is_some() {
            return refused("material: the model has its own stiffness: leave out youngs and poisson".into());
        }
        let elasticity = elasticity(files, &info, model.rank())?;
        let (mass, assumed) = mass(path, &model, info.mass, material.density)?;
        let has_linear = matches!(elasticity, Elasticity::Linear(_));
        let is_linear = files.is_linear.unwrap_or(has_linear);
        if has_linear && !is_linear {
            let cause = "dynamics: the model has no forces of large deformations: use dynamics = \"linear\"";
            return refused(cause.into());
        }
        let elasticity = if is_linear { elasticity.linearized() } else { elasticity };
        let given = Self { model, elasticity, mass, assumed, warnings };
        let given = if is_linear { given.uncoupled().in_file(path)? } else { given };
        let factor = resize.factor(given.model.mesh().rest_positions()).in_file(path)?;
        given.scaled(factor).in_file(path)
    }

    /// Rotates coupled modes so that their linear forces are diagonal.
    fn uncoupled(self) -> Result<Self, TaskError> {
        let stiffness = self.elasticity.stiffness();
        if stiffness.is_diagonal() {
            return Ok(self);
        }
        let rank = self.model.rank();
        let found = diagonalize(self.model.modes(), stiffness)?;
        let metric = energy_metric(&found.eigenvalues)?;
        let moment = |k: usize| -> DVec3 {
            (0..rank).map(|i| self.mass.moments[i] * found.rotation[i * rank + k]).sum()
        };
        let moments = (0..rank).map(moment).collect();
        Ok(Self {
            model: ReducedModel::with_metric(self.model.mesh().clone(), found.modes, metric)?,
            elasticity: Elasticity::Linear(Stiffness::from_diagonal(&found.eigenvalues)?),
            mass: MassData { moments, ..self.mass },
            assumed: self.assumed,
            warnings: self.warnings,
        })
    }

    /// Multiplies all lengths of the body by the factor. Its material stays the same.
    fn scaled(self, factor: f64) -> Result<Self, TaskError> {
        if factor == 1.0 {
            return Ok(self);
        }
        let Self { model, elasticity, mass, assumed, warnings } = self;
        let divisor = factor.powf(1.5);
        let modes = model.modes().displacements().iter().map(|u| *u / divisor).collect();
        let modes = Modes::new(model.rank(), modes)?;
        let mesh = scaled(model.mesh().clone(), factor)?;
        let old = model.metric();
        // The strain energy at q is factor^-2 times that of the body of the files.
        let model = if old.kind() == MetricKind::Energy && old.dense_factor().is_none() {
            let scales = old.scales().iter().map(|scale| scale / factor).collect();
            ReducedModel::with_metric(mesh, modes, Metric::from_scales(MetricKind::Energy, scales)?)?
        } else {
            ReducedModel::new(mesh, modes)?
        };
        let (elasticity, mass) = (elasticity.scaled(factor)?, mass.scaled(factor));
        Ok(Self { model, elasticity, mass, assumed, warnings })
    }

    /// Returns at most `count` uncoupled modes of the linear forces, with their eigenvalues (1/s^2), ascending.
    pub fn vibrations(&self, count: usize) -> Result<(Modes, Vec<f64>), TaskError> {
        let found = diagonalize(self.model.modes(), self.elasticity.stiffness())?;
        let rank = self.model.rank();
        let count = count.min(rank);
        let kept = found.modes.displacements().chunks_exact(rank).flat_map(|of| &of[..count]).copied();
        Ok((Modes::new(count, kept.collect())?, found.eigenvalues[..count].to_vec()))
    }
}

/// Returns the forces of the files.
fn elasticity(files: &ModelFiles, info: &ModelInfo, rank: usize) -> Result<Elasticity, TaskError> {
    match (&files.forces, &info.elasticity) {
        (None, Some(own)) => Ok(own.clone()),
        (None, None) => {
            let cause = "the model has no forces, so it cannot move: compute it from a solid with sscc modes "
                + Setting::Kind
                + " linear (or nonlinear, polynomial), or give the file of its forces: forces = \"FILE.cub\"";
            Err(TaskError::refused(files.path.display(), cause))
        }
        (Some(forces), Some(_)) => {
            let cause = "forces: the model has forces of its own: leave this key out";
            Err(TaskError::refused(forces.display(), cause))
        }
        (Some(path), None) => {
            let forces = read_reduced_forces(path)?;
            if forces.rank() != rank {
                let cause = format!("forces of {} modes, but the model has {rank}", forces.rank());
                return Err(TaskError::refused(path.display(), cause));
            }
            Ok(Elasticity::Nonlinear(forces))
        }
    }
}

/// Returns mass and support, from the file or from a density, and a text on assumptions.
fn mass(
    path: &Path,
    model: &ReducedModel,
    stated: Option<MassData>,
    density: Option<f64>,
) -> Result<(MassData, Option<String>), TaskError> {
    match (stated, density) {
        (Some(stated), None) => return Ok((stated, None)),
        (Some(_), Some(_)) => {
            let cause = "material: the model has its own mass: leave out density";
            return Err(TaskError::refused(path.display(), cause));
        }
        (None, _) => {}
    }
    let fixed = fixed_vertices(model);
    let is_held = fixed >= MIN_FIXED;
    if !is_held && density.is_none() {
        let cause = "the files of this free body state no mass: give material = { density = ... } in kg/m^3, or compute \
                     the model with sscc modes, which states it";
        return Err(TaskError::refused(path.display(), cause));
    }
    let within = MassProperties::within(model.mesh(), density.unwrap_or(Material::DEFAULT.density()));
    let Some(properties) = within else {
        let cause = "its surface encloses no volume, so its mass is unknown: close the surface, or turn its triangles \
                     outwards";
        return Err(TaskError::refused(path.display(), cause));
    };
    let moments = vec![DVec3::ZERO; model.rank()];
    let assumed = is_held.then(|| {
        format!("{fixed} vertices are fixed, so the body is held; its files state no mass, so its weight does not bend it")
    });
    Ok((MassData { properties, moments, is_held }, assumed))
}

/// Returns the number of vertices of triangles that no mode moves.
fn fixed_vertices(model: &ReducedModel) -> usize {
    let length = |v: &u32| model.modes().of_vertex(*v).iter().map(|u| u.length()).fold(0.0, f64::max);
    let used = model.mesh().used_vertices();
    let largest = used.iter().map(length).fold(0.0, f64::max);
    used.iter().filter(|v| length(v) <= STILL * largest).count()
}
