//! Certificates from a file, which must belong to a model and agree with the options that a user states.

use std::path::Path;
use std::sync::Arc;

use sscc::parts::{CertificateParts, DEFAULT_BUDGET, check_filter, is_within_reach};
use sscc::{Certificates, ContactFilter, ReducedModel};
use sscc_io::{Message, Setting, read_certificates};

use super::certificate_request::{CertificateRequest, Scheme};
use crate::TaskError;
use crate::error::{At, Result};
use crate::text::counted;

/// End of the message on a contradiction.
const REMEDY: &str = "; leave the flag out, or certify anew";

/// Maximum number of rings that are tried, so that a message can name those of the certificates.
const MAX_RINGS: u32 = 8;

fn of_rings(rings: u32) -> String {
    match rings {
        0 => String::new(),
        rings => format!(" of {}", counted(u64::from(rings), "ring")),
    }
}

impl CertificateRequest {
    /// Reads certificates. Refuses certificates of another model, and certificates that contradict an option.
    ///
    /// # Errors
    /// When they are refused, an option is invalid, or a file cannot be read.
    pub fn read(&self, path: &Path, model: &ReducedModel) -> Result<Certificates> {
        let certificates = read_certificates(path)?;
        certificates.check_model(model).in_file(path)?;
        self.check_filter(&certificates, model, path)?;
        match self.contradiction(&certificates, model)? {
            Some(cause) => Err(TaskError::refused(path.display(), cause)),
            None => Ok(certificates),
        }
    }

    fn check_filter(&self, certificates: &Certificates, model: &ReducedModel, path: &Path) -> Result<()> {
        let known = certificates.filter();
        let typed = ContactFilter::new(self.neighbours.unwrap_or(known.neighbours))
            .weld(self.weld.unwrap_or(known.weld));
        let typed = typed.ignoring(known.ignored().iter().copied());
        let triangles = model.mesh().faces().len();
        let groups = self.groups.of_model(&self.model, self.mesh_name.as_deref(), triangles)?.map(Arc::new);
        let typed = match groups.as_ref().or(known.groups()) {
            Some(groups) => typed.with_groups(Arc::clone(groups)),
            None => typed,
        };
        check_filter(certificates, &typed).in_file(path)
    }

    /// Returns the first contradiction that `check_filter` does not find. It is the cause of the refusal.
    fn contradiction(&self, certificates: &Certificates, model: &ReducedModel) -> Result<Option<Message>> {
        if let Some(cause) = self.clearance_contradiction(certificates) {
            return Ok(Some(cause));
        }
        let epsilon = certificates.parts().epsilon;
        if let Some(typed) = self.epsilon.filter(|typed| *typed != epsilon) {
            let numbers = format!(" {epsilon}, not {typed}; leave the flag out");
            return Ok(Some("certified with " + Setting::Epsilon + numbers));
        }
        let known = certificates.metric();
        let form = (known.scales(), known.dense_factor());
        let metric = self.metric(model)?;
        if metric.is_some_and(|typed| (typed.scales(), typed.dense_factor()) != form) {
            let cause = format!("certified with another metric ({}) than ", known.kind());
            return Ok(Some(Message::from(cause) + Setting::Metric + REMEDY));
        }
        if self.center.as_deref().is_some_and(|typed| typed != certificates.center()) {
            return Ok(Some("certified about another centre than " + Setting::Center + REMEDY));
        }
        let (tree, triangles) =
            (&certificates.parts().pair_tree, certificates.parts().hierarchy.order().len());
        self.budget()?;
        let has_tree = tree.limit() > 0.0;
        let is_full = has_tree || !certificates.parts().local.nodes.is_empty();
        let is_of_scheme = self.scheme.is_none_or(|scheme| is_full == (scheme == Scheme::Full));
        let is_in_budget = |bytes: usize| has_tree && tree.bytes() <= bytes.saturating_mul(triangles);
        if !is_of_scheme || !self.budget.is_none_or(is_in_budget) {
            let cause =
                format!("its pair tree of {} bytes for {triangles} triangles contradicts ", tree.bytes());
            return Ok(Some(Message::from(cause) + Setting::Scheme + " or " + Setting::Budget + REMEDY));
        }
        self.local_budget()?;
        if !self.is_in_local_budget(certificates.parts()) {
            let bytes = certificates.parts().local.bytes();
            let cause =
                format!("its local certificates of {bytes} bytes for {triangles} triangles contradict ");
            return Ok(Some(Message::from(cause) + Setting::LocalBudget + REMEDY));
        }
        if let Some(reach) = self.reach()? {
            if !has_tree {
                let cause = "it has no pair tree, so " + Setting::Reach;
                return Ok(Some(cause + " has no meaning" + REMEDY));
            }
            if !is_within_reach(certificates, model, reach) {
                let cause = "its radii reach farther than " + Setting::Reach;
                return Ok(Some(cause + format!(" {reach} allows") + REMEDY));
            }
        }
        if let Some(rings) = self.ignore_rest {
            let ContactFilter { neighbours, weld, .. } = *certificates.filter();
            let filter = ContactFilter::new(neighbours).weld(weld);
            let filter = match certificates.filter().groups() {
                Some(groups) => filter.with_groups(Arc::clone(groups)),
                None => filter,
            };
            let ignored = certificates.filter().ignored();
            let ignores = |rings: u32| -> Result<bool> {
                Ok(filter.clone().ignoring_rest(model, rings)?.ignored() == ignored)
            };
            if !ignores(rings)? {
                let known = match ignored {
                    [] => None,
                    _ => (0..=MAX_RINGS).find(|known| ignores(*known).unwrap_or(false)),
                };
                let cause = match (ignored, known) {
                    ([], _) => "certified without ".into(),
                    (_, Some(known)) => {
                        "certified with " + Setting::IgnoreRest + of_rings(known) + ", not with "
                    }
                    (_, None) => Message::from("certified with other ignored pairs than those of "),
                };
                return Ok(Some(cause + Setting::IgnoreRest + of_rings(rings) + REMEDY));
            }
        }
        let exceptions = certificates.exceptions().len();
        Ok(self.max_exceptions.filter(|max| exceptions > *max).map(|_| {
            let cause = format!("certified with {exceptions} exceptions, more than ");
            Message::from(cause) + Setting::MaxExceptions + " allows" + REMEDY
        }))
    }

    /// Returns the reason why certificates do not fit the requested clearance; None if they fit.
    fn clearance_contradiction(&self, certificates: &Certificates) -> Option<Message> {
        let anew = |cause: Message| Some(cause + "; certify anew");
        match (certificates.clearance(), &self.clearance) {
            _ if self.any_clearance => None,
            (None, None) => None,
            (Some(known), None) => {
                let cause = format!(
                    "certified with a clearance ({}), which proves nothing about collisions; add ",
                    known.distance()
                );
                Some(
                    Message::from(cause)
                        + Setting::Clearance
                        + " to ask for near pairs, or certify anew without",
                )
            }
            (None, Some(_)) => anew("certified without " + Setting::Clearance),
            (Some(known), Some(asked)) if known.distance() < asked.distance() => {
                let cause = "certified with a smaller " + Setting::Clearance;
                anew(cause + format!(" ({}) than {}", known.distance(), asked.distance()))
            }
            (Some(known), Some(asked)) if known.rings() > asked.rings() => {
                let cause = format!("certified beyond {} rings, more than ", known.rings());
                anew(Message::from(cause) + Setting::Rings + format!(" {}", asked.rings()))
            }
            (Some(_), Some(_)) => None,
        }
    }

    /// Whether local certificates take no more than their budget and the unused part of the pair tree's budget, which is
    /// `--budget` or the default. A budget of 0 allows none.
    fn is_in_local_budget(
        &self,
        CertificateParts { hierarchy, pair_tree, local, .. }: &CertificateParts,
    ) -> bool {
        let bytes = |budget: usize| budget.saturating_mul(hierarchy.order().len());
        let left = bytes(self.budget.unwrap_or(DEFAULT_BUDGET)).saturating_sub(pair_tree.bytes());
        self.local_budget.is_none_or(|budget| {
            local.nodes.is_empty()
                || budget > 0 && local.budgeted_bytes() <= bytes(budget).saturating_add(left)
        })
    }
}
