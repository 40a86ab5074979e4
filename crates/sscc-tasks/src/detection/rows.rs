//! Queries of a model, one for each q of a trajectory.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use sscc::parts::{Scope, Surface};
use sscc::{Answer, Clearance, Impact, Pair, Progress, Query, ReducedModel, Statistics};
use sscc_io::Rows;

use super::answer::{DetectionAnswer, earliest_impacts};
use super::contacts::{ContactOptions, Contacts};
use super::near::Near;
use crate::watch::CancelledBy;
use crate::watch::check_cancelled;
use crate::{LeftOut, TaskError};

/// Queries of a model with modes.
pub struct RowQueries<'a> {
    /// The model of the query.
    pub model: &'a ReducedModel,
    /// The q of each query. For continuous queries it is the q at the start, and the next row is the q at the end.
    pub rows: &'a Rows,
    /// Whether to answer continuous queries.
    pub is_continuous: bool,
    /// Maximum number of pairs for each query; for continuous queries, of the earliest pairs. None means all pairs.
    pub limit: Option<usize>,
    /// Requests the pairs nearer than this, instead of colliding pairs. Only for discrete queries without a limit.
    pub clearance: Option<Clearance>,
    /// Whether the certificates of the query are for the clearance. Then the smallest distance is reported only if it is
    /// below the clearance: the certificates do not prove larger ones.
    pub is_certified: bool,
    /// Number of threads for discrete queries of several q. None means all cores.
    pub threads: Option<usize>,
    /// Options for the contacts of the pairs that discrete queries find.
    pub contacts: ContactOptions,
}

/// Maximum number of q that are answered together. The first q is answered alone. The number then doubles each time, as
/// long as queries take at least [`MIN_MICROSECONDS`]. So the first answers come soon.
const MAX_BLOCK: usize = 256;

/// Queries that take less time than this are answered one by one, because starting threads would take longer.
const MIN_MICROSECONDS: f64 = 20.0;

/// Maximum number of pairs of a block, estimated from the largest number of pairs so far. Blocks with more pairs are made
/// smaller.
const MAX_BLOCK_PAIRS: usize = 1 << 24;

/// Calls `take` with the answer to each query, in order. `take` can end the run early. Discrete queries of several q are
/// answered together ([`Query::batch`]), with the same answers.
///
/// # Errors
/// When a row is not a configuration of the model, more than [`sscc::Detector::MAX_PAIRS`] pairs are nearer than a
/// clearance, `progress` cancels, or `take` fails.
pub fn check_rows<E: From<TaskError>>(
    query: &mut Query,
    requests: &RowQueries<'_>,
    progress: &dyn Progress,
    mut take: impl FnMut(&DetectionAnswer<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let rows: Vec<&[f64]> = requests.rows.iter().collect();
    let queries = if requests.is_continuous { rows.len().saturating_sub(1) } else { rows.len() };
    let (mut next, mut block, mut most_pairs) = (0, 1, 1);
    let scope = Scope::of_query(query);
    let (left_out, exceptions) = (LeftOut::of(&scope.filter), scope.exceptions.len());
    // Rows before this one are answered one by one.
    let mut single = 0;
    while next < queries {
        check_cancelled(progress)?;
        let is_single = requests.is_continuous || requests.clearance.is_some() || next < single;
        let end = queries.min(next + if is_single { 1 } else { block });
        let start = Instant::now();
        let answers = if end - next > 1 {
            let limit = requests.limit.unwrap_or(usize::MAX);
            query
                .batch_at_most(&rows[next..end], limit, requests.threads, &CancelledBy(progress))
                .map(Answers::Batch)
        } else if let Some(clearance) = &requests.clearance {
            near(query, rows[next], clearance, requests.is_certified)
        } else if requests.is_continuous {
            query.continuous(rows[next], rows[next + 1]).map(|impacts| Answers::Motion(impacts.to_vec()))
        } else {
            query.discrete_at_most(rows[next], requests.limit.unwrap_or(usize::MAX)).map(|_| Answers::One)
        };
        let microseconds = start.elapsed().as_secs_f64() * 1e6 / (end - next) as f64;
        check_cancelled(progress)?;
        // One of the rows is not a configuration. The rows before it are answered first, one by one.
        if answers.is_err() && end - next > 1 {
            single = end;
            continue;
        }
        let answers = answers.map_err(TaskError::from)?;
        for index in next..end {
            let found = answers.get(index - next, query, requests.limit);
            most_pairs = most_pairs.max(found.pairs.len());
            let contacts = contacts_of(requests, &rows, index, queries, &found.pairs)?;
            let next = take(&DetectionAnswer {
                file: Path::new(""),
                mesh: requests.model.mesh(),
                node: None,
                other_node: None,
                node_names: [None; 2],
                index,
                time: None,
                pairs: &found.pairs,
                times: found.times.as_deref(),
                penetrations: contacts.penetrations.as_deref(),
                curves: contacts.curves.as_ref(),
                near: requests.clearance.zip(found.near),
                enclosed: None,
                body_penetration: None,
                is_complete: found.is_complete,
                microseconds,
                norm: Some(found.statistics.norm),
                root_certified: Some(found.statistics.root_certified),
                proof: Some(found.statistics.proof),
                exceptions,
                left_out: &left_out,
                opened: found.statistics.opened,
                box_tests: found.statistics.box_tests,
                triangle_tests: found.statistics.triangle_tests,
                queries,
                frames: rows.len(),
                frame_times: None,
                shape: None,
                other: None,
            })?;
            progress.report(index + 1, queries);
            if next.is_break() {
                return Ok(());
            }
        }
        next = end;
        let is_slow = microseconds >= MIN_MICROSECONDS;
        block = if is_slow { (2 * block).min(MAX_BLOCK).min(MAX_BLOCK_PAIRS / most_pairs).max(1) } else { 1 };
    }
    Ok(())
}

/// The answers to the queries of a block.
enum Answers {
    /// The answer to a single q, which the query holds.
    One,
    /// The answers to several q.
    Batch(Vec<Answer>),
    /// All impacts of a motion.
    Motion(Vec<Impact>),
    /// The near pairs of a clearance with their distances, and the cost of the query.
    Near(Vec<Pair>, Near, Statistics),
}

/// The answer to one query.
struct Found<'a> {
    pairs: Cow<'a, [Pair]>,
    times: Option<Vec<f64>>,
    near: Option<&'a Near>,
    is_complete: bool,
    statistics: Statistics,
}

impl Answers {
    /// Returns one answer of the block. For a motion, it has the earliest impacts up to `limit`.
    fn get<'a>(&'a self, number: usize, query: &'a Query, limit: Option<usize>) -> Found<'a> {
        let of_query = |pairs: Cow<'a, [Pair]>, times| Found {
            pairs,
            times,
            near: None,
            is_complete: query.statistics().complete,
            statistics: query.statistics(),
        };
        match self {
            Self::One => of_query(Cow::Borrowed(query.pairs()), None),
            Self::Batch(answers) => {
                let Answer { pairs, statistics } = &answers[number];
                Found {
                    pairs: Cow::Borrowed(pairs),
                    times: None,
                    near: None,
                    is_complete: statistics.complete,
                    statistics: *statistics,
                }
            }
            Self::Near(pairs, near, statistics) => Found {
                pairs: Cow::Borrowed(pairs),
                times: None,
                near: Some(near),
                is_complete: statistics.complete,
                statistics: *statistics,
            },
            Self::Motion(all) => {
                let kept = earliest_impacts(all, limit);
                let pairs = kept.iter().map(|impact| impact.pair).collect();
                let times = kept.iter().map(|impact| impact.time).collect();
                let mut found = of_query(Cow::Owned(pairs), Some(times));
                found.is_complete &= kept.len() == all.len();
                found
            }
        }
    }
}

/// Answers a query for the pairs nearer than a clearance.
fn near(
    query: &mut Query,
    q: &[f64],
    clearance: &Clearance,
    is_certified: bool,
) -> Result<Answers, sscc::Error> {
    let found = query.within(q, clearance)?.to_vec();
    let statistics = query.statistics();
    let (pairs, near) = match is_certified {
        true => Near::of_certified(found),
        false => Near::of(found, || query.nearest(q, clearance.rings()))?,
    };
    Ok(Answers::Near(pairs, near, statistics))
}

/// Returns the contacts at a q that the request requires.
fn contacts_of(
    requests: &RowQueries<'_>,
    rows: &[&[f64]],
    index: usize,
    queries: usize,
    pairs: &[Pair],
) -> Result<Contacts, TaskError> {
    let curves = requests.contacts.curves && index + 1 == queries;
    let options = ContactOptions { curves, ..requests.contacts };
    if options == ContactOptions::default() || requests.is_continuous {
        return Ok(Contacts::default());
    }
    Ok(contacts(requests.model, rows[index], pairs, options)?)
}

/// Returns the contacts of the pairs that collide at q.
fn contacts(
    model: &ReducedModel,
    q: &[f64],
    pairs: &[Pair],
    options: ContactOptions,
) -> Result<Contacts, sscc::Error> {
    let positions = model.positions(q)?;
    Contacts::of(Surface { faces: model.mesh().faces(), positions: &positions }, None, pairs, options)
}
