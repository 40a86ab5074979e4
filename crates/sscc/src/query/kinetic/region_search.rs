//! The region search: all pairs that can collide at some z of a region.

use crate::Error;
use crate::detect::narrow_phase::AabbHits;
use crate::query::capsule_motion::CapsuleMotion;
use crate::query::certified_search::{CertifiedSearch, Sought};
use crate::query::context::QueryContext;

/// Finds the pairs whose boxes overlap in a region, and owns the memory for it.
#[derive(Clone)]
pub(super) struct RegionSearch {
    pub(super) certified: CertifiedSearch<2>,
    pub(super) narrow: AabbHits,
}

impl RegionSearch {
    pub(super) fn new(context: &QueryContext) -> Self {
        Self { certified: CertifiedSearch::new(context), narrow: AabbHits::default() }
    }

    /// Finds at most `limit` pairs, sorted, without exceptions. `norm`: the largest `|z|` in the region. False if there are
    /// more pairs.
    ///
    /// # Errors
    /// When the search was cancelled.
    pub(super) fn find(
        &mut self,
        context: &QueryContext,
        motion: &CapsuleMotion<'_>,
        norm: f64,
        limit: usize,
    ) -> Result<bool, Error> {
        let Self { certified, narrow } = self;
        certified.find(context, norm, motion, narrow, (Sought::WithoutExceptions, limit))?;
        if narrow.0.note_if_full() {
            return Ok(false);
        }
        narrow.0.list.sort_unstable();
        Ok(true)
    }
}
