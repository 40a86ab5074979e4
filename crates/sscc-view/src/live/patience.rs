//! How long an answer is worked on.

use sscc::{Error, Progress};

use crate::ViewError;

/// Seconds; what takes longer ends with what was found until then.
pub(super) const LONGEST: u64 = 10;

/// Ends work when its time is over, nobody waits for it any more, or all is to end. None of these is ever taken back.
pub(super) struct Patience<'a> {
    pub(super) all: &'a dyn Progress,
    pub(super) is_over: &'a (dyn Fn() -> bool + Sync),
    pub(super) is_wanted: &'a (dyn Fn() -> bool + Sync),
}

impl Patience<'_> {
    /// Says why work was cancelled.
    pub(super) fn explain(&self, error: Error) -> ViewError {
        match error {
            Error::Cancelled if !(self.is_wanted)() => {
                ViewError::Request("another question came before the answer was found".into())
            }
            Error::Cancelled if (self.is_over)() => {
                ViewError::Request(format!("no answer was found within {LONGEST} s"))
            }
            error => error.into(),
        }
    }
}

impl Progress for Patience<'_> {
    fn report(&self, _done: usize, _total: usize) {}

    fn is_cancelled(&self) -> bool {
        self.all.is_cancelled() || !(self.is_wanted)() || (self.is_over)()
    }
}
