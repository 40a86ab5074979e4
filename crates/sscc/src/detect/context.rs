//! State shared by all searches of the detector on one mesh.

use std::borrow::Cow;
use std::sync::Arc;

use super::layout::{Layout, Needs};
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::{ContactFilter, Pair, Progress, ReducedModel};

/// The hierarchy and layout of a mesh, the contact filter, the exceptions, and the progress that may cancel a search.
#[derive(Clone)]
pub(crate) struct Context<'a> {
    pub(crate) hierarchy: Cow<'a, Hierarchy>,
    pub(crate) filter: Arc<PairFilter>,
    /// Exceptions, sorted: pairs that are tested one by one, so that traversals leave them out.
    pub(crate) exceptions: &'a [Pair],
    pub(crate) layout: Arc<Layout>,
    pub(crate) progress: &'a dyn Progress,
}

impl<'a> Context<'a> {
    /// `needs`: none for brute force, which uses no layout.
    pub(crate) fn new(
        model: &'a ReducedModel,
        hierarchy: Cow<'a, Hierarchy>,
        filter: &ContactFilter,
        exceptions: &'a [Pair],
        needs: Option<Needs>,
    ) -> Self {
        let filter = PairFilter::new(model, filter);
        let layout =
            needs.map_or_else(Layout::default, |needs| Layout::new(model, &hierarchy, &filter, needs));
        Self { hierarchy, filter: Arc::new(filter), exceptions, layout: Arc::new(layout), progress: &() }
    }

    /// Whether a pair is an exception.
    #[inline]
    pub(crate) fn is_exception(&self, pair: Pair) -> bool {
        !self.exceptions.is_empty() && self.exceptions.binary_search(&pair).is_ok()
    }
}
