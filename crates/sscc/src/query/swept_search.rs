//! The swept search: pairs of triangles that the narrow phase finds on the straight lines between two configurations.

use super::certified_search::CertifiedSearch;
use super::configuration::Configuration;
use super::context::QueryContext;
use super::method::Method;
use super::statistics::{Proof, Statistics};
use crate::detect::broad_phase::Counters;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::vertex_motion::DeformedMotion;
use crate::{Error, Pair};

/// Finds the hits between two configurations, and owns the memory for it.
#[derive(Clone)]
pub(super) struct SweptSearch<N> {
    certified: CertifiedSearch<2>,
    pub(super) narrow: N,
}

impl<N: NarrowPhase<2> + Default> SweptSearch<N> {
    pub(super) fn new(context: &QueryContext) -> Self {
        Self { certified: CertifiedSearch::new(context), narrow: N::default() }
    }

    /// Counters of the last search.
    pub(super) fn counters(&self) -> &Counters {
        &self.certified.broad.counters
    }

    /// Finds at most `limit` hits, in no particular order; all of them where the search is complete. `norm`: the larger one
    /// of start and end.
    ///
    /// # Errors
    /// When it was cancelled.
    pub(super) fn find(
        &mut self,
        context: &QueryContext,
        [t0, t1]: [Configuration<'_>; 2],
        norm: f64,
        limit: usize,
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        let Self { certified, narrow } = self;
        narrow.hits().begin(limit);
        certified.broad.begin();
        let is_root_certified = context.is_root_certified(norm);
        statistics.set_proof(if is_root_certified { Proof::Radius } else { Proof::Search });
        if !is_root_certified || !context.detect.exceptions.is_empty() {
            if context.method == Method::BruteForce {
                let positions = |v| [t0.q, t1.q].map(|q| context.model.position(v, q));
                certified.broad.brute_force(&context.detect, positions, narrow);
            } else {
                let motion = DeformedMotion::new([t0.q, t1.q], t0.reach.max(t1.reach));
                certified.broad.begin_volumes(&context.detect, &motion);
                certified.broad.test_exceptions(&context.detect, &motion, narrow);
                if !is_root_certified && certified.find(context, norm, &motion, narrow) {
                    statistics.set_proof(Proof::Local);
                }
            }
            statistics.set_counters(&certified.broad.counters);
            certified.broad.end(narrow)?;
        }
        statistics.complete = narrow.hits().is_complete();
        Ok(())
    }

    /// Whether one of these pairs of triangles collides between two configurations.
    ///
    /// # Errors
    /// When it was cancelled.
    pub(super) fn collides(
        &mut self,
        context: &QueryContext,
        [t0, t1]: [Configuration<'_>; 2],
        pairs: &[Pair],
    ) -> Result<bool, Error> {
        let (broad, narrow) = (&mut self.certified.broad, &mut self.narrow);
        narrow.hits().begin(1);
        broad.begin();
        let motion = DeformedMotion::new([t0.q, t1.q], t0.reach.max(t1.reach));
        broad.begin_volumes(&context.detect, &motion);
        for &(a, b) in pairs {
            let [a, b] = [a, b].map(|t| broad.triangle(&context.detect, t));
            broad.test_triangles(&context.detect, a, b, &motion, narrow);
        }
        broad.end(narrow)?;
        Ok(!narrow.hits().list.is_empty())
    }
}
