//! Processor time of one thread: what other programs do meanwhile does not count, for any method.

use anyhow::Result;
use cpu_time::ThreadTime;

/// Work shorter than this (milliseconds) is repeated until one look at the clock takes as long.
const SHORT: f64 = 0.1;

/// Repetitions at most.
const MOST: usize = 2000;

/// Mean milliseconds of the work.
pub fn milliseconds(work: &mut dyn FnMut() -> Result<()>) -> Result<f64> {
    let once = look(1, work)?;
    if once >= SHORT {
        return Ok(once);
    }
    let times = ((SHORT / once.max(SHORT / MOST as f64)).ceil() as usize).min(MOST);
    Ok(look(times, work)? / times as f64)
}

fn look(times: usize, work: &mut dyn FnMut() -> Result<()>) -> Result<f64> {
    let start = ThreadTime::now();
    for _ in 0..times {
        work()?;
    }
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

/// The middle one, or the lower of the two.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) / 2]
}
