//! Searches at several configurations, whose buckets are moved together.
//!
//! Far from rest, searches open nearly the same buckets. Those that most searches of the last group opened are moved
//! before the searches of the next group begin, for all of its configurations at once, so that modes are read and
//! converted once. The searches then run one after the other, as they would alone, and find AABBs that they would have
//! computed themselves, with the same bits. So answers and statistics do not depend on groups, nor on what they expect.

use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::context::QueryContext;
use super::discrete_search::DiscreteSearch;
use super::query::Query;
use super::statistics::Statistics;
use crate::detect::node_volumes::NodeVolumes;
use crate::{Error, Pair, Progress};

/// Configurations at once: as many as their sums fit in the registers of AVX2.
pub(super) const GROUP: usize = 4;

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
pub(super) struct SearchGroup<'a> {
    context: QueryContext<'a>,
    check: ConfigurationCheck,
    /// One for each q of a group. Made when the first group of that size is searched.
    searches: Vec<DiscreteSearch>,
    /// The buckets that the next group is expected to open.
    expected: Vec<u32>,
}

impl<'a> SearchGroup<'a> {
    /// The searches of a query; `progress` may cancel them.
    pub(super) fn new(query: &Query<'a>, progress: &'a dyn Progress) -> Self {
        let mut context = query.context.clone();
        context.detect.progress = progress;
        Self { context, check: query.check.clone(), searches: Vec::new(), expected: Vec::new() }
    }

    /// Answers each q as [`Query::discrete_at_most`] would, all of which the root's certificate does not prove free.
    ///
    /// # Errors
    /// When a q is no configuration of the model; when it was cancelled.
    pub(super) fn answer(&mut self, batch: &[&[f64]], limit: usize) -> Result<Vec<Answer>, Error> {
        let Self { context, check, searches, expected } = self;
        let count = searches.len().max(batch.len());
        searches.resize_with(count, || DiscreteSearch::new(context));
        let mut begun: Vec<Begun<'_, '_>> = Vec::with_capacity(batch.len());
        for (search, q) in searches.iter_mut().zip(batch) {
            let configuration = check.measure(context, q)?;
            search.begin(limit);
            search.begin_volumes(context, configuration);
            begun.push((search, configuration));
        }
        // A search with a limit may end before it opens most buckets.
        if limit == usize::MAX {
            prepare_buckets(context, expected, &mut begun);
        }
        let mut answers = Vec::with_capacity(batch.len());
        for (search, configuration) in &mut begun {
            let mut statistics = Statistics::default();
            search.find_begun(context, *configuration, &mut statistics)?;
            let pairs = search.narrow.0.list.clone();
            answers.push(Answer { pairs, norm: configuration.norm, statistics });
        }
        expect_buckets(context, expected, &begun);
        Ok(answers)
    }
}

/// A search whose volumes have begun, and its configuration.
type Begun<'s, 'q> = (&'s mut DiscreteSearch, Configuration<'q>);

/// Moves buckets for all searches that are not certified by the root.
fn prepare_buckets(context: &QueryContext<'_>, expected: &[u32], searches: &mut [Begun<'_, '_>]) {
    if expected.is_empty() {
        return;
    }
    let is_open = |search: &Begun<'_, '_>| {
        !context.is_root_certified(search.1.norm) && search.0.certified.broad.volumes.can_prepare()
    };
    let open = searches.iter_mut().filter(|search| is_open(search));
    let mut searches: Vec<_> = open
        .map(|(search, configuration)| (&mut search.certified.broad.volumes, configuration.motion()))
        .collect();
    let expected = expected.iter().copied();
    match &mut searches[..] {
        [a, b] => NodeVolumes::prepare_buckets(expected, [a, b]),
        [a, b, c] => NodeVolumes::prepare_buckets(expected, [a, b, c]),
        [a, b, c, d] => NodeVolumes::prepare_buckets(expected, [a, b, c, d]),
        // A search alone gains nothing.
        _ => {}
    }
}

/// Sets the buckets that the next group is expected to open: those that at least three quarters of these searches have
/// opened. None where they have opened few.
fn expect_buckets(context: &QueryContext<'_>, expected: &mut Vec<u32>, searches: &[Begun<'_, '_>]) {
    expected.clear();
    let volumes = || searches.iter().map(|(search, _)| &search.certified.broad.volumes);
    let (count, all) = (context.detect.layout.buckets.count(), searches.len());
    if 4 * volumes().map(NodeVolumes::open_bucket_count).sum::<usize>() < all * count {
        return;
    }
    let is_expected =
        |bucket: &u32| 4 * volumes().filter(|volumes| volumes.is_bucket_open(*bucket)).count() >= 3 * all;
    expected.extend((0..count as u32).filter(is_expected));
}
