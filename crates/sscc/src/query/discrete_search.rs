//! The discrete search: colliding pairs at one configuration.

use super::certified_search::CertifiedSearch;
use super::configuration::Configuration;
use super::context::QueryContext;
use super::method::Method;
use super::statistics::{Proof, Statistics};
use crate::Error;
use crate::detect::narrow_phase::DiscreteHits;

/// Finds the pairs that collide at q, and owns the memory for it.
#[derive(Clone)]
pub(super) struct DiscreteSearch {
    pub(super) certified: CertifiedSearch<1>,
    pub(super) narrow: DiscreteHits,
}

impl DiscreteSearch {
    pub(super) fn new(context: &QueryContext) -> Self {
        Self { certified: CertifiedSearch::new(context), narrow: DiscreteHits::default() }
    }

    /// Forgets all hits, and allows at most `limit` of them in the next search.
    #[inline]
    pub(super) fn begin(&mut self, limit: usize) {
        self.narrow.0.begin(limit);
        self.certified.broad.begin();
    }

    /// Finds all pairs at q, sorted.
    ///
    /// # Errors
    /// When it was cancelled.
    pub(super) fn find(
        &mut self,
        context: &QueryContext,
        configuration: Configuration<'_>,
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        let is_root_certified = context.is_root_certified(configuration.norm);
        statistics.set_proof(if is_root_certified { Proof::Radius } else { Proof::Search });
        if !is_root_certified || !context.detect.exceptions.is_empty() {
            let result = self.search(context, configuration, is_root_certified);
            statistics.set_counters(&self.certified.broad.counters);
            if result? {
                statistics.set_proof(Proof::Local);
            }
        }
        statistics.complete = self.narrow.0.is_complete();
        Ok(())
    }

    /// Returns whether the root's local certificate was the proof.
    fn search(
        &mut self,
        context: &QueryContext,
        configuration: Configuration<'_>,
        is_root_certified: bool,
    ) -> Result<bool, Error> {
        let Self { certified, narrow } = self;
        let mut is_root_proven = false;
        if context.method == Method::BruteForce {
            certified.broad.brute_force(
                &context.detect,
                |v| [context.model.position(v, configuration.q)],
                narrow,
            );
        } else {
            let motion = configuration.motion();
            certified.broad.begin_volumes(&context.detect, &motion);
            certified.broad.test_exceptions(&context.detect, &motion, narrow);
            if !is_root_certified {
                is_root_proven = certified.find(context, configuration.norm, &motion, narrow);
            }
        }
        certified.broad.end(narrow)?;
        narrow.0.list.sort_unstable();
        Ok(is_root_proven)
    }
}
