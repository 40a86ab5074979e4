//! Queries of a model, one for each q of a trajectory.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use sscc::{Impact, Pair, Progress, Query, ReducedModel, Surface};
use sscc_io::Rows;

use super::answer::{DetectionAnswer, earliest_impacts};
use super::contacts::{ContactOptions, Contacts};
use crate::SimError;
use crate::watch::check_cancelled;

/// Queries of a model with modes.
pub struct RowQueries<'a> {
    /// The model of the query.
    pub model: &'a ReducedModel,
    /// The q of each query; of continuous ones that of the start, and the next row that of the end.
    pub rows: &'a Rows,
    /// Whether to answer continuous queries.
    pub is_continuous: bool,
    /// Maximum number of pairs for each query; of continuous queries the earliest. None: all.
    pub limit: Option<usize>,
    /// What discrete queries compute of the contacts of their pairs.
    pub contacts: ContactOptions,
}

/// Calls `take` with the answer to each query, in order. `take` can end that early.
///
/// # Errors
/// When a row is no q of the model, `progress` cancels, or `take` fails.
pub fn check_rows<E: From<SimError>>(
    query: &mut Query<'_>,
    requests: &RowQueries<'_>,
    progress: &dyn Progress,
    mut take: impl FnMut(&DetectionAnswer<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let RowQueries { model, is_continuous, limit, .. } = *requests;
    let rows: Vec<&[f64]> = requests.rows.iter().collect();
    let queries = if is_continuous { rows.len().saturating_sub(1) } else { rows.len() };
    for index in 0..queries {
        check_cancelled(progress)?;
        let start = Instant::now();
        let found = if is_continuous {
            query.continuous(rows[index], rows[index + 1]).map(<[Impact]>::to_vec)
        } else {
            query.discrete_at_most(rows[index], limit.unwrap_or(usize::MAX)).map(|_| Vec::new())
        };
        let microseconds = start.elapsed().as_secs_f64() * 1e6;
        check_cancelled(progress)?;
        let all = found.map_err(SimError::from)?;
        let kept = earliest_impacts(&all, limit);
        let of_kept: Vec<Pair> = kept.iter().map(|impact| impact.pair).collect();
        let times: Vec<f64> = kept.iter().map(|impact| impact.time).collect();
        let statistics = query.statistics();
        let curves = requests.contacts.curves && index + 1 == queries;
        let options = ContactOptions { curves, ..requests.contacts };
        let contacts = match options == ContactOptions::default() || is_continuous {
            true => Contacts::default(),
            false => contacts(model, rows[index], query.pairs(), options).map_err(SimError::from)?,
        };
        let next = take(&DetectionAnswer {
            file: Path::new(""),
            mesh: model.mesh(),
            node: None,
            index,
            time: None,
            pairs: if is_continuous { &of_kept } else { query.pairs() },
            times: is_continuous.then_some(&times),
            penetrations: contacts.penetrations.as_deref(),
            curves: contacts.curves.as_ref(),
            is_complete: statistics.complete && kept.len() == all.len(),
            microseconds,
            norm: Some(query.norm()),
            root_certified: Some(statistics.root_certified),
            opened: statistics.opened,
            box_tests: statistics.box_tests,
            triangle_tests: statistics.triangle_tests,
            queries,
            frames: rows.len(),
            frame_times: None,
            shape: None,
            other: None,
        })?;
        progress.report(index + 1, queries);
        if next.is_break() {
            break;
        }
    }
    Ok(())
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
