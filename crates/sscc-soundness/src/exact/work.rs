//! When a configuration ends before it has asked all that it would: some models take a thousand times longer than others, by
//! decisions of the oracle that need whole numbers, which take a hundred times longer than intervals, or by the core's own exact
//! tests. A configuration that is run again has no limit of time, so that it repeats all that the campaign asked.

use std::cell::Cell;
use std::time::Duration;

use cpu_time::ThreadTime;

/// Maximum number of decisions by integers in one configuration.
const MOST: u64 = 60_000;

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
    SPENT.get() >= MOST || TIME.get().is_some_and(|(start, limit)| start.elapsed() >= limit)
}
