//! Kinetic queries over the steps of a scene: they follow a motion, so a step cannot be asked for itself, nor twice.

use anyhow::Result;
use cpu_time::ThreadTime;
use sscc::{KineticQuery, Query};

use super::clock::median;
use super::measure::{Step, Times};
use crate::interrupt;
use sscc_sim::CertifiedModel;

/// Times that all blocks are gone through; the median counts.
const ROUNDS: usize = 3;

/// Times kinetic queries, of each body its own, brought up to date by one untimed query before each block of steps.
/// Gives the number of steps at which their answers are not those of plain queries.
///
/// A query may take less time than a look at the clock: consecutive steps that the root's certificate answers, and
/// consecutive ones that it leaves open, share one. What such a query computes at one step serves the next ones: the
/// steps of a block that the root's certificate leaves open share the time of all of them, since other methods are asked
/// some of them only.
pub fn follow(case: &CertifiedModel, steps: &[Step], times: &mut Times) -> Result<usize> {
    let bodies = steps.first().map_or(0, |step| step.q_t0.len());
    let certificates = &case.full.certificates;
    let mut plain = Query::new(&case.model, certificates)?;
    let followers = || -> Result<Vec<KineticQuery<'_>>> {
        (0..bodies).map(|_| Ok(KineticQuery::new(&case.model, certificates)?)).collect()
    };
    // Those whose answers are compared ask the same q as those that are timed.
    let (mut timed, mut compared) = (followers()?, followers()?);
    let is_quick = |step: &Step| step.q_t0.iter().all(|q| case.is_root_certified(q));
    let mut rounds: Vec<Vec<f64>> = vec![Vec::with_capacity(ROUNDS); steps.len()];
    let mut wrong = vec![false; steps.len()];
    for _ in 0..ROUNDS {
        let mut at = 0;
        for block in steps.chunk_by(|_, next| next.before.is_none()) {
            interrupt::check()?;
            let wrong = &mut wrong[at..][..block.len()];
            for (follower, q) in compared.iter_mut().zip(block[0].before.iter().flatten()) {
                follower.discrete(q)?;
            }
            for (step, wrong) in block.iter().zip(wrong) {
                for (follower, q) in compared.iter_mut().zip(&step.q_t0) {
                    *wrong |= plain.discrete(q)? != follower.discrete(q)?;
                }
            }
            for (follower, q) in timed.iter_mut().zip(block[0].before.iter().flatten()) {
                follower.discrete(q)?;
            }
            let mut own = Vec::with_capacity(block.len());
            for stretch in block.chunk_by(|a, b| is_quick(a) == is_quick(b)) {
                let start = ThreadTime::now();
                for step in stretch {
                    for (follower, q) in timed.iter_mut().zip(&step.q_t0) {
                        follower.discrete(q)?;
                    }
                }
                let mean = start.elapsed().as_secs_f64() * 1e3 / stretch.len() as f64;
                own.extend(stretch.iter().map(|_| mean));
            }
            share(&mut own, |n| !is_quick(&block[n]));
            rounds[at..].iter_mut().zip(own).for_each(|(round, time)| round.push(time));
            at += block.len();
        }
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
