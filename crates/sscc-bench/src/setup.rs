//! Where the models of a bench come from, and who follows its progress.

use std::path::Path;

use sscc_sim::{Cache, CertifiedModel, LoadedRecipe, ModesSpec, Recipe, Shape, Stage, Watch};

use crate::error::Error;

/// What every scenario needs.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// The folder of the real models; none: embedded shapes stand in.
    pub models: Option<&'a Path>,
    /// Where models, certificates and simulations are kept.
    pub cache: &'a Cache,
    /// Whether a spring of 4,000 triangles stands in for any model.
    pub is_quick: bool,
    /// Follows and cancels all work.
    pub watch: &'a dyn Watch,
}

impl Setup<'_> {
    /// A model with both sets of certificates.
    pub(crate) fn certified_model(&self, recipe: &Recipe) -> Result<CertifiedModel, Error> {
        if !self.is_quick {
            return self.make(recipe, self.models);
        }
        let mut model = self.make(&small_spring(), None)?;
        model.note = Some("--quick: a spring of 4,000 triangles stands in for any model".into());
        Ok(model)
    }

    fn make(&self, recipe: &Recipe, models: Option<&Path>) -> Result<CertifiedModel, Error> {
        let loaded = LoadedRecipe::load(recipe, models, self.watch)?;
        let model = CertifiedModel::get(&loaded, self.cache, self.watch)?;
        Ok(model.with_paper(self.cache, self.watch)?)
    }

    /// Measuring begins.
    pub(crate) fn begin_measuring(&self) {
        self.watch.begin(Stage::Comparison);
    }
}

/// The first spring of the scenario `growth`.
fn small_spring() -> Recipe {
    Recipe::new("spring-4k", Shape::SMALL_SPRING, ModesSpec::Linear(20))
}
