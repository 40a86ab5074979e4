//! Limits the work of one configuration. Some models take a thousand times longer than others: decisions of the oracle by
//! integers take a hundred times longer than those by intervals, and the core's own exact tests may be slow. A configuration
//! that is run again has no limit of time, so that it makes at least the queries that the campaign made.

use std::cell::Cell;
use std::time::Duration;

use cpu_time::ThreadTime;

/// Maximum number of decisions by integers in one configuration.
const MAX_DECISIONS: u64 = 60_000;

thread_local! {
    static SPENT: Cell<u64> = const { Cell::new(0) };
    static TIME: Cell<Option<(ThreadTime, Duration)>> = const { Cell::new(None) };
}

/// Begins a configuration, with a limit of its processor time.
pub fn begin(limit: Option<Duration>) {
    SPENT.set(0);
    TIME.set(limit.map(|limit| (ThreadTime::now(), limit)));
}

/// Counts a decision by integers.
pub fn count() {
    SPENT.set(SPENT.get() + 1);
}

/// Whether the configuration has used up its decisions or its time.
pub fn is_spent() -> bool {
    SPENT.get() >= MAX_DECISIONS || TIME.get().is_some_and(|(start, limit)| start.elapsed() >= limit)
}
