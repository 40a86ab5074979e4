//! State shared by all searches on one mesh, those of queries and those of a detector.

use std::sync::Arc;

use super::layout::{Layout, Needs};
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::{CancelToken, ContactFilter, Pair, ReducedModel};

/// The hierarchy and layout of a mesh, the contact filter, the exceptions, and the token that may cancel a search. Clones share
/// all this data.
#[derive(Clone)]
pub(crate) struct Context {
    pub(crate) hierarchy: Arc<Hierarchy>,
    pub(crate) filter: Arc<PairFilter>,
    /// Exceptions, sorted: pairs that are tested one by one, so that traversals skip them.
    pub(crate) exceptions: Arc<[Pair]>,
    pub(crate) layout: Arc<Layout>,
    pub(crate) cancel: Option<CancelToken>,
}

impl Context {
    /// Creates the context. `needs`: `None` for brute force, which uses no layout.
    pub(crate) fn new(
        model: &ReducedModel,
        hierarchy: Arc<Hierarchy>,
        filter: &ContactFilter,
        exceptions: &[Pair],
        needs: Option<Needs>,
    ) -> Self {
        let filter = PairFilter::new(model, filter);
        let layout =
            needs.map_or_else(Layout::default, |needs| Layout::new(model, &hierarchy, &filter, needs));
        Self {
            hierarchy,
            filter: Arc::new(filter),
            exceptions: exceptions.into(),
            layout: Arc::new(layout),
            cancel: None,
        }
    }

    /// Whether the token cancels, so that a search should end.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(CancelToken::is_cancelled)
    }

    /// Whether a pair is an exception.
    #[inline]
    pub(crate) fn is_exception(&self, pair: Pair) -> bool {
        !self.exceptions.is_empty() && self.exceptions.binary_search(&pair).is_ok()
    }
}
