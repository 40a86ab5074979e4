//! The searches of one thread that answers a part of a batch.

use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::context::QueryContext;
use super::discrete_search::DiscreteSearch;
use super::query::Query;
use super::statistics::Statistics;
use crate::detect::expected_buckets::ExpectedBuckets;
use crate::{CancelToken, Error, Pair};

/// The answer for one q of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// All colliding pairs, sorted.
    pub pairs: Vec<Pair>,
    /// [`Query::norm`]
    pub norm: f64,
    /// The cost of this q.
    pub statistics: Statistics,
}

/// The searches of one thread.
pub(super) struct SearchGroup {
    context: QueryContext,
    check: ConfigurationCheck,
    search: DiscreteSearch,
    /// Made when several q are first answered together.
    ahead: Option<ExpectedBuckets<1>>,
}

impl SearchGroup {
    /// The searches of a query; the token may cancel them.
    pub(super) fn new(query: &Query, cancel: Option<CancelToken>) -> Self {
        let mut context = query.context.clone();
        context.detect.cancel = cancel;
        let search = DiscreteSearch::new(&context);
        Self { context, check: query.check.clone(), search, ahead: None }
    }

    /// Answers the q of one group as [`Query::discrete_at_most`] would. The root's certificate proves none of them free.
    ///
    /// # Errors
    /// When a q is no configuration of the model; when it was cancelled.
    pub(super) fn answer(&mut self, batch: &[&[f64]], limit: usize) -> Result<Vec<Answer>, Error> {
        let Self { context, check, search, ahead } = self;
        let configurations: Vec<Configuration<'_>> =
            batch.iter().map(|q| check.measure(context, q)).collect::<Result<_, _>>()?;
        let is_together = batch.len() > 1
            && !context.detect.layout.coarse.is_empty()
            && configurations.iter().all(|configuration| is_far(context, configuration.norm, limit));
        let layout = &context.detect.layout;
        let mut ahead = is_together.then(|| ahead.get_or_insert_with(|| ExpectedBuckets::new(layout)));
        if let Some(ahead) = &mut ahead {
            let motions: Vec<_> = configurations.iter().map(Configuration::motion).collect();
            ahead.begin(layout, &motions);
        }
        let mut answers = Vec::with_capacity(batch.len());
        for (i, configuration) in configurations.into_iter().enumerate() {
            let mut statistics = Statistics::default();
            search.begin(limit);
            if let Some(ahead) = &mut ahead {
                search.certified.broad.volumes.exchange_positions(ahead.of_search(i));
            }
            let found = search.find(context, configuration, &mut statistics);
            if let Some(ahead) = &mut ahead {
                let volumes = &mut search.certified.broad.volumes;
                volumes.exchange_positions(ahead.of_search(i));
                ahead.count(|bucket| volumes.is_bucket_open(bucket));
            }
            found?;
            let pairs = search.narrow.0.list.clone();
            answers.push(Answer { pairs, norm: configuration.norm, statistics });
        }
        if let Some(ahead) = &mut ahead {
            ahead.end(batch.len());
        }
        Ok(answers)
    }
}

/// Whether buckets are moved for a q of this norm and others at once: beyond the pair tree searches open many, and no
/// limit ends them early.
pub(super) fn is_far(context: &QueryContext, norm: f64, limit: usize) -> bool {
    limit == usize::MAX
        && context.used_certificates().is_some()
        && !context.is_root_certified(norm)
        && context.complete_pair_tree(norm).is_none()
}
