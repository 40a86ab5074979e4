//! Ctrl-C and progress. Only the thread that Python called may check signals. During long work on other threads it only
//! waits; short queries run on it and check signals periodically.

use std::cell::RefCell;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use sscc::Progress;

/// Interval between two checks of signals.
const PERIOD: Duration = Duration::from_millis(50);

/// How long what is to stop is waited for.
const PATIENCE: Duration = Duration::from_millis(400);

thread_local! {
    /// Of the query that this thread is answering: when Python was asked last, and what it said.
    static CALL: RefCell<Call> = const { RefCell::new(Call { asked: None, raised: None }) };
}

struct Call {
    asked: Option<Instant>,
    raised: Option<PyErr>,
}

/// Cancels a query on the thread that Python called when a signal handler raises an exception.
pub struct Signals;

impl Progress for Signals {
    fn report(&self, _done: usize, _total: usize) {}

    fn is_cancelled(&self) -> bool {
        let now = Instant::now();
        let known = CALL.with_borrow_mut(|call| {
            let is_early = now - *call.asked.get_or_insert(now) < PERIOD;
            (call.raised.is_some() || is_early).then_some(call.raised.is_some())
        });
        known.unwrap_or_else(|| {
            // No borrow is active here: a signal handler may run a query of its own.
            let raised = Python::attach(|py| py.check_signals()).err();
            let is_raised = raised.is_some();
            CALL.set(Call { asked: Some(now), raised });
            is_raised
        })
    }
}

/// Runs one query on this thread without the GIL. The error is the exception of a signal handler.
pub fn answer<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let outer = CALL.replace(Call { asked: None, raised: None });
    let answer = py.detach(work);
    match CALL.replace(outer).raised {
        Some(error) => Err(error),
        None => Ok(answer),
    }
}

/// The progress of work on other threads, and the request to stop.
#[derive(Default)]
struct Monitor {
    done: AtomicUsize,
    total: AtomicUsize,
    cancelled: AtomicBool,
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

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// What is told how far work has come, and what is called at its end: what the argument `progress` means.
struct Shown(Option<(Py<PyAny>, Py<PyAny>)>);

impl Shown {
    fn of(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, label: &str) -> PyResult<Self> {
        Ok(Self(py.import("sscc._progress")?.call_method1("start", (progress, label))?.extract()?))
    }

    fn tell(&self, py: Python<'_>, share: f64) -> PyResult<()> {
        self.0.as_ref().map_or(Ok(()), |(tell, _)| tell.call1(py, (share,)).map(drop))
    }

    /// Ends the report after success or an error.
    fn close<T>(&self, py: Python<'_>, result: PyResult<T>) -> PyResult<T> {
        let result = result.and_then(|result| self.tell(py, 1.0).map(|()| result));
        if let Some((_, close)) = &self.0 {
            close.call0(py)?;
        }
        result
    }

    /// Waits for work on another thread, and stops it when a signal or what is told raises something. None if that was
    /// raised, and the work has not come to its end `patience` later.
    fn wait<T>(&self, waiting: &Receiver<T>, monitor: &Monitor, patience: Duration) -> PyResult<Option<T>> {
        let (mut raised, mut told, mut left) = (None, 0.0, patience);
        loop {
            let outcome = waiting.recv_timeout(PERIOD);
            match (outcome, &raised) {
                (Err(RecvTimeoutError::Timeout), Some(_)) if left > PERIOD => left -= PERIOD,
                (_, Some(_)) => return raised.map_or(Ok(None), Err),
                (Ok(result), None) => return Ok(Some(result)),
                (Err(RecvTimeoutError::Disconnected), None) => return Ok(None),
                (Err(RecvTimeoutError::Timeout), None) => {
                    let share = monitor.share().filter(|share| *share > told);
                    let outcome = Python::attach(|py| {
                        py.check_signals()?;
                        share.map_or(Ok(()), |share| self.tell(py, share))
                    });
                    told = share.unwrap_or(told);
                    raised = outcome.err();
                    monitor.cancelled.store(raised.is_some(), Ordering::Relaxed);
                }
            }
        }
    }
}

/// Runs long work on another thread, without the GIL. Meanwhile this thread reports the share done to `progress` (the
/// argument of that name) and checks signals. An exception of either stops the work and is the error. Work that does
/// not stop in time continues detached.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    label: &str,
    work: impl FnOnce(&dyn Progress) -> T + Send + 'static,
) -> PyResult<T> {
    let shown = Shown::of(py, progress, label)?;
    let result = py.detach(|| {
        let monitor = Arc::new(Monitor::default());
        let (finished, waiting) = channel();
        let of_worker = Arc::clone(&monitor);
        let worker = thread::spawn(move || {
            let result = work(&*of_worker);
            // The receiver is gone if the work was detached.
            let _ = finished.send(result);
        });
        match shown.wait(&waiting, &monitor, PATIENCE)? {
            Some(result) => Ok(result),
            None => match worker.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => Err(PyRuntimeError::new_err("the work ended without a result")),
            },
        }
    });
    shown.close(py, result)
}

/// Like [`run`], for work on borrowed data. It waits for the end of the work, which must stop soon.
pub fn run_borrowing<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    label: &str,
    work: impl FnOnce(&dyn Progress) -> T + Send,
) -> PyResult<T> {
    let shown = Shown::of(py, progress, label)?;
    let result = py.detach(|| {
        let monitor = Monitor::default();
        thread::scope(|scope| {
            let (finished, waiting) = channel();
            let monitor = &monitor;
            let worker = scope.spawn(move || {
                let _ = finished.send(work(monitor));
            });
            match shown.wait(&waiting, monitor, PATIENCE)? {
                Some(result) => Ok(result),
                None => match worker.join() {
                    Err(panic) => resume_unwind(panic),
                    Ok(()) => Err(PyRuntimeError::new_err("the work ended without a result")),
                },
            }
        })
    });
    shown.close(py, result)
}
