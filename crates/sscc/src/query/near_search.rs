//! The search for near triangles at q with certificates of a clearance.
//!
//! While `|z|` is below the radius of a node or node pair, none of its triangle pairs is nearer than the clearance of the certificates,
//! hence than any smaller one. The traversals are those of collisions: they open node pairs whose radius is reached, down to AABBs that
//! are wider by half of the clearance ([`WidenedMotion`]). Moving hulls and local certificates are not used: they prove that parts do
//! not collide, but no distance between them.

use super::certified_search::{CertifiedSearch, Sought};
use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::context::QueryContext;
use super::widened_motion::WidenedMotion;
use crate::arithmetic::check_arithmetic;
use crate::detect::answer::Statistics;
use crate::detect::narrow_phase::{ClearanceHits, NarrowPhase, NearPair};
use crate::detect::vertex_motion::DeformedMotion;
use crate::filter::Rings;
use crate::{CancelToken, Certificates, Clearance, Detector, Error};

/// Finds near triangles, and owns the memory for it.
#[derive(Clone)]
pub(super) struct NearSearch {
    context: QueryContext,
    check: ConfigurationCheck,
    search: CertifiedSearch<1>,
    narrow: ClearanceHits,
    /// The number of rings of the last search, and these rings.
    rings: Option<(u32, Rings)>,
    /// `|z|` of the last search, rounded up.
    pub(super) norm: f64,
}

impl NearSearch {
    /// Creates the search. `context`: the context of queries of collisions of the same model.
    pub(super) fn new(context: &QueryContext, certificates: &Certificates) -> Self {
        let context = context.of_clearance(certificates);
        Self {
            check: ConfigurationCheck::new(&context),
            search: CertifiedSearch::new(&context),
            narrow: ClearanceHits::default(),
            rings: None,
            norm: 0.0,
            context,
        }
    }

    /// Whether the certificates prove pairs farther apart than a clearance: their clearance is at least as large, and
    /// has no more rings.
    pub(super) fn is_for(&self, clearance: &Clearance) -> bool {
        self.context.certificates.as_ref().is_some_and(|certified| certified.is_within_clearance(clearance))
    }

    /// Returns the near pairs of the last search.
    pub(super) fn pairs(&self) -> &[NearPair] {
        &self.narrow.hits.list
    }

    /// Finds all near pairs at q, sorted. [`Self::is_for`] must be true for the clearance. `statistics` are empty before the call.
    ///
    /// # Errors
    /// When q is not a configuration of the model, this thread's arithmetic is not that of IEEE 754, there are more
    /// than [`Detector::MAX_PAIRS`] pairs (including those within the rings), or the token cancels.
    pub(super) fn find(
        &mut self,
        q: &[f64],
        clearance: &Clearance,
        cancel: Option<&CancelToken>,
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        self.narrow.hits.list.clear();
        self.norm = 0.0;
        let configuration = self.check.measure(&self.context, q)?;
        self.norm = configuration.norm;
        if self.context.is_proven_free(configuration.norm) {
            *statistics = Statistics::PROVEN_FREE;
            return Ok(());
        }
        check_arithmetic()?;
        self.context.detect.cancel = cancel.cloned();
        self.narrow.distance = clearance.distance();
        let Configuration { norm, reach, .. } = configuration;
        let deformed = DeformedMotion::new([q], reach);
        let motion = WidenedMotion::new(deformed, &self.context.detect.layout, clearance.distance());
        let sought = (Sought::All, Detector::MAX_PAIRS);
        let found = self.search.find(&self.context, norm, &motion, &mut self.narrow, sought);
        statistics.set_counters(&self.search.broad.state.counters);
        let proof = found?;
        if !self.narrow.hits().is_complete() {
            return Err(Error::TooManyNearPairs { most: Detector::MAX_PAIRS });
        }
        self.leave_out_rings(clearance.rings())?;
        self.narrow.hits.list.sort_unstable_by_key(|near| near.pair);
        statistics.set_proof(proof);
        statistics.complete = true;
        Ok(())
    }

    /// Removes the pairs within the rings.
    ///
    /// # Errors
    /// When the token cancels; then the list of pairs is incomplete.
    fn leave_out_rings(&mut self, rings: u32) -> Result<(), Error> {
        if rings <= 1 || self.narrow.hits.list.is_empty() {
            return Ok(());
        }
        let detect = &self.context.detect;
        self.rings =
            self.rings.take().filter(|(count, _)| with_mutant!(*count == rings, RingsOfFirstQuery, true));
        let (_, own) = self.rings.get_or_insert_with(|| (rings, Rings::new(&detect.filter, rings)));
        let list = &mut self.narrow.hits.list;
        // The test of rings is faster if the first triangle is that of the pair before.
        list.sort_unstable_by_key(|near| near.pair);
        let mut is_cancelled = false;
        list.retain(|NearPair { pair: (a, b), .. }| {
            is_cancelled |= detect.is_cancelled();
            !is_cancelled && !own.contain(&detect.filter, *a, *b)
        });
        if is_cancelled { Err(Error::Cancelled) } else { Ok(()) }
    }
}
