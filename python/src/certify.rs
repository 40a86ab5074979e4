//! `Model.certify`: its arguments, and their conversion to options of the core.

use std::sync::Arc;

use pyo3::prelude::*;
use sscc::parts::{
    DEFAULT_BUDGET, DEFAULT_EPSILON, DEFAULT_LOCAL_BUDGET, DEFAULT_REACH, check_models, is_reach,
};
use sscc::{CertifyOptions, Clearance, ContactFilter, Error};

use crate::arguments::{choice, count, neighbours_by_name, number, switch};
use crate::arrays::vector;
use crate::certificates::Certificates;
use crate::clearance::clearance;
use crate::errors::{refused, value};
use crate::groups::with_groups;
use crate::interrupt::run;
use crate::metric::read_metric;
use crate::model::{LoadedModel, Model};
use crate::pool::{CertifiedModel, Pool, threads};

/// The arguments of `Model.certify`, except `progress`; `None` for an absent one.
pub struct CertifyArguments<'a, 'py> {
    pub epsilon: Option<&'a Bound<'py, PyAny>>,
    pub metric: Option<&'a Bound<'py, PyAny>>,
    pub center: Option<&'a Bound<'py, PyAny>>,
    pub scheme: Option<&'a Bound<'py, PyAny>>,
    pub budget: Option<&'a Bound<'py, PyAny>>,
    pub local_budget: Option<&'a Bound<'py, PyAny>>,
    pub reach: Option<&'a Bound<'py, PyAny>>,
    pub neighbours: Option<&'a Bound<'py, PyAny>>,
    pub weld: Option<&'a Bound<'py, PyAny>>,
    pub ignore_rest: Option<&'a Bound<'py, PyAny>>,
    pub max_exceptions: Option<&'a Bound<'py, PyAny>>,
    pub clearance: Option<&'a Bound<'py, PyAny>>,
    pub rings: Option<&'a Bound<'py, PyAny>>,
    pub groups: Option<&'a Bound<'py, PyAny>>,
    pub ignore_groups: Option<&'a Bound<'py, PyAny>>,
    pub threads: Option<&'a Bound<'py, PyAny>>,
}

#[derive(Clone, Copy, PartialEq)]
enum Scheme {
    Paper,
    Full,
}

impl CertifyArguments<'_, '_> {
    /// Returns the clearance; `None` without the argument.
    fn clearance(&self) -> PyResult<Option<Clearance>> {
        match (self.clearance, self.rings) {
            (Some(distance), rings) => clearance(distance, rings).map(Some),
            (None, Some(_)) => Err(value("rings is set without clearance: set both, or neither")),
            (None, None) => Ok(None),
        }
    }

    /// Returns the options of the core. An error names the argument.
    pub fn options(&self, loaded: &LoadedModel) -> PyResult<CertifyOptions> {
        let model = &loaded.model;
        let center = match self.center {
            None => None,
            Some(center) => {
                let center = vector(center, "center")?;
                model.check_coordinates(&center).map_err(|error| refused(&error, "center"))?;
                Some(center)
            }
        };
        let epsilon = number(self.epsilon, "epsilon")?.unwrap_or(DEFAULT_EPSILON);
        if !(epsilon > 0.0 && epsilon < 1.0) {
            return Err(value(format!("epsilon is {epsilon}: a number between 0 and 1 was expected")));
        }
        let scheme = choice(self.scheme, "scheme", &[("full", Scheme::Full), ("paper", Scheme::Paper)])?;
        let budget = count(self.budget, "budget", 0..=u32::MAX as usize)?;
        if scheme == Some(Scheme::Paper) && budget.is_some() {
            return Err(value("scheme 'paper' stores no pair tree: leave budget out"));
        }
        let local_budget = count(self.local_budget, "local_budget", 0..=u32::MAX as usize)?;
        if scheme == Some(Scheme::Paper) && local_budget.is_some() {
            return Err(value("scheme 'paper' stores no local certificates: leave local_budget out"));
        }
        let (budget, local_budget) = match scheme {
            Some(Scheme::Paper) => (0, 0),
            _ => (budget.unwrap_or(DEFAULT_BUDGET), local_budget.unwrap_or(DEFAULT_LOCAL_BUDGET)),
        };
        let reach = number(self.reach, "reach")?;
        if scheme == Some(Scheme::Paper) && reach.is_some() {
            return Err(value("scheme 'paper' ends radii at the global radius: leave reach out"));
        }
        let reach = reach.unwrap_or(DEFAULT_REACH);
        if !is_reach(reach) {
            return Err(value(format!("reach is {reach}: a finite number of at least 1 was expected")));
        }
        let neighbours = choice(self.neighbours, "neighbours", &neighbours_by_name())?.unwrap_or_default();
        check_models(neighbours).map_err(|error| refused(&error, "neighbours"))?;
        let weld = switch(self.weld, "weld")?.unwrap_or(ContactFilter::of(model.mesh()).weld);
        let filter = ContactFilter::new(neighbours).weld(weld);
        let triangles = model.mesh().faces().len();
        Ok(CertifyOptions::default()
            .epsilon(epsilon)
            .metric(read_metric(model, self.metric)?)
            .center(center)
            .filter(with_groups(filter, triangles, self.groups, self.ignore_groups)?)
            .ignore_rest(rest_rings(self.ignore_rest)?)
            .max_exceptions(count(self.max_exceptions, "max_exceptions", 0..=usize::MAX)?)
            .clearance(self.clearance()?)
            .budget(budget)
            .local_budget(local_budget)
            .reach(reach)
            .threads(threads(self.threads)?))
    }
}

/// Computes certificates. Ctrl-C stops the computation.
pub fn certify(
    model: &Bound<'_, Model>,
    arguments: &CertifyArguments<'_, '_>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Certificates> {
    let loaded = Arc::clone(&model.get().loaded);
    let options = arguments.options(&loaded)?;
    let pool = run(model.py(), progress, "certifying", move |progress| -> Result<Pool, Error> {
        let certificates = sscc::Certificates::compute(&loaded.model, &options, progress)?;
        Pool::of(CertifiedModel { loaded, certificates })
    })?;
    let pool = pool.map_err(|error| refused(&error, ""))?;
    Ok(Certificates { model: model.clone().unbind(), pool: Arc::new(pool) })
}

/// Returns the number of rings around pairs that collide at rest. `True` means 0: these pairs only. `None` for `False`
/// and for an absent argument: no pair is ignored.
pub fn rest_rings(typed: Option<&Bound<'_, PyAny>>) -> PyResult<Option<u32>> {
    if let Some(Ok(is_ignored)) = typed.map(|typed| typed.extract::<bool>()) {
        return Ok(is_ignored.then_some(0));
    }
    Ok(count(typed, "ignore_rest", 0..=u32::MAX as usize)?.map(|rings| rings as u32))
}
