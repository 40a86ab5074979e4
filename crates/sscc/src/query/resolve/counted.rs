//! The pairs that count in a search for a free configuration: all pairs, or all except exceptions.

use crate::query::query::Query;
use crate::{Certificates, Error, Pair};

/// The pairs that count in a search.
pub(super) struct Counted {
    /// The certificates whose exceptions do not count; `None` if all pairs count.
    certificates: Option<Certificates>,
}

impl Counted {
    /// Creates the set. `all`: exceptions count, too.
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

    /// Returns the number of pairs that do not count: among more colliding pairs than this at least one counts.
    pub(super) fn others(&self) -> usize {
        self.exceptions().len()
    }

    /// Whether a configuration is free of pairs that count.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub(super) fn is_free(&self, query: &mut Query, q: &[f64]) -> Result<bool, Error> {
        let pairs = query.discrete_at_most(q, with_mutant!(self.others() + 1, ResolvedByFirstPair, 1))?;
        Ok(!pairs.iter().any(|pair| self.contains(*pair)))
    }
}
