//! A model with its certificates by both schemes: made once, then from the cache.

mod cache;
mod certified;
mod recipe;

use std::env;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use sscc::{CertifyOptions, ReducedModel};
use sscc_io::{Elasticity, ModelInfo, read_model, write_model};

pub use cache::{Cache, program};
pub use certified::Certified;
pub use recipe::{Begun, Kind, Recipe, SPRING_RINGS, Shape};

/// The folder of real models: the one that is wanted, else the one that the environment names, else none.
///
/// # Errors
/// When there is no such folder.
pub fn models_folder(wanted: Option<&Path>) -> Result<Option<PathBuf>> {
    let named = env::var_os("SSCC_MODELS").filter(|folder| !folder.is_empty()).map(PathBuf::from);
    let (folder, named_by) = match (wanted, named) {
        (Some(wanted), _) => (wanted.to_owned(), "--models"),
        (None, Some(named)) => (named, "the environment variable SSCC_MODELS"),
        (None, None) => return Ok(None),
    };
    ensure!(folder.is_dir(), "{}: no folder of models; leave out {named_by}", folder.display());
    Ok(Some(folder))
}

/// A model that queries can be made for.
pub struct Case {
    pub name: String,
    pub source: String,
    pub note: Option<String>,
    pub model: ReducedModel,
    pub elasticity: Elasticity,
    /// Certificates of the default budget.
    pub full: Certified,
    /// One radius for each node, as in the paper; only where it is compared.
    pub paper: Option<Certified>,
}

impl Case {
    /// From the cache, or made now.
    pub fn get(begun: &Begun<'_>, cache: &Cache) -> Result<Self> {
        let recipe @ Recipe { name, kind, .. } = begun.recipe();
        let (model, elasticity) = modes(begun, *kind, cache)?;
        let (metric, budget) = (recipe.metric(&model)?, CertifyOptions::DEFAULT_BUDGET);
        let full = Certified::get(cache, name, &model, &metric, &begun.source, budget)?;
        let (source, note) = (begun.source.clone(), begun.note.clone());
        Ok(Self { name: name.clone(), source, note, model, elasticity, full, paper: None })
    }

    /// The same with certificates as in the paper.
    pub fn with_paper(self, cache: &Cache) -> Result<Self> {
        let metric = self.full.certificates.metric();
        let paper = Certified::get(cache, &self.name, &self.model, metric, &self.source, 0)?;
        Ok(Self { paper: Some(paper), ..self })
    }

    /// Whether the root's certificate alone proves the shape free.
    pub fn is_root_certified(&self, q: &[f64]) -> bool {
        let certificates = &self.full.certificates;
        certificates.metric().norm(q) < certificates.root_radius()
    }
}

/// Modes of a shape with their stiffness, from the cache or made now.
pub fn modes(begun: &Begun<'_>, kind: Kind, cache: &Cache) -> Result<(ReducedModel, Elasticity)> {
    let key = begun.key("model").text(&format!("{kind:?}"));
    let (model, info) = cache.get(
        &format!("{}-{key}.model.safetensors", begun.recipe().name),
        |path| Ok(read_model(path)?),
        || begun.modes(kind),
        |path, (model, info): &(ReducedModel, ModelInfo)| Ok(write_model(path, model, info)?),
    )?;
    Ok((model, info.elasticity.context("a model of the cache without its stiffness")?))
}
