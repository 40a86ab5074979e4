//! Attacks on certificates: everything they claim is tried to be proven wrong.
//!
//! Three attacks, none of which uses the code that it attacks to decide: q just inside radii, in random
//! directions and in the directions of the closest collisions known ([`attack`]); the true minimum searched
//! near the hottest pairs ([`minimum`]), which also says how tight radii are ([`tightness`]); and the answers of
//! certified queries, continuous ones too, compared with the traditional method, itself compared with brute force
//! ([`compare`]). Whatever is found to collide is held against all radii that speak of it ([`claims`]): those of nodes,
//! of pairs of nodes, and the limit of the pair tree where that lacks a pair.

mod attack;
mod claims;
mod compare;
mod minimum;
mod random;
mod tightness;

use crate::filter::PairFilter;
use crate::model::ScaledModel;
use crate::threads::on_threads;
use crate::{Certificates, Error, Progress, ReducedModel};

/// How hard to attack.
#[derive(Clone, Copy, Debug)]
pub struct AuditOptions {
    /// Number of configurations q to try.
    pub samples: usize,
    /// Start of the pseudo-random numbers: the same seed gives the same attacks.
    pub seed: u64,
    /// Number of threads; none: all cores. The report is the same for any number.
    pub threads: Option<usize>,
}

impl Default for AuditOptions {
    fn default() -> Self {
        Self { samples: 10_000, seed: 1, threads: None }
    }
}

/// What the attacks found.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditReport {
    /// Number of configurations really tried: 0 where every radius is 0, for nothing is claimed then.
    pub samples: usize,
    /// Every broken claim, one line each. Empty for sound certificates.
    pub violations: Vec<String>,
    /// The root's radius over the smallest `|z|` found at which the model really collides; none when the
    /// radius is 0 or capped, or no collision was found.
    pub root_tightness: Option<f64>,
    /// The median of the same quotient over the root, its pairs of children, and samples of nodes and of the pair
    /// tree, those with radius 0 or capped left out.
    pub tightness_median: Option<f64>,
    /// The least of them.
    pub tightness_min: Option<f64>,
}

/// Attacks the certificates of a model.
///
/// # Errors
/// When the certificates are of another model, or `progress` cancels.
pub fn audit(
    model: &ReducedModel,
    certificates: &Certificates,
    options: &AuditOptions,
    progress: &dyn Progress,
) -> Result<AuditReport, Error> {
    certificates.check_model(model)?;
    let run = || {
        let parts = certificates.parts();
        let scaled = ScaledModel::new(model, &parts.scope.metric, &parts.scope.center);
        let filter = PairFilter::new(model, &parts.scope.rule).leaving_out(&parts.scope.exceptions);
        let minimum = &minimum::Minimum { model, scope: &parts.scope, scaled: &scaled, filter: &filter };
        let claims = &claims::Claims::new(parts);
        let tightness = tightness::measure(certificates, claims, minimum, options.seed, progress);
        let hot = &tightness.hot;
        let attack = attack::Attack { model, certificates, claims, minimum, hot, options, progress };
        let mut violations = tightness.violations;
        let (samples, broken) = attack.run()?;
        violations.extend(broken);
        violations.extend(compare::compare(model, certificates, (claims, minimum), options, progress)?);
        let mut all = tightness.quotients;
        all.sort_by(f64::total_cmp);
        Ok(AuditReport {
            samples,
            violations,
            root_tightness: tightness.root,
            tightness_median: (!all.is_empty()).then(|| all[all.len() / 2]),
            tightness_min: all.first().copied(),
        })
    };
    let report = on_threads(options.threads, run);
    if progress.is_cancelled() { Err(Error::Cancelled) } else { report }
}
