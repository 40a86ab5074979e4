//! The search at one configuration, or on the straight lines between two, by the method of the query.

use super::certified_search::{CertifiedSearch, Sought};
use super::configuration::Configuration;
use super::context::QueryContext;
use super::method::Method;
use crate::Error;
use crate::arithmetic::check_arithmetic;
use crate::detect::answer::{Proof, Statistics};
use crate::detect::narrow_phase::{DiscreteHits, NarrowPhase};
use crate::detect::search::Counters;
use crate::detect::vertex_motion::DeformedMotion;

/// Finds the hits at `E` configurations, and owns the memory for it.
#[derive(Clone)]
pub(super) struct ConfigurationSearch<const E: usize, N> {
    pub(super) certified: CertifiedSearch<E>,
    pub(super) narrow: N,
}

/// The search for the pairs that collide at q.
pub(super) type DiscreteSearch = ConfigurationSearch<1, DiscreteHits>;

/// The search for the pairs that the narrow phase finds between two q.
pub(super) type SweptSearch<N> = ConfigurationSearch<2, N>;

impl<const E: usize, N: NarrowPhase<E> + Default> ConfigurationSearch<E, N> {
    pub(super) fn new(context: &QueryContext) -> Self {
        Self { certified: CertifiedSearch::new(context), narrow: N::default() }
    }

    /// Returns the counters of the last search.
    pub(super) fn counters(&self) -> &Counters {
        &self.certified.broad.state.counters
    }

    /// Finds at most `limit` hits, in no particular order. These are all hits if [`Statistics::complete`] is then true.
    /// The caller has checked that [`QueryContext::is_proven_free`] is false at this norm.
    ///
    /// # Errors
    /// When this thread's floating-point arithmetic is not as the proofs assume, or the search was cancelled.
    #[inline]
    pub(super) fn find(
        &mut self,
        context: &QueryContext,
        ends: [Configuration<'_>; E],
        norm: f64,
        limit: usize,
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        statistics.complete = false;
        let result = self.search(context, ends, norm, limit);
        statistics.set_counters(self.counters());
        statistics.set_proof(result?);
        statistics.complete = self.narrow.hits().is_complete();
        Ok(())
    }

    fn search(
        &mut self,
        context: &QueryContext,
        ends: [Configuration<'_>; E],
        norm: f64,
        limit: usize,
    ) -> Result<Proof, Error> {
        check_arithmetic()?;
        let Self { certified, narrow } = self;
        if context.method == Method::BruteForce {
            let positions = |v| ends.map(|end| context.model.position(v, end.q));
            certified.broad.brute_force(&context.detect, positions, narrow, limit)?;
            return Ok(Proof::Search);
        }
        certified.find(context, norm, &motion(ends), narrow, (Sought::All, limit))
    }
}

impl DiscreteSearch {
    /// Finds at most `limit` colliding pairs at q, sorted.
    ///
    /// # Errors
    /// As [`Self::find`].
    #[inline(never)] // so that a query that needs no search saves no registers
    pub(super) fn find_pairs(
        &mut self,
        context: &QueryContext,
        configuration: Configuration<'_>,
        limit: usize,
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        self.find(context, [configuration], configuration.norm, limit, statistics)?;
        self.narrow.0.list.sort_unstable();
        Ok(())
    }
}

/// Returns the motion of vertices to a configuration, or from one to another.
#[inline]
pub(super) fn motion<const E: usize>(ends: [Configuration<'_>; E]) -> DeformedMotion<'_, E> {
    let largest = ends.iter().map(|end| end.reach).fold(0.0, f64::max);
    let reach = with_mutant!(largest, MotionReachAtStart, ends[0].reach);
    DeformedMotion::new(ends.map(|end| end.q), reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::vertex_motion::VertexMotion;

    #[test]
    fn the_rounding_of_a_motion_is_that_of_both_ends() {
        let at = |reach| Configuration { q: &[0.0], norm: 0.0, reach };
        let [near, far] = [1.0, 1e6].map(|reach| motion([at(reach)]).rounding());
        assert!(near < far);
        assert_eq!([[1.0, 1e6], [1e6, 1.0]].map(|ends| motion(ends.map(at)).rounding()), [far; 2]);
    }
}
