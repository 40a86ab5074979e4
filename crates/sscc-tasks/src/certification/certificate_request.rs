//! Options of certificates, each of which may be absent.

use std::path::PathBuf;

use sscc::parts::{DEFAULT_BUDGET, DEFAULT_EPSILON, DEFAULT_LOCAL_BUDGET, DEFAULT_REACH, Scope, is_reach};
use sscc::{CertifyOptions, Clearance, ContactFilter, Metric, Neighbours, ReducedModel};

use sscc_io::Setting;

use super::metric::metric;
use crate::error::{At, Result};
use crate::{GroupRules, TaskError, available_threads};

/// Options of certificates. For new certificates, absent options have their defaults. Certificates from a file may have
/// any value of an absent option, except that an absent clearance excludes those with a clearance unless
/// `any_clearance` is true.
#[derive(Clone, Debug, Default)]
pub struct CertificateRequest {
    /// File of the model.
    pub model: PathBuf,
    /// Name of the mesh of a glTF file.
    pub mesh_name: Option<String>,
    /// Largest relative error of the root's radius (`--epsilon`).
    pub epsilon: Option<f64>,
    /// The metric (`--metric`): `energy`, `displacement`, `mass`, `identity` or a file.
    pub metric: Option<PathBuf>,
    /// The centre (`--center`).
    pub center: Option<Vec<f64>>,
    /// Which triangles that share a vertex count (`--neighbours`).
    pub neighbours: Option<Neighbours>,
    /// Whether to weld equal vertices (`--weld`). None means as the mesh requires it ([`ContactFilter::of`]).
    pub weld: Option<bool>,
    /// Pairs within this number of rings of pairs that collide at rest never count (`--ignore-rest`). None ignores no
    /// pair for that reason.
    pub ignore_rest: Option<u32>,
    /// Which pairs of groups of triangles count.
    pub groups: GroupRules,
    /// Maximum number of exceptions (`--max-exceptions`).
    pub max_exceptions: Option<usize>,
    /// Radii at which two triangles come nearer than a clearance (`--clearance`, `--rings`). None means radii of collisions.
    pub clearance: Option<Clearance>,
    /// Whether certificates from a file may have any clearance or no clearance.
    pub any_clearance: bool,
    /// Which certificates to store (`--scheme`).
    pub scheme: Option<Scheme>,
    /// Memory for the pair tree (`--budget`), in bytes for each triangle.
    pub budget: Option<usize>,
    /// Memory for local certificates (`--local-budget`), in bytes for each triangle, in addition to the unused part of `budget`.
    pub local_budget: Option<usize>,
    /// Maximum radius (`--reach`), in units of the global radius of the paper.
    pub reach: Option<f64>,
    /// Number of threads. None means all cores.
    pub threads: Option<usize>,
}

/// Kinds of certificates that are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// The certificates of the nodes and of the pairs of the root's children.
    Paper,
    /// These certificates, the pair tree and local certificates.
    Full,
}

impl CertificateRequest {
    /// Returns the options to compute certificates with.
    ///
    /// # Errors
    /// When a file cannot be read or does not fit the model, the model has no metric of the given name, a name of a
    /// group is unknown, the reach is out of range, or two options contradict each other.
    pub fn options(&self, model: &ReducedModel) -> Result<CertifyOptions> {
        Ok(CertifyOptions::default()
            .epsilon(self.epsilon.unwrap_or(DEFAULT_EPSILON))
            .metric(self.metric(model)?)
            .center(self.center.clone())
            .filter(self.filter(model)?)
            .ignore_rest(self.ignore_rest)
            .max_exceptions(self.max_exceptions)
            .clearance(self.clearance)
            .budget(self.budget()?.unwrap_or(DEFAULT_BUDGET))
            .local_budget(self.local_budget()?.unwrap_or(DEFAULT_LOCAL_BUDGET))
            .reach(self.reach()?.unwrap_or(DEFAULT_REACH))
            .threads(self.threads.unwrap_or_else(available_threads)))
    }

    /// Returns the scope of a query without certificates.
    ///
    /// # Errors
    /// The errors are those of [`CertificateRequest::options`]; also when too many pairs collide at rest for
    /// `ignore_rest`.
    pub fn scope(&self, model: &ReducedModel) -> Result<Scope> {
        let (metric, mut filter) = (self.metric(model)?, self.filter(model)?);
        // These calls refuse contradictions of other options.
        self.budget()?;
        self.local_budget()?;
        self.reach()?;
        if let Some(rings) = self.ignore_rest {
            filter = filter.ignoring_rest(model, rings).in_file(&self.model)?;
        }
        Ok(Scope {
            metric: metric.unwrap_or_else(|| model.metric().clone()),
            center: self.center.clone().unwrap_or_else(|| vec![0.0; model.rank()]),
            filter,
            exceptions: Vec::new(),
            clearance: None,
        })
    }

    /// Returns the metric, if it is stated.
    pub(super) fn metric(&self, model: &ReducedModel) -> Result<Option<Metric>> {
        self.metric.as_deref().map(|typed| metric(model, typed)).transpose()
    }

    /// Returns the contact filter. `ignore_rest` is not part of it.
    fn filter(&self, model: &ReducedModel) -> Result<ContactFilter> {
        let default = ContactFilter::of(model.mesh());
        let weld = self.weld.unwrap_or(default.weld);
        let filter = ContactFilter::new(self.neighbours.unwrap_or(default.neighbours)).weld(weld);
        let triangles = model.mesh().faces().len();
        Ok(match self.groups.of_model(&self.model, self.mesh_name.as_deref(), triangles)? {
            Some(groups) => filter.with_groups(groups),
            None => filter,
        })
    }

    /// Returns the budget of the pair tree; None if neither a scheme nor a budget is given.
    pub(super) fn budget(&self) -> Result<Option<usize>> {
        match (self.scheme, self.budget) {
            (Some(Scheme::Paper), None) => Ok(Some(0)),
            (Some(Scheme::Paper), Some(_)) => {
                Err(refused_by_paper("it stores no pair tree: leave ", Setting::Budget))
            }
            (Some(Scheme::Full), None) => Ok(Some(DEFAULT_BUDGET)),
            (_, budget) => Ok(budget),
        }
    }

    /// Returns the budget of local certificates: 0 for the scheme of the paper, which has none; None if no budget is
    /// given.
    pub(super) fn local_budget(&self) -> Result<Option<usize>> {
        match (self.scheme, self.local_budget) {
            (Some(Scheme::Paper), None) => Ok(Some(0)),
            (Some(Scheme::Paper), Some(_)) => {
                Err(refused_by_paper("it stores no local certificates: leave ", Setting::LocalBudget))
            }
            (_, budget) => Ok(budget),
        }
    }

    /// Returns the maximum radius, if it is given.
    pub(super) fn reach(&self) -> Result<Option<f64>> {
        if self.reach.is_some() && self.scheme == Some(Scheme::Paper) {
            return Err(refused_by_paper("its radii end at the global radius: leave ", Setting::Reach));
        }
        match self.reach {
            Some(reach) if !is_reach(reach) => Err(TaskError::refused(
                Setting::Reach,
                format!("{reach} is not a finite number of at least 1"),
            )),
            reach => Ok(reach),
        }
    }
}

/// Returns the error for a setting that the scheme of the paper excludes.
fn refused_by_paper(cause: &str, excluded: Setting) -> TaskError {
    TaskError::refused(Setting::Scheme + " paper", cause + excluded + " out")
}
