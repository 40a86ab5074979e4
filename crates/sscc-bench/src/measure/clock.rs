//! Measures the processor time of one thread, which excludes other programs.

use cpu_time::ThreadTime;

use crate::error::Error;

/// Minimum work for one reading of the clock (milliseconds). Shorter work is repeated.
const MIN_MILLISECONDS: f64 = 0.1;

/// Maximum number of such repetitions.
const MAX_REPETITIONS: usize = 2000;

/// Returns the processor time of the work (s).
pub fn seconds<E>(work: impl FnOnce() -> Result<(), E>) -> Result<f64, E> {
    let start = ThreadTime::now();
    work()?;
    Ok(start.elapsed().as_secs_f64())
}

/// Returns the mean processor time of the work (ms).
pub fn milliseconds(work: &mut dyn FnMut() -> Result<(), Error>) -> Result<f64, Error> {
    let once = 1e3 * seconds(&mut *work)?;
    if once >= MIN_MILLISECONDS {
        return Ok(once);
    }
    let repetitions =
        (MIN_MILLISECONDS / once.max(MIN_MILLISECONDS / MAX_REPETITIONS as f64)).ceil() as usize;
    let repetitions = repetitions.min(MAX_REPETITIONS);
    Ok(1e3 * seconds(|| (0..repetitions).try_for_each(|_| work()))? / repetitions as f64)
}

/// Returns the median; for an even number of values the lower of the two middle ones.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) / 2]
}
