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
    /// Simulated seconds of a step.
    step: f64,
    /// Steps that had been done before, and when it began.
    start: Cell<Option<(usize, Instant)>>,
    shown: Cell<(usize, Instant)>,
}

impl Meter {
    /// Visible where standard error is a terminal. A step lasts so many simulated seconds.
    pub fn new(step: f64) -> Self {
        let bar = stderr().is_terminal().then(|| {
            let style =
                ProgressStyle::with_template("simulating [{wide_bar}] {percent}% {elapsed_precise} {msg}");
            ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, step, start: Cell::new(None), shown: Cell::new((0, Instant::now())) }
    }

    /// So many steps are done; the first report says how many had been done before.
    pub fn report(&self, done: usize, total: usize) {
        let Some(bar) = &self.bar else { return };
        let Some((first, begin)) = self.start.get() else {
            self.start.set(Some((done, Instant::now())));
            self.shown.set((done, Instant::now()));
            return;
        };
        let (before, then) = self.shown.get();
        if then.elapsed() < PAUSE {
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
