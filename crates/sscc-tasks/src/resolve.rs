//! Free configurations near colliding ones, as the command reports them.

use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

use serde::Serialize;
use sscc::{CancelToken, Certificates, Progress, Query, ReducedModel, ResolveOptions, Resolved};
use sscc_io::Rows;

use crate::error::TaskError;
use crate::text::length;

/// The free configuration near one q. The fields are the keys of its JSON; an infinite number is `null`.
#[derive(Clone, Debug, Serialize)]
pub struct ResolveReport {
    /// Whether a free configuration was found.
    pub resolved: bool,
    /// The free configuration.
    pub q: Option<Vec<f64>>,
    /// Its distance from q in the metric; infinite without a free configuration.
    pub change: f64,
    /// The distance from q of the last configuration on the line from the start to q that continuous queries prove
    /// free; infinite without a free configuration.
    pub safe_scale_change: f64,
}

impl From<Resolved> for ResolveReport {
    fn from(found: Resolved) -> Self {
        let resolved = found.is_resolved();
        let Resolved { q, change, safe_scale_change } = found;
        Self { resolved, q, change, safe_scale_change }
    }
}

impl ResolveReport {
    /// Whether the given q is its own result.
    pub fn is_free_as_given(&self) -> bool {
        self.resolved && self.change == 0.0
    }
}

impl fmt::Display for ResolveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { q, change, safe_scale_change, .. } = self;
        match q {
            None => f.write_str("NOT RESOLVED: the centre collides"),
            Some(_) if self.is_free_as_given() => f.write_str("free as it is"),
            Some(_) => {
                let (change, back) = (length(*change), length(*safe_scale_change));
                write!(f, "resolved  change {change} (stepping back: {back})")
            }
        }
    }
}

/// Rows of a block are as many as were resolved in about this time (s) before. So the first reports come soon, and threads rarely
/// wait for the last row of a block.
const BLOCK_SECONDS: f64 = 1.0;

/// Maximum number of rows of a block.
const MAX_BLOCK: usize = 1 << 16;

/// Resolves every row, on this number of threads. Calls `take` with each report, in the order of the rows; `take` can end the run
/// early.
///
/// # Errors
/// When the certificates are of another model, a row is not a configuration of it, the start of the options is not a
/// configuration or collides, `progress` cancels, or `take` fails.
pub fn resolve_rows<E: From<TaskError>>(
    model: &ReducedModel,
    certificates: &Certificates,
    rows: &Rows,
    options: &ResolveOptions,
    threads: usize,
    progress: &dyn Progress,
    mut take: impl FnMut(usize, ResolveReport) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let query = Query::new(model, certificates).map_err(TaskError::from)?;
    let rows: Vec<&[f64]> = rows.iter().collect();
    let (mut first, mut block) = (0, threads.max(1));
    while first < rows.len() {
        let end = rows.len().min(first + block);
        let part = Part { progress, first, rows: rows.len() };
        let start = Instant::now();
        let found = query.resolve_batch(&rows[first..end], options, Some(threads), &part);
        let seconds = start.elapsed().as_secs_f64();
        for (index, found) in (first..end).zip(found.map_err(TaskError::from)?) {
            if take(index, found.into())?.is_break() {
                return Ok(());
            }
        }
        first = end;
        block = next_block(block, seconds, threads);
    }
    Ok(())
}

/// Returns the number of rows of the next block, at most twice that of the last one, which took `seconds`.
fn next_block(block: usize, seconds: f64, threads: usize) -> usize {
    let in_time = (block as f64 * BLOCK_SECONDS / seconds) as usize;
    in_time.min(2 * block).clamp(threads.max(1), MAX_BLOCK)
}

/// Progress of a block of rows, as a part of that of all rows.
struct Part<'p> {
    progress: &'p dyn Progress,
    /// The first row of the block.
    first: usize,
    /// Number of all rows.
    rows: usize,
}

impl Progress for Part<'_> {
    fn report(&self, done: usize, _total: usize) {
        self.progress.report(self.first + done, self.rows);
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        self.progress.cancel_token()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_take_about_a_second() {
        let next = |block, seconds| next_block(block, seconds, 4);
        assert_eq!([next(4, 0.0), next(4, 1e-6), next(8, 0.25), next(8, 0.8)], [8, 8, 16, 10]);
        assert_eq!([next(40, 4.0), next(8, 100.0), next(MAX_BLOCK, 0.0)], [10, 4, MAX_BLOCK]);
        assert_eq!(next_block(1, 5.0, 0), 1);
    }
}
