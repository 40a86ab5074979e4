//! Times kinetic queries over the steps of a scene. Each query depends on earlier steps, so no step can be measured
//! alone or repeated.

use sscc::{KineticQuery, Progress, Query};
use sscc_tasks::{CertifiedModel, check_cancelled};

use super::clock::{median, seconds};
use super::step::Step;
use super::timer::REPETITIONS;
use crate::error::Error;

/// Times of kinetic queries on the steps of a scene.
pub struct KineticTimes {
    /// Milliseconds of all bodies, by step.
    pub milliseconds: Vec<f64>,
    /// Number of steps whose answers differ from those of certified discrete queries.
    pub mismatches: usize,
}

/// Times kinetic queries, one for each body. One untimed query before each block of steps brings them up to date. All
/// blocks are repeated, and the result is the median.
///
/// A query may take less time than reading the clock: consecutive steps that the root's certificate proves free share
/// one reading, and so do consecutive steps for which it fails. A query computes data that later steps reuse, and other
/// methods run on some of the steps only. The steps of a block for which the root's certificate fails therefore share
/// the time of all of them.
///
/// # Errors
/// When some q is out of range, or `progress` cancels.
pub fn time_kinetic(
    model: &CertifiedModel,
    steps: &[Step],
    progress: &dyn Progress,
) -> Result<KineticTimes, Error> {
    let bodies = steps.first().map_or(0, |step| step.q_t0.len());
    let certificates = &model.full.certificates;
    let mut plain = Query::new(&model.model, certificates)?;
    let queries = || -> Result<Vec<KineticQuery>, Error> {
        (0..bodies).map(|_| Ok(KineticQuery::new(&model.model, certificates)?)).collect()
    };
    // One set of queries is timed; the other one, for the same q, is compared with discrete queries.
    let (mut timed, mut compared) = (queries()?, queries()?);
    let is_root_certified = |step: &Step| step.q_t0.iter().all(|q| model.is_root_certified(q));
    let mut repetitions: Vec<Vec<f64>> = vec![Vec::with_capacity(REPETITIONS); steps.len()];
    let mut differs = vec![false; steps.len()];
    for _ in 0..REPETITIONS {
        let mut at = 0;
        for block in steps.chunk_by(|_, next| next.before.is_none()) {
            check_cancelled(progress)?;
            update(&mut compared, block[0].before.iter().flatten())?;
            for (step, differs) in block.iter().zip(&mut differs[at..]) {
                for (query, q) in compared.iter_mut().zip(&step.q_t0) {
                    *differs |= plain.discrete(q)? != query.discrete(q)?;
                }
            }
            update(&mut timed, block[0].before.iter().flatten())?;
            let mut own = Vec::with_capacity(block.len());
            for stretch in block.chunk_by(|a, b| is_root_certified(a) == is_root_certified(b)) {
                let time = seconds(|| stretch.iter().try_for_each(|step| update(&mut timed, &step.q_t0)))?;
                let mean = 1e3 * time / stretch.len() as f64;
                own.extend(stretch.iter().map(|_| mean));
            }
            share(&mut own, |n| !is_root_certified(&block[n]));
            repetitions[at..].iter_mut().zip(own).for_each(|(times, time)| times.push(time));
            at += block.len();
        }
    }
    Ok(KineticTimes {
        milliseconds: repetitions.into_iter().map(median).collect(),
        mismatches: differs.into_iter().filter(|differs| *differs).count(),
    })
}

/// Runs the kinetic query of each body at its q.
fn update<'q>(
    queries: &mut [KineticQuery],
    bodies: impl IntoIterator<Item = &'q Vec<f64>>,
) -> Result<(), Error> {
    for (query, q) in queries.iter_mut().zip(bodies) {
        query.discrete(q)?;
    }
    Ok(())
}

/// Replaces each time that takes part by the mean of these times.
fn share(times: &mut [f64], takes_part: impl Fn(usize) -> bool) {
    let own: Vec<usize> = (0..times.len()).filter(|n| takes_part(*n)).collect();
    let mean = own.iter().map(|n| times[*n]).sum::<f64>() / own.len().max(1) as f64;
    own.into_iter().for_each(|n| times[n] = mean);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_times_are_their_mean() {
        let mut times = [1.0, 6.0, 2.0];
        share(&mut times, |n| n != 0);
        assert_eq!(times, [1.0, 4.0, 4.0]);
        share(&mut times, |_| false);
        assert_eq!(times, [1.0, 4.0, 4.0]);
    }
}
