//! Models with certificates: computed once, then read from the cache.

use sscc::parts::DEFAULT_BUDGET;
use sscc::{Modes, ReducedModel};
use sscc_io::{ModelInfo, read_model, write_model};
use sscc_solid::{Elasticity, MassData};

use super::cache::Cache;
use super::loaded_recipe::LoadedRecipe;
use super::recipe::{ModesSpec, Recipe};
use super::timed_certificates::TimedCertificates;
use crate::{TaskError, Watch};

/// A model with its certificates.
pub struct CertifiedModel {
    /// The name of its recipe.
    pub name: String,
    /// Origin of its shape.
    pub source: String,
    /// A note, for example on an embedded shape in place of a file.
    pub note: Option<String>,
    /// The model.
    pub model: ReducedModel,
    /// Its stiffness and forces.
    pub elasticity: Elasticity,
    /// Its mass and support.
    pub mass: MassData,
    /// Certificates of the default budget.
    pub full: TimedCertificates,
    /// Certificates as in the paper (a radius for each node, and for each pair of the root's children), for benches
    /// that compare them.
    pub paper: Option<TimedCertificates>,
}

impl CertifiedModel {
    /// Reads the model from the cache, or computes it.
    ///
    /// # Errors
    /// When the modes or certificates cannot be computed or written, the amplitudes of the recipe do not fit the modes,
    /// or `watch` cancels.
    pub fn get(loaded: &LoadedRecipe<'_>, cache: &Cache, watch: &dyn Watch) -> Result<Self, TaskError> {
        let recipe @ Recipe { name, modes, .. } = loaded.recipe();
        let (model, elasticity, mass) = match loaded.given() {
            Some(given) => (given.model.clone(), given.elasticity.clone(), given.mass.clone()),
            None => recipe_modes(loaded, *modes, cache, watch)?,
        };
        let (metric, budget) = (recipe.metric(&model)?, DEFAULT_BUDGET);
        let full = TimedCertificates::get(cache, name, &model, &metric, &loaded.source, budget, watch)?;
        let (source, note) = (loaded.source.clone(), loaded.note.clone());
        Ok(Self { name: name.clone(), source, note, model, elasticity, mass, full, paper: None })
    }

    /// Returns the model with certificates as in the paper in addition.
    ///
    /// # Errors
    /// The errors of [`CertifiedModel::get`].
    pub fn with_paper(self, cache: &Cache, watch: &dyn Watch) -> Result<Self, TaskError> {
        let metric = self.full.certificates.metric();
        let paper = TimedCertificates::get(cache, &self.name, &self.model, metric, &self.source, 0, watch)?;
        Ok(Self { paper: Some(paper), ..self })
    }

    /// Whether the root's radius alone proves the shape free.
    pub fn is_root_certified(&self, q: &[f64]) -> bool {
        let certificates = &self.full.certificates;
        certificates.metric().norm(q).is_ok_and(|norm| norm < certificates.root_radius())
    }
}

/// Returns `count` vibrations of a shape with their eigenvalues (1/s^2), from the cache or computed; for a model file,
/// at most `count` vibrations of its modes.
///
/// # Errors
/// When the shape has fewer vibrations, the modes cannot be computed or written, or `watch` cancels.
pub fn vibrations(
    loaded: &LoadedRecipe<'_>,
    count: usize,
    cache: &Cache,
    watch: &dyn Watch,
) -> Result<(Modes, Vec<f64>), TaskError> {
    if let Some(given) = loaded.given() {
        return given.vibrations(count);
    }
    let (model, elasticity, _) = recipe_modes(loaded, ModesSpec::Linear(count), cache, watch)?;
    Ok((model.modes().clone(), elasticity.stiffness().diagonal().collect()))
}

/// Returns the modes of a shape with their forces and mass, from the cache or computed.
fn recipe_modes(
    loaded: &LoadedRecipe<'_>,
    modes: ModesSpec,
    cache: &Cache,
    watch: &dyn Watch,
) -> Result<(ReducedModel, Elasticity, MassData), TaskError> {
    let key = loaded.key("model with mass").text(&format!("{modes:?}"));
    let name = format!("{}-{key}.model.safetensors", loaded.recipe().name);
    let (model, ModelInfo { elasticity, mass, .. }) = cache.get(
        &name,
        watch,
        |path| Ok(read_model(path)?),
        || loaded.modes(modes, watch),
        |path, (model, info): &(ReducedModel, ModelInfo)| Ok(write_model(path, model, info)?),
    )?;
    let (Some(elasticity), Some(mass)) = (elasticity, mass) else {
        let place = cache.folder().join(name);
        let cause = "this model of the cache has no stiffness or no mass; remove the file";
        return Err(TaskError::refused(place.display(), cause));
    };
    Ok((model, elasticity, mass))
}
