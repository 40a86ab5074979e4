//! Ctrl-C and progress: only the thread that called may ask Python for signals, so it does nothing else while others
//! work; short queries, which it answers itself, look up now and then.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use sscc::Progress;

/// How often Python is asked.
const PERIOD: Duration = Duration::from_millis(50);

thread_local! {
    /// Of the query that this thread is answering: when Python was asked last, and what it said.
    static CALL: RefCell<Call> = const { RefCell::new(Call { asked: None, raised: None }) };
}

struct Call {
    asked: Option<Instant>,
    raised: Option<PyErr>,
}

/// Cancels a query on the thread that was called from Python when a signal raises something there.
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
            // Not borrowed meanwhile: what handles the signal may ask a query of its own.
            let raised = Python::attach(|py| py.check_signals()).err();
            let is_raised = raised.is_some();
            CALL.set(Call { asked: Some(now), raised });
            is_raised
        })
    }
}

/// Answers one query on this thread, without the GIL; what a signal raised meanwhile is the error.
pub fn answer<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let outer = CALL.replace(Call { asked: None, raised: None });
    let answer = py.detach(work);
    match CALL.replace(outer).raised {
        Some(error) => Err(error),
        None => Ok(answer),
    }
}

/// How far work on other threads has come, and whether it is to stop.
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

/// Does long work on another thread, without the GIL. Meanwhile this one tells `progress` (the argument of that name)
/// what share of it is done, and stops it when that or a signal raises something, which is the error then.
pub fn run<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    label: &str,
    work: impl FnOnce(&dyn Progress) -> T + Send,
) -> PyResult<T> {
    let shown = py.import("sscc._progress")?.call_method1("start", (progress, label))?;
    let shown: Option<(Py<PyAny>, Py<PyAny>)> = shown.extract()?;
    let monitor = Monitor::default();
    let tell = |py: Python<'_>, share: f64| match &shown {
        Some((tell, _)) => tell.call1(py, (share,)).map(drop),
        None => Ok(()),
    };
    let result = py.detach(|| {
        thread::scope(|scope| {
            let (finished, waiting) = channel::<()>();
            let monitor = &monitor;
            let worker = scope.spawn(move || {
                // Tells that the work has ended when it is dropped, however that comes about.
                let _finished = finished;
                work(monitor)
            });
            let (mut raised, mut told) = (None, 0.0);
            while waiting.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                if raised.is_some() {
                    continue;
                }
                let share = monitor.share().filter(|share| *share > told);
                let outcome = Python::attach(|py| {
                    py.check_signals()?;
                    share.map_or(Ok(()), |share| tell(py, share))
                });
                told = share.unwrap_or(told);
                raised = outcome.err();
                monitor.cancelled.store(raised.is_some(), Ordering::Relaxed);
            }
            match (worker.join(), raised) {
                (_, Some(error)) => Err(error),
                (Ok(result), None) => Ok(result),
                (Err(panic), None) => std::panic::resume_unwind(panic),
            }
        })
    });
    let result = match result {
        Ok(result) => tell(py, 1.0).map(|()| result),
        Err(error) => Err(error),
    };
    if let Some((_, close)) = &shown {
        close.call0(py)?;
    }
    result
}
