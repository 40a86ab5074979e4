//! The progress bar of a simulation, with its speed relative to real time.

use std::cell::Cell;
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Minimum time between two updates of the bar.
const UPDATE_INTERVAL: Duration = Duration::from_millis(200);

/// Shows the steps done, and the simulated seconds per second of wall-clock time.
pub struct Meter {
    bar: Option<ProgressBar>,
    /// Simulated seconds of a step.
    step: f64,
    /// Steps done before this run, and the time of the first report.
    start: Cell<Option<(usize, Instant)>>,
    /// Steps done at the last update, and its time.
    shown: Cell<(usize, Instant)>,
}

impl Meter {
    /// Creates a bar, visible if standard error is a terminal. `step`: simulated seconds of a step.
    pub fn new(step: f64) -> Self {
        let bar = stderr().is_terminal().then(|| {
            let style =
                ProgressStyle::with_template("simulating [{wide_bar}] {percent}% {elapsed_precise} {msg}");
            ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, step, start: Cell::new(None), shown: Cell::new((0, Instant::now())) }
    }

    /// Writes text while the bar is hidden.
    pub fn suspend(&self, write: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Shows that `done` of `total` steps are done. The first report has the steps done before this run.
    pub fn report(&self, done: usize, total: usize) {
        let Some(bar) = &self.bar else { return };
        let Some((first, begin)) = self.start.get() else {
            self.start.set(Some((done, Instant::now())));
            self.shown.set((done, Instant::now()));
            return;
        };
        let (before, then) = self.shown.get();
        if then.elapsed() < UPDATE_INTERVAL {
            return;
        }
        let speed = |steps: usize, since: Instant| steps as f64 * self.step / since.elapsed().as_secs_f64();
        let (factor, mean) = (speed(done - before, then), speed(done - first, begin));
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
