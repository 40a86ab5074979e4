//! Ctrl-C and progress. Only the thread that Python called may check signals. Long work runs on other threads; the
//! calling thread waits for it and checks signals. Short queries run on the calling thread and check signals
//! periodically.

use std::cell::RefCell;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, LazyLock};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use sscc::{CancelToken, Progress};

/// Interval between two checks of signals.
const PERIOD: Duration = Duration::from_millis(50);

/// The longest wait for the end of cancelled work.
const MAX_WAIT: Duration = Duration::from_millis(400);

thread_local! {
    /// The signal checks of the query that this thread answers.
    static CHECKS: RefCell<SignalChecks> = const { RefCell::new(SignalChecks { last: None, raised: None }) };
}

/// The time of the last check of signals, and the exception that a signal handler has raised.
struct SignalChecks {
    last: Option<Instant>,
    raised: Option<PyErr>,
}

/// Cancels a query on the thread that Python called, after a signal handler has raised an exception.
pub fn signals() -> &'static CancelToken {
    static TOKEN: LazyLock<CancelToken> = LazyLock::new(|| CancelToken::when(has_raised));
    &TOKEN
}

/// Whether a signal handler has raised an exception in the query that this thread answers.
fn has_raised() -> bool {
    let now = Instant::now();
    let known = CHECKS.with_borrow_mut(|checks| {
        let is_early = now - *checks.last.get_or_insert(now) < PERIOD;
        (checks.raised.is_some() || is_early).then_some(checks.raised.is_some())
    });
    known.unwrap_or_else(|| {
        // No borrow is active here: a signal handler may run a query of its own.
        let raised = Python::attach(|py| py.check_signals()).err();
        let is_raised = raised.is_some();
        CHECKS.set(SignalChecks { last: Some(now), raised });
        is_raised
    })
}

/// Runs one query on this thread without the GIL. The error is the exception of a signal handler.
pub fn answer<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let outer = CHECKS.replace(SignalChecks { last: None, raised: None });
    let answer = py.detach(work);
    match CHECKS.replace(outer).raised {
        Some(error) => Err(error),
        None => Ok(answer),
    }
}

/// The progress of work on other threads, and the token that cancels it. All reports have the same total.
#[derive(Default)]
struct Monitor {
    done: AtomicUsize,
    total: AtomicUsize,
    token: CancelToken,
}

impl Monitor {
    fn share(&self) -> Option<f64> {
        let (done, total) = (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed));
        (total > 0).then(|| (done as f64 / total as f64).min(1.0))
    }
}

impl Progress for Monitor {
    fn report(&self, done: usize, total: usize) {
        self.total.store(total, Ordering::Relaxed);
        self.done.fetch_max(done, Ordering::Relaxed);
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.token)
    }
}

/// The argument `progress`, as two functions: one receives the finished share of the work, one ends the report. With `None`
/// no progress is shown.
struct Reporter(Option<(Py<PyAny>, Py<PyAny>)>);

impl Reporter {
    fn of(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, label: &str) -> PyResult<Self> {
        Ok(Self(py.import("sscc._progress")?.call_method1("start", (progress, label))?.extract()?))
    }

    fn report(&self, py: Python<'_>, share: f64) -> PyResult<()> {
        self.0.as_ref().map_or(Ok(()), |(report, _)| report.call1(py, (share,)).map(drop))
    }

    /// Ends the report after success or an error. Only success reports the share 1.
    fn close<T, E>(&self, py: Python<'_>, result: PyResult<Result<T, E>>) -> PyResult<Result<T, E>> {
        let result = result.and_then(|outcome| {
            if outcome.is_ok() {
                self.report(py, 1.0)?;
            }
            Ok(outcome)
        });
        if let Some((_, close)) = &self.0 {
            close.call0(py)?;
        }
        result
    }

    /// Waits for work on another thread. An exception of a signal handler or of the reporting function cancels the
    /// work. Then the exception is the error, which is returned at the end of the work, or after `max_wait` if that is
    /// earlier. `None` if the work ended without a result.
    fn wait<T>(&self, waiting: &Receiver<T>, monitor: &Monitor, max_wait: Duration) -> PyResult<Option<T>> {
        let (mut raised, mut reported, mut left) = (None, 0.0, max_wait);
        loop {
            let outcome = waiting.recv_timeout(PERIOD);
            match (outcome, &raised) {
                (Err(RecvTimeoutError::Timeout), Some(_)) if left > PERIOD => left -= PERIOD,
                (_, Some(_)) => return raised.map_or(Ok(None), Err),
                (Ok(result), None) => return Ok(Some(result)),
                (Err(RecvTimeoutError::Disconnected), None) => return Ok(None),
                (Err(RecvTimeoutError::Timeout), None) => {
                    // Work may continue after its last report, so `close` reports the share 1.
                    let share = monitor.share().filter(|share| *share > reported && *share < 1.0);
                    let outcome = Python::attach(|py| {
                        py.check_signals()?;
                        share.map_or(Ok(()), |share| self.report(py, share))
                    });
                    reported = share.unwrap_or(reported);
                    raised = outcome.err();
                    if raised.is_some() {
                        monitor.token.cancel();
                    }
                }
            }
        }
    }
}

/// Runs long work on another thread, without the GIL. Meanwhile this thread checks signals and reports the finished
/// share to `progress` (the argument of that name): it ascends, and is 1 only after the success of the work. An exception
/// of either cancels the work and is the error. Work that does not end in time continues detached.
pub fn run<T: Send + 'static, E: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    label: &str,
    work: impl FnOnce(&dyn Progress) -> Result<T, E> + Send + 'static,
) -> PyResult<Result<T, E>> {
    run_reporting(py, &Reporter::of(py, progress, label)?, work)
}

/// Like [`run`] without progress, for work that cannot be cancelled. After an exception of a signal handler it continues
/// detached, and its result is dropped.
pub fn run_detachable<T: Send + 'static, E: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, E> + Send + 'static,
) -> PyResult<Result<T, E>> {
    run_reporting(py, &Reporter(None), move |_| work())
}

/// Runs work as [`run`] does, and reports to `reporter`.
fn run_reporting<T: Send + 'static, E: Send + 'static>(
    py: Python<'_>,
    reporter: &Reporter,
    work: impl FnOnce(&dyn Progress) -> Result<T, E> + Send + 'static,
) -> PyResult<Result<T, E>> {
    let result = py.detach(|| {
        let monitor = Arc::new(Monitor::default());
        let (finished, waiting) = channel();
        let of_worker = Arc::clone(&monitor);
        let worker = thread::Builder::new().spawn(move || {
            let result = work(&*of_worker);
            // The receiver is gone if the work was detached.
            let _ = finished.send(result);
        })?;
        match reporter.wait(&waiting, &monitor, MAX_WAIT)? {
            Some(result) => Ok(result),
            None => match worker.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => Err(PyRuntimeError::new_err("the work ended without a result")),
            },
        }
    });
    reporter.close(py, result)
}

/// Like [`run`], for work on borrowed data. It waits for the end of the work, which must stop soon.
pub fn run_borrowing<T: Send, E: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    label: &str,
    work: impl FnOnce(&dyn Progress) -> Result<T, E> + Send,
) -> PyResult<Result<T, E>> {
    let reporter = Reporter::of(py, progress, label)?;
    let result = py.detach(|| {
        let monitor = Monitor::default();
        thread::scope(|scope| {
            let (finished, waiting) = channel();
            let monitor = &monitor;
            let worker = thread::Builder::new().spawn_scoped(scope, move || {
                let _ = finished.send(work(monitor));
            })?;
            match reporter.wait(&waiting, monitor, MAX_WAIT)? {
                Some(result) => Ok(result),
                None => match worker.join() {
                    Err(panic) => resume_unwind(panic),
                    Ok(()) => Err(PyRuntimeError::new_err("the work ended without a result")),
                },
            }
        })
    });
    reporter.close(py, result)
}
