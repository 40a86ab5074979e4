//! Setup of a bench: the sources of its models, and the observer of its progress.

use std::path::Path;

use sscc_tasks::{Cache, CertifiedModel, LoadedRecipe, ModesSpec, Recipe, Shape, Stage, Watch};

use crate::error::Error;

/// Settings of all scenarios.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// Folder of the real models. If None, embedded shapes replace the real models.
    pub models: Option<&'a Path>,
    /// Cache of models, certificates and simulations.
    pub cache: &'a Cache,
    /// Whether a spring of 4,000 triangles replaces every model.
    pub is_quick: bool,
    /// Follows and cancels all work.
    pub watch: &'a dyn Watch,
}

impl Setup<'_> {
    /// Returns a model with both sets of certificates.
    pub(crate) fn certified_model(&self, recipe: &Recipe) -> Result<CertifiedModel, Error> {
        if !self.is_quick {
            return self.make(recipe, self.models);
        }
        let mut model = self.make(&small_spring(), None)?;
        model.note = Some("--quick: a spring of 4,000 triangles replaces the model".into());
        Ok(model)
    }

    fn make(&self, recipe: &Recipe, models: Option<&Path>) -> Result<CertifiedModel, Error> {
        let loaded = LoadedRecipe::load(recipe, models, self.watch)?;
        let model = CertifiedModel::get(&loaded, self.cache, self.watch)?;
        Ok(model.with_paper(self.cache, self.watch)?)
    }

    /// Reports that the measurement begins.
    pub(crate) fn begin_measuring(&self) {
        self.watch.begin(Stage::Comparison);
    }
}

/// Returns the recipe of the first spring of the scenario `growth`.
fn small_spring() -> Recipe {
    Recipe::new("spring-4k", Shape::SMALL_SPRING, ModesSpec::Linear(20))
}
