//! The swept search: triangles that have a point in common on the straight lines between two configurations.

use super::certified_search::CertifiedSearch;
use super::configuration::Configuration;
use super::context::QueryContext;
use super::method::Method;
use super::statistics::Statistics;
use crate::Error;
use crate::detect::narrow_phase::SweptHits;
use crate::detect::vertex_motion::DeformedMotion;

/// Finds the impacts between two configurations, and owns the memory for it.
#[derive(Clone)]
pub(super) struct SweptSearch {
    certified: CertifiedSearch<2>,
    pub(super) narrow: SweptHits,
}

impl SweptSearch {
    pub(super) fn new(context: &QueryContext<'_>) -> Self {
        Self { certified: CertifiedSearch::new(context), narrow: SweptHits::default() }
    }

    /// Finds at most `limit` impacts, sorted by pair. `norm`: the larger one of start and end.
    ///
    /// # Errors
    /// When it was cancelled.
    pub(super) fn find(
        &mut self,
        context: &QueryContext<'_>,
        [t0, t1]: [Configuration<'_>; 2],
        norm: f64,
        limit: usize,
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        let Self { certified, narrow } = self;
        narrow.0.begin(limit);
        certified.broad.begin();
        statistics.root_certified = context.is_root_certified(norm);
        if !statistics.root_certified || !context.detect.exceptions.is_empty() {
            if context.method == Method::BruteForce {
                let positions = |v| [t0.q, t1.q].map(|q| context.model.position(v, q));
                certified.broad.brute_force(&context.detect, positions, narrow);
            } else {
                let motion = DeformedMotion::new([t0.q, t1.q], t0.reach.max(t1.reach));
                certified.broad.begin_volumes(&context.detect, &motion);
                certified.broad.test_exceptions(&context.detect, &motion, narrow);
                if !statistics.root_certified {
                    certified.find(context, norm, &motion, narrow);
                }
            }
            statistics.set_counters(&certified.broad.counters);
            certified.broad.end(narrow)?;
            narrow.0.list.sort_unstable_by_key(|impact| impact.pair);
        }
        statistics.complete = narrow.0.is_complete();
        Ok(())
    }
}
