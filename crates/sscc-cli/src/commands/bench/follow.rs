//! Kinetic queries over the steps of a scene: they follow a motion, so a step cannot be asked for itself, nor twice.

use anyhow::Result;
use cpu_time::ThreadTime;
use sscc::{KineticQuery, Pair, Query};

use super::clock::median;
use super::measure::{Step, Times};
use crate::case::Case;
use crate::interrupt;

/// Times that all blocks are gone through; the median counts.
const ROUNDS: usize = 3;

/// Times kinetic queries, of each body its own, brought up to date by one untimed query before each block of steps.
/// Gives the number of steps at which their answers are not those of plain queries.
///
/// What such a query computes at one step serves the next ones: the steps of a block that the root's certificate leaves
/// open share the time of all of them, since other methods are asked some of them only.
pub fn follow(case: &Case, steps: &[Step], times: &mut Times) -> Result<usize> {
    let bodies = steps.first().map_or(0, |step| step.q_t0.len());
    let certificates = &case.full.certificates;
    let mut plain = Query::new(&case.model, certificates)?;
    let mut followers = Vec::with_capacity(bodies);
    for _ in 0..bodies {
        followers.push(KineticQuery::new(&case.model, certificates)?);
    }
    let mut rounds: Vec<Vec<f64>> = vec![Vec::with_capacity(ROUNDS); steps.len()];
    let mut wrong = vec![false; steps.len()];
    let is_quick = |step: &Step| step.q_t0.iter().all(|q| case.is_root_certified(q));
    for _ in 0..ROUNDS {
        let mut own = vec![0.0; steps.len()];
        let mut at = 0;
        while at < steps.len() {
            interrupt::check()?;
            for (follower, q) in followers.iter_mut().zip(steps[at].before.iter().flatten()) {
                follower.discrete(q)?;
            }
            // Steps that the root's certificate answers for all bodies take less time than a look at the clock:
            // stretches of them share one.
            let first = at;
            let goes_on = |n: usize| n < steps.len() && steps[n].before.is_none() && is_quick(&steps[n]);
            at += 1;
            while is_quick(&steps[first]) && goes_on(at) {
                at += 1;
            }
            let stretch = &steps[first..at];
            let mut found: Vec<Vec<Pair>> = vec![Vec::new(); bodies];
            let start = ThreadTime::now();
            for step in stretch {
                for ((follower, q), found) in followers.iter_mut().zip(&step.q_t0).zip(&mut found) {
                    let pairs = follower.discrete(q)?;
                    if !pairs.is_empty() {
                        *found = pairs.to_vec();
                    }
                }
            }
            let mean = start.elapsed().as_secs_f64() * 1e3 / stretch.len() as f64;
            for (n, step) in stretch.iter().enumerate() {
                own[first + n] = mean;
                for (q, found) in step.q_t0.iter().zip(&found) {
                    // Where the stretch is longer than a step, nothing may be found at all.
                    wrong[first + n] |= plain.discrete(q)? != found;
                }
            }
        }
        let mut at = 0;
        for block in steps.chunk_by(|_, next| next.before.is_none()) {
            share(&mut own[at..][..block.len()], |n| !is_quick(&block[n]));
            at += block.len();
        }
        rounds.iter_mut().zip(own).for_each(|(round, time)| round.push(time));
    }
    times.kinetic = rounds.into_iter().map(median).collect();
    Ok(wrong.into_iter().filter(|wrong| *wrong).count())
}

/// Gives each of the numbers that take part the mean of them.
fn share(times: &mut [f64], takes_part: impl Fn(usize) -> bool) {
    let own: Vec<usize> = (0..times.len()).filter(|n| takes_part(*n)).collect();
    let mean = own.iter().map(|n| times[*n]).sum::<f64>() / own.len().max(1) as f64;
    own.into_iter().for_each(|n| times[n] = mean);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_part_shares_its_time() {
        let mut times = [1.0, 6.0, 2.0];
        share(&mut times, |n| n != 0);
        assert_eq!(times, [1.0, 4.0, 4.0]);
        share(&mut times, |_| false);
        assert_eq!(times, [1.0, 4.0, 4.0]);
    }
}
