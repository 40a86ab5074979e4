//! All colliding pairs at one configuration, by the traditional method. They serve to find exceptions and to ignore pairs
//! ([`ContactFilter::ignoring_rest`]).

use std::sync::Arc;

use super::broad_phase::BroadPhase;
use super::context::Context;
use super::layout::Needs;
use super::narrow_phase::DiscreteHits;
use super::vertex_motion::DeformedMotion;
use crate::filter::{PairFilter, surroundings};
use crate::hierarchy::Hierarchy;
use crate::{ContactFilter, Error, Pair, Progress, ReducedModel};

/// A shape with more colliding pairs than this (128 MiB of them) is refused.
const MAX_PAIRS: usize = 1 << 24;

/// Returns all colliding pairs at q, sorted.
///
/// # Errors
/// When q is not a configuration of the model, the filter's groups are of another mesh or it includes folded neighbours,
/// there are more than 2^24 pairs, or `progress` cancels.
pub(crate) fn colliding_pairs(
    model: &ReducedModel,
    hierarchy: &Arc<Hierarchy>,
    filter: &ContactFilter,
    q: &[f64],
    progress: &dyn Progress,
) -> Result<Vec<Pair>, Error> {
    let reach = model.check_coordinates(q)?;
    filter.check_model(model.mesh().faces().len())?;
    let context = Context::new(model, Arc::clone(hierarchy), filter, &[], Some(Needs::REFIT));
    let context = Context { cancel: progress.cancel_token().cloned(), ..context };
    let mut broad = BroadPhase::<1>::new(&context.layout, false, None);
    let mut narrow = DiscreteHits::default();
    let motion = DeformedMotion::new([q], reach);
    let mut search = broad.search(&context, &motion, &mut narrow, MAX_PAIRS);
    search.traverse((0, 0));
    search.end()?;
    if !narrow.0.is_complete() {
        return Err(Error::TooManyCollisions { most: MAX_PAIRS });
    }
    let mut pairs = narrow.0.list;
    pairs.sort_unstable();
    Ok(pairs)
}

impl ContactFilter {
    /// Returns the same filter, which also ignores the pairs that collide at rest (q = 0), and those within `rings` rings of
    /// them.
    ///
    /// # Errors
    /// When there are more than 2^24 pairs at rest; unless `rings` is 0, when there are more than 2^22 with the rings, or
    /// more than 2^28 must be examined (or 2^24 around one pair); when the filter's groups are of another mesh, or it
    /// includes folded neighbours.
    pub fn ignoring_rest(self, model: &ReducedModel, rings: u32) -> Result<Self, Error> {
        let hierarchy = Arc::new(Hierarchy::build(model, model.metric()));
        let pairs = colliding_pairs(model, &hierarchy, &self, &vec![0.0; model.rank()], &())?;
        self.ignoring_around(model, pairs, rings, &())
    }

    /// Returns the same filter, which also ignores these pairs and those within `rings` rings of them.
    ///
    /// # Errors
    /// When there are too many such pairs, or `progress` cancels.
    pub(crate) fn ignoring_around(
        self,
        model: &ReducedModel,
        pairs: Vec<Pair>,
        rings: u32,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let filter = PairFilter::new(model, &self);
        let around = surroundings(&filter, &pairs, rings, progress.cancel_token())?;
        Ok(self.ignoring(around))
    }
}
