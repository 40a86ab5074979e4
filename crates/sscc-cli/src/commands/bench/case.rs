//! A model with its certificates by both schemes: made once, then from the cache.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use sscc::{Certificates, CertifyOptions, ReducedModel};
use sscc_io::{
    ModelInfo, read_certificates, read_model, read_whole, write_certificates, write_model, write_whole,
};

use super::Session;
use super::cache::{Key, program};
use super::machine::PeakMemory;
use super::recipe::{QUICK, Recipe};
use crate::args::Threads;
use crate::load;

/// A model that queries can be made for.
pub struct Case {
    pub name: &'static str,
    pub source: String,
    pub note: Option<String>,
    pub model: ReducedModel,
    /// Angular frequency of each mode (1/s).
    pub frequencies: Vec<f64>,
    /// Certificates of the default budget.
    pub full: Certified,
    /// One radius for each node, as in the paper.
    pub paper: Certified,
}

/// Certificates, and what they cost.
pub struct Certified {
    pub certificates: Certificates,
    pub cost: Cost,
}

/// What it cost to compute certificates.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Cost {
    /// By the wall clock.
    pub seconds: f64,
    pub threads: usize,
    /// The most memory of the whole process meanwhile; none where the system does not tell.
    pub peak_bytes: Option<u64>,
    /// Pairs of nodes in their tree: a file without them would measure another method.
    pairs: usize,
}

impl Case {
    /// From the cache, or made now.
    pub fn get(recipe: &Recipe, session: &Session<'_>) -> Result<Self> {
        let recipe = if session.args.quick { &QUICK } else { recipe };
        let mut surface = recipe.shape.surface(session.models.as_deref())?;
        if session.args.quick {
            surface.note = Some("--quick: a spring of 4,000 triangles stands in for any model".into());
        }
        let (source, note) = (surface.source.clone(), surface.note.clone());
        let key =
            Key::new("model").text(&format!("{:?} {:?}", recipe.shape, recipe.kind)).mesh(&surface.mesh);
        let (model, info) = session.cache.get(
            &format!("{}-{key}.model.safetensors", recipe.name),
            |path| Ok(read_model(path)?),
            || recipe.make(surface),
            |path, (model, info): &(ReducedModel, ModelInfo)| Ok(write_model(path, model, info)?),
        )?;
        let certified = |budget: usize| -> Result<Certified> {
            let key = Key::new("certificates").text(program()?).text(&format!("{budget}")).model(&model);
            session.cache.get(
                &format!("{}-{key}.sscc.safetensors", recipe.name),
                |path| Certified::read(path, &model),
                || Certified::compute(&model, &source, budget),
                |path, certified| certified.write(path),
            )
        };
        let full = certified(CertifyOptions::DEFAULT_BUDGET)?;
        let paper = certified(0)?;
        let elasticity = info.elasticity.context("a model of the cache without its stiffness")?;
        let rank = model.rank();
        let frequencies = (0..rank).map(|k| elasticity.stiffness()[k * (rank + 1)].max(0.0).sqrt()).collect();
        Ok(Self { name: recipe.name, source, note, model, frequencies, full, paper })
    }

    /// Whether the root's certificate alone proves the shape free.
    pub fn is_root_certified(&self, q: &[f64]) -> bool {
        let certificates = &self.full.certificates;
        certificates.metric().norm(q) < certificates.root_radius()
    }
}

impl Certified {
    fn compute(model: &ReducedModel, source: &str, budget: usize) -> Result<Self> {
        let threads = load::threads(&Threads { threads: None });
        let options = CertifyOptions { budget, threads: Some(threads), ..CertifyOptions::default() };
        let peak = PeakMemory::start();
        let start = Instant::now();
        let certificates = load::certify(model, Path::new(source), &options)?;
        let seconds = start.elapsed().as_secs_f64();
        let (peak_bytes, pairs) = (peak.and_then(PeakMemory::bytes), certificates.parts().pair_tree.len());
        Ok(Self { certificates, cost: Cost { seconds, threads, peak_bytes, pairs } })
    }

    fn read(path: &Path, model: &ReducedModel) -> Result<Self> {
        let certificates = read_certificates(path)?;
        certificates.check_model(model)?;
        let beside = path.with_extension("json");
        let cost = serde_json::from_slice(&read_whole(&beside)?);
        let cost: Cost = cost.with_context(|| beside.display().to_string())?;
        let pairs = certificates.parts().pair_tree.len();
        ensure!(
            pairs == cost.pairs,
            "{}: its pair tree has {pairs} pairs, not {}",
            path.display(),
            cost.pairs
        );
        Ok(Self { certificates, cost })
    }

    fn write(&self, path: &Path) -> Result<()> {
        write_certificates(path, &self.certificates)?;
        Ok(write_whole(&path.with_extension("json"), &serde_json::to_vec(&self.cost)?)?)
    }
}
