//! Processor time of one thread: other programs add nothing to it, for any method.

use cpu_time::ThreadTime;

use crate::error::Error;

/// Work shorter than this (milliseconds) is repeated, so that one reading of the clock covers at least this time.
const SHORT: f64 = 0.1;

/// Largest number of such repetitions.
const MAX_REPETITIONS: usize = 2000;

/// Processor seconds of the work.
pub fn seconds<E>(work: impl FnOnce() -> Result<(), E>) -> Result<f64, E> {
    let start = ThreadTime::now();
    work()?;
    Ok(start.elapsed().as_secs_f64())
}

/// Mean processor milliseconds of the work.
pub fn milliseconds(work: &mut dyn FnMut() -> Result<(), Error>) -> Result<f64, Error> {
    let once = 1e3 * seconds(&mut *work)?;
    if once >= SHORT {
        return Ok(once);
    }
    let repetitions = (SHORT / once.max(SHORT / MAX_REPETITIONS as f64)).ceil() as usize;
    let repetitions = repetitions.min(MAX_REPETITIONS);
    Ok(1e3 * seconds(|| (0..repetitions).try_for_each(|_| work()))? / repetitions as f64)
}

/// The median, of an even number of values the lower of the two.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) / 2]
}
