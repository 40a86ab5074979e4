//! Queries of a model, one for each q of a trajectory.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use sscc::{Impact, Pair, Progress, Query, TriMesh};
use sscc_io::Rows;

use super::answer::{DetectionAnswer, earliest_impacts};
use crate::SimError;
use crate::watch::check_cancelled;

/// Calls `take` with the answer to each query, in order, with at most `limit` pairs: at each row, or from each row to the
/// next. `mesh` is that of the model. `take` can end that early.
///
/// # Errors
/// When a row is no q of the model, `progress` cancels, or `take` fails.
pub fn check_rows<E: From<SimError>>(
    query: &mut Query<'_>,
    mesh: &TriMesh,
    rows: &Rows,
    is_continuous: bool,
    limit: usize,
    progress: &dyn Progress,
    mut take: impl FnMut(&DetectionAnswer<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let rows: Vec<&[f64]> = rows.iter().collect();
    let queries = if is_continuous { rows.len() - 1 } else { rows.len() };
    for index in 0..queries {
        check_cancelled(progress)?;
        let start = Instant::now();
        let found = if is_continuous {
            query.continuous(rows[index], rows[index + 1]).map(<[Impact]>::to_vec)
        } else {
            query.discrete_at_most(rows[index], limit).map(|_| Vec::new())
        };
        let microseconds = start.elapsed().as_secs_f64() * 1e6;
        check_cancelled(progress)?;
        let all = found.map_err(SimError::from)?;
        let kept = earliest_impacts(&all, limit);
        let of_kept: Vec<Pair> = kept.iter().map(|impact| impact.pair).collect();
        let times: Vec<f64> = kept.iter().map(|impact| impact.time).collect();
        let statistics = query.statistics();
        let next = take(&DetectionAnswer {
            file: Path::new(""),
            mesh,
            node: None,
            index,
            time: None,
            pairs: if is_continuous { &of_kept } else { query.pairs() },
            times: is_continuous.then_some(&times),
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
