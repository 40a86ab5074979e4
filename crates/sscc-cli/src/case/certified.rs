//! Certificates with what they cost: computed once, then from the cache.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use sscc::{Certificates, CertifyOptions, Metric, ReducedModel};
use sscc_io::{read_certificates, read_whole, write_certificates, write_whole};

use super::cache::{Cache, Key, program};
use crate::args::Threads;
use crate::load;
use crate::machine::PeakMemory;

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

impl Certified {
    /// From the cache, or computed now.
    pub fn get(
        cache: &Cache,
        name: &str,
        model: &ReducedModel,
        metric: &Metric,
        source: &str,
        budget: usize,
    ) -> Result<Self> {
        let asked = format!("{budget} {metric:?}");
        let key = Key::new("certificates").text(program()?).text(&asked).model(model);
        cache.get(
            &format!("{name}-{key}.sscc.safetensors"),
            |path| Self::read(path, model),
            || Self::compute(model, metric, source, budget),
            |path, certified| certified.write(path),
        )
    }

    fn compute(model: &ReducedModel, metric: &Metric, source: &str, budget: usize) -> Result<Self> {
        let (metric, threads) = (Some(metric.clone()), load::threads(&Threads { threads: None }));
        let options = CertifyOptions { metric, budget, threads: Some(threads), ..CertifyOptions::default() };
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
