//! Every method on the same steps, its time and whether its answers are those of the others.
//!
//! The methods take turns on blocks of steps: what else the machine does meets all of them, and each finds in the
//! processor's caches what its own last query left there, as in a program that asks one method only.

use anyhow::Result;
use sscc::{Impact, Pair, Progress};

use super::clock::{median, milliseconds};
use super::columns::{COLUMNS, Column, Engine, Role};
use super::strata::{Counts, Strata, Stratum, weighted_mean};
use super::verdict::is_wrong;
use crate::interrupt;
use crate::progress::Bar;
use sscc_sim::CertifiedModel;

/// Turns of each method on each block of steps; of each step the median counts.
const ROUNDS: usize = 3;

/// Steps in a block. The first of each finds the caches as the other methods left them.
const BLOCK: usize = 20;

/// Up to so many queries of steps and bodies, comparators answer all that are discrete.
const FEW: usize = 64;

/// Else they answer so many steps, drawn of each stratum, and as many that are continuous.
const COMPARED: usize = 20;

/// One step of all bodies: from each `q_t0[i]` to `q_t1[i]`. Discrete queries are asked at its start.
pub struct Step {
    /// Where the bodies were a step before, at the first step of a block of consecutive ones.
    pub before: Option<Vec<Vec<f64>>>,
    pub q_t0: Vec<Vec<f64>>,
    pub q_t1: Vec<Vec<f64>>,
}

/// What was measured.
pub struct Measured {
    /// Whether some body collides at the start of each step.
    pub colliding: Vec<bool>,
    /// Whether some body's root certificate fails there.
    pub root_failed: Vec<bool>,
    /// How much steps count.
    pub strata: Strata,
    pub discrete: Times,
    pub continuous: Times,
    /// Steps in which two exact methods differ.
    pub mismatches: usize,
}

/// Milliseconds for all bodies.
pub struct Times {
    /// The steps that every method was asked.
    pub compared: Vec<usize>,
    /// By step and column; none where it was not asked.
    times: Vec<Vec<Option<f64>>>,
    /// By step, of kinetic queries; empty where they were not asked.
    pub kinetic: Vec<f64>,
}

/// Which queries are asked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    Both,
    Discrete,
}

/// Asks all methods. `scene` are the strata of all steps that the given ones stand for; none where these are all.
pub fn measure(
    case: &CertifiedModel,
    steps: &[Step],
    scene: Option<Counts>,
    asked: Asked,
    bar: &Bar,
) -> Result<Measured> {
    let mut engines: Vec<Box<dyn Engine + '_>> =
        COLUMNS.iter().map(|column| column.engine(case)).collect::<Result<_>>()?;
    let objects = steps.first().map_or(0, |step| step.q_t0.len());
    let is_certified = |column: &Column| column.role == Role::Certified;
    // Which steps are compared depends on what collides in all of them.
    let (mut colliding, mut root_failed) = (Vec::with_capacity(steps.len()), Vec::with_capacity(steps.len()));
    let mut wrong = Vec::with_capacity(steps.len());
    for step in steps {
        interrupt::check()?;
        let (collides, agreed) = answer_discrete(&mut engines, is_certified, &step.q_t0)?;
        colliding.push(collides);
        root_failed.push(step.q_t0.iter().any(|q| !case.is_root_certified(q)));
        wrong.push(!agreed);
    }
    let of = root_failed.iter().zip(&colliding).map(|(failed, collides)| Stratum::of(*failed, *collides));
    let strata = Strata::new(of.collect(), scene);
    let all: Vec<usize> = (0..steps.len()).collect();
    let is_few = steps.len() * objects <= FEW;
    let compared = if is_few { all.clone() } else { strata.draw(COMPARED) };
    let continuous = match asked {
        Asked::Both if is_few => strata.draw(COMPARED),
        Asked::Both => compared.clone(),
        Asked::Discrete => Vec::new(),
    };
    let is_compared = |step: &usize| compared.binary_search(step).is_ok();
    let others: Vec<usize> = all.into_iter().filter(|step| !is_compared(step)).collect();

    let mut done = 0;
    let (columns, certified) = (COLUMNS.len(), COLUMNS.iter().filter(|column| is_certified(column)).count());
    let turns = columns * (compared.len() + continuous.len()) + certified * others.len();
    let total = compared.len() + ROUNDS * turns;
    let mut tick = || {
        done += 1;
        bar.report(done, total);
        interrupt::check()
    };
    for at in &compared {
        let step = &steps[*at];
        let (_, agreed) = answer_discrete(&mut engines, |_| true, &step.q_t0)?;
        wrong[*at] |=
            !agreed || continuous.binary_search(at).is_ok() && !answer_continuous(&mut engines, case, step)?;
        tick()?;
    }
    let mismatches = wrong.into_iter().filter(|wrong| *wrong).count();
    let mut discrete = Turns::new(&mut engines, steps, &mut tick);
    let mut ask = |engine: &mut dyn Engine, step: &Step| -> Result<()> {
        Ok(step.q_t0.iter().try_for_each(|q| engine.discrete(q).map(drop))?)
    };
    discrete.time(&compared, |_| true, &mut ask)?;
    discrete.time(&others, is_certified, &mut ask)?;
    let discrete = discrete.times;
    let mut moving = Turns::new(&mut engines, steps, &mut tick);
    moving.time(&continuous, |_| true, &mut |engine, step| {
        let mut ends = step.q_t0.iter().zip(&step.q_t1);
        Ok(ends.try_for_each(|(a, b)| engine.continuous(a, b).map(drop))?)
    })?;
    let moving = moving.times;
    Ok(Measured {
        colliding,
        root_failed,
        strata,
        discrete: Times { compared, times: discrete, kinetic: Vec::new() },
        continuous: Times { compared: continuous, times: moving, kinetic: Vec::new() },
        mismatches,
    })
}

/// At most `count` of the indices, evenly spread.
pub fn spread(indices: &[usize], count: usize) -> Vec<usize> {
    let count = count.min(indices.len());
    (0..count).map(|i| indices[i * indices.len() / count]).collect()
}

/// Whether a body collides, and whether all methods that take part list the same pairs.
fn answer_discrete(
    engines: &mut [Box<dyn Engine + '_>],
    takes_part: impl Fn(&Column) -> bool,
    bodies: &[Vec<f64>],
) -> Result<(bool, bool)> {
    let (mut colliding, mut agreed) = (false, true);
    for q in bodies {
        let mut expected: Option<Vec<Pair>> = None;
        for (column, engine) in COLUMNS.iter().zip(&mut *engines) {
            if !takes_part(column) {
                continue;
            }
            let found = engine.discrete(q)?;
            if column.role == Role::Approximate {
                continue;
            }
            match &expected {
                Some(expected) => agreed &= found == expected,
                None => expected = Some(found.to_vec()),
            }
            colliding |= !found.is_empty();
        }
    }
    Ok((colliding, agreed))
}

/// Whether all methods list the same pairs, but for such as may be listed or not.
fn answer_continuous(
    engines: &mut [Box<dyn Engine + '_>],
    case: &CertifiedModel,
    step: &Step,
) -> Result<bool> {
    let mut agreed = true;
    for ends in step.q_t0.iter().zip(&step.q_t1) {
        let mut answers: Vec<Vec<Impact>> = Vec::new();
        for engine in &mut *engines {
            answers.push(engine.continuous(ends.0, ends.1)?.to_vec());
        }
        let lists = |answer: &[Impact], impact: &Impact| {
            answer.binary_search_by_key(&impact.pair, |impact| impact.pair).is_ok()
        };
        let of_some_only =
            answers.iter().flatten().filter(|impact| !answers.iter().all(|answer| lists(answer, impact)));
        for impact in of_some_only {
            agreed &= !is_wrong(&case.model, ends.0, ends.1, impact);
        }
    }
    Ok(agreed)
}

/// Times the methods by turns.
struct Turns<'t, 'a> {
    engines: &'t mut [Box<dyn Engine + 'a>],
    steps: &'t [Step],
    /// After each turn on a step.
    tick: &'t mut dyn FnMut() -> Result<()>,
    /// By step and column.
    times: Vec<Vec<Option<f64>>>,
}

impl<'t, 'a> Turns<'t, 'a> {
    fn new(
        engines: &'t mut [Box<dyn Engine + 'a>],
        steps: &'t [Step],
        tick: &'t mut dyn FnMut() -> Result<()>,
    ) -> Self {
        let times = vec![vec![None; engines.len()]; steps.len()];
        Self { engines, steps, tick, times }
    }

    /// Times some methods on some steps, block by block.
    fn time(
        &mut self,
        chosen: &[usize],
        takes_part: impl Fn(&Column) -> bool,
        ask: &mut dyn FnMut(&mut dyn Engine, &Step) -> Result<()>,
    ) -> Result<()> {
        for block in chosen.chunks(BLOCK) {
            let mut rounds = vec![vec![Vec::new(); self.engines.len()]; block.len()];
            for _ in 0..ROUNDS {
                for (column, engine) in self.engines.iter_mut().enumerate() {
                    for (rounds, at) in rounds.iter_mut().zip(block) {
                        if takes_part(&COLUMNS[column]) {
                            let step = &self.steps[*at];
                            rounds[column].push(milliseconds(&mut || ask(engine.as_mut(), step))?);
                            (self.tick)()?;
                        }
                    }
                }
            }
            for (rounds, at) in rounds.into_iter().zip(block) {
                let middle = |times: Vec<f64>| (!times.is_empty()).then(|| median(times));
                self.times[*at] = rounds.into_iter().map(middle).collect();
            }
        }
        Ok(())
    }
}

impl Times {
    /// Milliseconds of one method, of the steps in which it was asked; where it has several engines, of the faster one.
    pub fn of(&self, key: &str) -> Vec<(usize, f64)> {
        if key == "kinetic" {
            return self.kinetic.iter().copied().enumerate().collect();
        }
        let faster = |times: &Vec<Option<f64>>| {
            let own = COLUMNS.iter().zip(times).filter(|(column, _)| column.key == key);
            own.filter_map(|(_, time)| *time).reduce(f64::min)
        };
        let steps = self.times.iter().enumerate();
        steps.filter_map(|(step, times)| Some((step, faster(times)?))).collect()
    }

    /// Mean milliseconds over the scene that some steps stand for, of the columns that were asked all of them.
    pub fn means(&self, steps: &[usize], strata: &Strata) -> Vec<(&'static str, f64)> {
        let mut means: Vec<(&'static str, f64)> = Vec::new();
        if steps.is_empty() {
            return means;
        }
        let weights = strata.weights(steps);
        for (at, column) in COLUMNS.iter().enumerate() {
            let times: Option<Vec<f64>> = steps.iter().map(|&step| self.times[step][at]).collect();
            let Some(times) = times else { continue };
            let mean = weighted_mean(times, &weights);
            match means.iter_mut().find(|(key, _)| *key == column.key) {
                Some((_, known)) => *known = known.min(mean),
                None => means.push((column.key, mean)),
            }
        }
        if !self.kinetic.is_empty() {
            means.push(("kinetic", weighted_mean(steps.iter().map(|step| self.kinetic[*step]), &weights)));
        }
        means
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_spread_evenly() {
        let all: Vec<usize> = (0..10).collect();
        assert_eq!(spread(&all, 4), [0, 2, 5, 7]);
        assert_eq!(spread(&all, 20), all);
        assert!(spread(&[], 3).is_empty());
    }

    #[test]
    fn means_are_of_the_same_steps_and_the_better_of_two_engines() {
        let row = |common: f64| {
            let mut times = 0.0;
            COLUMNS
                .iter()
                .map(|_| {
                    times += 1.0;
                    Some(common + times)
                })
                .collect::<Vec<_>>()
        };
        let mut partial = row(0.0);
        partial[0] = None;
        let kinetic = vec![1.0, 3.0, 9.0];
        let times = Times { compared: vec![0, 1], times: vec![row(0.0), row(2.0), partial], kinetic };
        let strata = Strata::new(vec![Stratum::RootCertified; 3], None);
        let means = times.means(&[0, 1], &strata);
        let of =
            |means: &[(&str, f64)], key: &str| means.iter().find(|mean| mean.0 == key).map(|mean| mean.1);
        let at = COLUMNS.iter().position(|column| column.key == "parry").unwrap();
        assert_eq!((of(&means, "parry"), of(&means, COLUMNS[0].key)), (Some(at as f64 + 2.0), Some(2.0)));
        assert_eq!(of(&times.means(&[0, 2], &strata), COLUMNS[0].key), None);
        assert_eq!(of(&means, "kinetic"), Some(2.0));
        assert!(times.means(&[], &strata).is_empty());
        // A step that stands for three of the scene, and one that stands for itself.
        let strata = Strata::new(
            vec![Stratum::RootCertified, Stratum::Colliding, Stratum::Colliding],
            Some([3, 0, 1]),
        );
        let means = times.means(&[0, 1], &strata);
        assert_eq!((of(&means, COLUMNS[0].key), of(&means, "kinetic")), (Some(1.5), Some(1.5)));
        // Each step that was asked, and no other.
        assert_eq!(times.of(COLUMNS[0].key), [(0, 1.0), (1, 3.0)]);
        assert_eq!(times.of("parry")[1], (1, at as f64 + 3.0));
        assert_eq!(times.of("kinetic"), [(0, 1.0), (1, 3.0), (2, 9.0)]);
    }
}
