//! The progress bar on standard error, if that is a terminal, for work that takes more than a second.

use std::io::{IsTerminal, stderr, stdout};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use sscc::{CancelToken, Progress};

use crate::interrupt;

/// The bar appears after this time.
const DELAY: Duration = Duration::from_secs(1);

/// Shows progress, and cancels the work on an interrupt.
pub struct Bar {
    message: &'static str,
    start: Instant,
    is_visible: bool,
    bar: OnceLock<ProgressBar>,
}

impl Bar {
    /// Creates a bar, which appears if standard error is a terminal and the work takes longer than [`DELAY`].
    pub fn new(message: &'static str) -> Self {
        Self { message, start: Instant::now(), is_visible: stderr().is_terminal(), bar: OnceLock::new() }
    }

    /// Hides the bar if standard output is a terminal, where the printed lines show the progress.
    pub fn beside_output(mut self) -> Self {
        self.is_visible &= !stdout().is_terminal();
        self
    }

    /// Writes text while the bar is hidden.
    pub fn suspend(&self, write: impl FnOnce()) {
        match self.bar.get() {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    fn draw(&self, done: usize, total: usize) {
        let bar = self.bar.get_or_init(|| {
            let bar =
                ProgressBar::new(total as u64).with_message(self.message).with_elapsed(self.start.elapsed());
            let style = ProgressStyle::with_template("{msg} [{wide_bar}] {percent}% {elapsed_precise}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    }
}

impl Progress for Bar {
    fn report(&self, done: usize, total: usize) {
        if self.is_visible && self.start.elapsed() > DELAY {
            self.draw(done, total);
        }
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(interrupt::token())
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}
