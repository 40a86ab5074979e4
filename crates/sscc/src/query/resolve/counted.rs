//! Which pairs a search for a free configuration counts: all, or all but exceptions.

use crate::query::query::Query;
use crate::{Certificates, Error, Pair};

/// The pairs that count in a search: exceptions do not.
pub(super) struct Counted {
    /// The certificates whose exceptions these are; none where all pairs count.
    certificates: Option<Certificates>,
}

impl Counted {
    /// `all`: exceptions count, too.
    pub(super) fn new(query: &Query, all: bool) -> Self {
        Self { certificates: query.context.certificates.clone().filter(|_| !all) }
    }

    fn exceptions(&self) -> &[Pair] {
        self.certificates.as_ref().map_or(&[], Certificates::exceptions)
    }

    /// Whether a pair counts.
    pub(super) fn contains(&self, pair: Pair) -> bool {
        self.exceptions().binary_search(&pair).is_err()
    }

    /// The number of pairs that do not count: of one more colliding pair at least one counts.
    pub(super) fn others(&self) -> usize {
        self.exceptions().len()
    }

    /// Whether a configuration is free of pairs that count.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub(super) fn is_free(&self, query: &mut Query, q: &[f64]) -> Result<bool, Error> {
        let pairs = query.discrete_at_most(q, right_or!(self.others() + 1, ResolvedByFirstPair, 1))?;
        Ok(!pairs.iter().any(|pair| self.contains(*pair)))
    }
}
