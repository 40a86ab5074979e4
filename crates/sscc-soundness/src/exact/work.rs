//! How many decisions of a configuration needed whole numbers. They take a hundred times longer than intervals, so a
//! configuration ends before its time where it needs too many: a limit that, unlike a clock, is the same in every run.

use std::cell::Cell;

/// Decisions of a configuration.
const MOST: u64 = 60_000;

thread_local! {
    static SPENT: Cell<u64> = const { Cell::new(0) };
}

/// Begins a configuration.
pub fn begin() {
    SPENT.set(0);
}

/// Counts a decision.
pub fn count() {
    SPENT.set(SPENT.get() + 1);
}

/// Whether the configuration has used up its decisions.
pub fn is_spent() -> bool {
    SPENT.get() >= MOST
}
