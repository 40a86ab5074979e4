//! How far a simulation is, and how fast: a bar for people.

use std::cell::Cell;
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Between two looks at the clock.
const PAUSE: Duration = Duration::from_millis(200);

/// Shows steps done, and seconds simulated in each second that passes.
pub struct Meter {
    bar: Option<ProgressBar>,
    /// Steps that had been done before, and when it began.
    start: Cell<(usize, Instant)>,
    shown: Cell<(usize, Instant)>,
}

impl Meter {
    /// Visible where standard error is a terminal.
    pub fn new() -> Self {
        let bar = stderr().is_terminal().then(|| {
            let style =
                ProgressStyle::with_template("simulating [{wide_bar}] {percent}% {elapsed_precise} {msg}");
            ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        let now = (0, Instant::now());
        Self { bar, start: Cell::new(now), shown: Cell::new(now) }
    }

    /// From here on, with so many steps done before.
    pub fn start(&self, done: usize) {
        self.start.set((done, Instant::now()));
        self.shown.set(self.start.get());
    }

    /// So many steps of so many seconds each are done.
    pub fn report(&self, done: usize, total: usize, step: f64) {
        let Some(bar) = &self.bar else { return };
        let (before, then) = self.shown.get();
        if then.elapsed() < PAUSE {
            return;
        }
        let factor = (done - before) as f64 * step / then.elapsed().as_secs_f64();
        let (first, begin) = self.start.get();
        let mean = (done - first) as f64 * step / begin.elapsed().as_secs_f64();
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(format!("{factor:.3} times real time (mean {mean:.3})"));
        self.shown.set((done, Instant::now()));
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
