//! The hits of one search, up to a limit.

/// Limits of at least this bound only the memory, and end hardly any search.
const PRACTICALLY_UNLIMITED: usize = 1 << 24;

/// Hits, and whether the limit stopped the search.
#[derive(Clone)]
pub(crate) struct Hits<T> {
    pub(crate) list: Vec<T>,
    limit: usize,
    is_full: bool,
}

impl<T> Default for Hits<T> {
    fn default() -> Self {
        Self { list: Vec::new(), limit: usize::MAX, is_full: false }
    }
}

impl<T> Hits<T> {
    /// Clears all hits and starts a search for at most `limit` of them.
    #[inline]
    pub(crate) fn begin(&mut self, limit: usize) {
        self.list.clear();
        self.limit = limit;
        self.is_full = false;
    }

    /// Whether the limit is reached. Call it only if there is another test: it records that the answer is incomplete.
    #[inline]
    pub(crate) fn note_if_full(&mut self) -> bool {
        self.is_full |= self.list.len() >= self.limit;
        self.is_full
    }

    /// Whether the limit is so large that hardly any search ends at it.
    pub(crate) fn is_unlimited(&self) -> bool {
        self.limit >= PRACTICALLY_UNLIMITED
    }

    /// Whether the limit never stopped the search.
    #[inline]
    pub(crate) fn is_complete(&self) -> bool {
        !self.is_full
    }

    /// Sets the limit so that the next call of [`Self::note_if_full`] ends the search.
    pub(crate) fn stop(&mut self) {
        self.limit = 0;
    }
}
