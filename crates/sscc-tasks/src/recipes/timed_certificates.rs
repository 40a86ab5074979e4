//! Certificates with their cost: computed once, then read from the cache.

use std::path::Path;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use sscc::parts::DEFAULT_LOCAL_BUDGET;
use sscc::{Certificates, CertifyOptions, Metric, ReducedModel};
use sscc_io::{read_certificates, read_whole, write_certificates, write_whole};

use super::cache::Cache;
use super::key::Key;
use crate::error::At;
use crate::machine::{PeakMemory, available_threads};
use crate::{Stage, TaskError, Watch};

/// Certificates with their cost.
pub struct TimedCertificates {
    /// The certificates.
    pub certificates: Certificates,
    /// Their cost.
    pub cost: CertificateCost,
}

/// The cost of computing certificates.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct CertificateCost {
    /// Wall-clock time (s).
    pub seconds: f64,
    /// Threads that computed them.
    pub threads: usize,
    /// Peak memory of the whole process during the computation (bytes); None if the system does not report it.
    pub peak_bytes: Option<u64>,
    /// Number of node pairs in the pair tree. A file with another number would measure another method.
    pairs: usize,
}

impl TimedCertificates {
    /// Reads certificates from the cache, or computes them with the metric and the budget (bytes for each triangle).
    /// With a budget of 0 they are those of the paper, without local certificates; else local certificates have the
    /// default budget. They ignore pairs that collide at rest. `source` is the origin of the model in errors.
    pub(crate) fn get(
        cache: &Cache,
        name: &str,
        model: &ReducedModel,
        metric: &Metric,
        source: &str,
        budget: usize,
        watch: &dyn Watch,
    ) -> Result<Self, TaskError> {
        let options = format!("{budget} {} ignore-rest {metric:?}", local_budget(budget));
        let key = Key::new("certificates").text(cache.program()?).text(&options).model(model);
        cache.get(
            &format!("{name}-{key}.sscc.safetensors"),
            watch,
            |path| Self::read(path, model),
            || Self::compute(model, metric, budget, watch).at(|| source.to_owned()),
            |path, certified| certified.write(path),
        )
    }

    fn compute(
        model: &ReducedModel,
        metric: &Metric,
        budget: usize,
        watch: &dyn Watch,
    ) -> Result<Self, TaskError> {
        let (metric, threads) = (Some(metric.clone()), available_threads());
        let options = CertifyOptions::default()
            .metric(metric)
            .budget(budget)
            .local_budget(local_budget(budget))
            .ignore_rest(0)
            .threads(threads);
        watch.begin(Stage::Certificates);
        let peak = PeakMemory::start();
        let start = Instant::now();
        let certificates = Certificates::compute(model, &options, watch)?;
        let seconds = start.elapsed().as_secs_f64();
        let (peak_bytes, pairs) = (peak.and_then(PeakMemory::bytes), certificates.parts().pair_tree.len());
        Ok(Self { certificates, cost: CertificateCost { seconds, threads, peak_bytes, pairs } })
    }

    fn read(path: &Path, model: &ReducedModel) -> Result<Self, TaskError> {
        let certificates = read_certificates(path)?;
        certificates.check_model(model)?;
        let beside = path.with_extension("json");
        let cost: CertificateCost = serde_json::from_slice(&read_whole(&beside)?)
            .map_err(|error| TaskError::refused(beside.display(), error.to_string()))?;
        let pairs = certificates.parts().pair_tree.len();
        if pairs != cost.pairs {
            let cause = format!("the pair tree has {pairs} pairs, not {}", cost.pairs);
            return Err(TaskError::refused(path.display(), cause));
        }
        Ok(Self { certificates, cost })
    }

    fn write(&self, path: &Path) -> Result<(), TaskError> {
        write_certificates(path, &self.certificates)?;
        let beside = path.with_extension("json");
        let cost = serde_json::to_vec(&self.cost)
            .map_err(|error| TaskError::refused(beside.display(), error.to_string()))?;
        Ok(write_whole(&beside, &cost)?)
    }
}

/// Returns the budget of local certificates for this budget of the pair tree.
fn local_budget(budget: usize) -> usize {
    if budget == 0 { 0 } else { DEFAULT_LOCAL_BUDGET }
}
