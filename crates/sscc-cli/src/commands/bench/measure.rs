//! Every method on the same steps, by turns, its time and whether its answers are those of the others.

use anyhow::Result;
use sscc::{Impact, Pair, Progress};

use super::clock::{median, milliseconds};
use super::columns::{COLUMNS, Column, Engine, Role};
use super::verdict::is_wrong;
use crate::case::Case;
use crate::interrupt;
use crate::progress::Bar;

/// Turns of each method on each step; the median counts.
const ROUNDS: usize = 3;

/// Up to so many queries of steps and bodies, comparators answer all that are discrete.
const FEW: usize = 64;

/// Else they answer so many steps, and as many that are continuous.
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

/// Asks all methods.
pub fn measure(case: &Case, steps: &[Step], asked: Asked, bar: &Bar) -> Result<Measured> {
    let mut engines: Vec<Box<dyn Engine + '_>> =
        COLUMNS.iter().map(|column| column.engine(case)).collect::<Result<_>>()?;
    let objects = steps.first().map_or(0, |step| step.q_t0.len());
    let all: Vec<usize> = (0..steps.len()).collect();
    let compared = if steps.len() * objects <= FEW { all } else { spread(&all, COMPARED) };
    let continuous = match asked {
        Asked::Both => spread(&compared, COMPARED),
        Asked::Discrete => Vec::new(),
    };
    let mut measured = Measured {
        colliding: Vec::with_capacity(steps.len()),
        root_failed: Vec::with_capacity(steps.len()),
        discrete: Times { compared, times: Vec::with_capacity(steps.len()), kinetic: Vec::new() },
        continuous: Times {
            compared: continuous,
            times: Vec::with_capacity(steps.len()),
            kinetic: Vec::new(),
        },
        mismatches: 0,
    };
    for (index, step) in steps.iter().enumerate() {
        interrupt::check()?;
        let in_discrete = measured.discrete.compared.binary_search(&index).is_ok();
        let takes_part = |column: &Column| in_discrete || column.role == Role::Certified;
        let (colliding, agreed) = answer_discrete(&mut engines, takes_part, step)?;
        let mut wrong = !agreed;
        measured.colliding.push(colliding);
        measured.root_failed.push(step.q_t0.iter().any(|q| !case.is_root_certified(q)));
        measured.discrete.times.push(time(&mut engines, takes_part, &mut |engine| {
            step.q_t0.iter().try_for_each(|q| engine.discrete(q).map(drop))
        })?);

        let in_continuous = measured.continuous.compared.binary_search(&index).is_ok();
        if in_continuous {
            wrong |= !answer_continuous(&mut engines, case, step)?;
        }
        measured.continuous.times.push(time(&mut engines, |_| in_continuous, &mut |engine| {
            step.q_t0.iter().zip(&step.q_t1).try_for_each(|(a, b)| engine.continuous(a, b).map(drop))
        })?);
        measured.mismatches += usize::from(wrong);
        bar.report(index + 1, steps.len());
    }
    Ok(measured)
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
    step: &Step,
) -> Result<(bool, bool)> {
    let (mut colliding, mut agreed) = (false, true);
    for q in &step.q_t0 {
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
fn answer_continuous(engines: &mut [Box<dyn Engine + '_>], case: &Case, step: &Step) -> Result<bool> {
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

/// The time of each column that takes part.
fn time(
    engines: &mut [Box<dyn Engine + '_>],
    takes_part: impl Fn(&Column) -> bool,
    work: &mut dyn FnMut(&mut dyn Engine) -> Result<(), sscc::Error>,
) -> Result<Vec<Option<f64>>> {
    let mut rounds: Vec<Vec<f64>> = vec![Vec::new(); engines.len()];
    for _ in 0..ROUNDS {
        for (at, engine) in engines.iter_mut().enumerate() {
            if takes_part(&COLUMNS[at]) {
                rounds[at].push(milliseconds(&mut || Ok(work(engine.as_mut())?))?);
            }
        }
    }
    Ok(rounds.into_iter().map(|times| (!times.is_empty()).then(|| median(times))).collect())
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

    /// Mean milliseconds over some steps, of the columns that were asked all of them.
    pub fn means(&self, steps: &[usize]) -> Vec<(&'static str, f64)> {
        let mut means: Vec<(&'static str, f64)> = Vec::new();
        if steps.is_empty() {
            return means;
        }
        for (at, column) in COLUMNS.iter().enumerate() {
            let times: Option<Vec<f64>> = steps.iter().map(|&step| self.times[step][at]).collect();
            let Some(times) = times else { continue };
            let mean = times.iter().sum::<f64>() / times.len() as f64;
            match means.iter_mut().find(|(key, _)| *key == column.key) {
                Some((_, known)) => *known = known.min(mean),
                None => means.push((column.key, mean)),
            }
        }
        if !self.kinetic.is_empty() {
            let sum: f64 = steps.iter().map(|step| self.kinetic[*step]).sum();
            means.push(("kinetic", sum / steps.len() as f64));
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
        let means = times.means(&[0, 1]);
        let of =
            |means: &[(&str, f64)], key: &str| means.iter().find(|mean| mean.0 == key).map(|mean| mean.1);
        let at = COLUMNS.iter().position(|column| column.key == "parry").unwrap();
        assert_eq!((of(&means, "parry"), of(&means, COLUMNS[0].key)), (Some(at as f64 + 2.0), Some(2.0)));
        assert_eq!(of(&times.means(&[0, 2]), COLUMNS[0].key), None);
        assert_eq!(of(&means, "kinetic"), Some(2.0));
        assert!(times.means(&[]).is_empty());
        // Each step that was asked, and no other.
        assert_eq!(times.of(COLUMNS[0].key), [(0, 1.0), (1, 3.0)]);
        assert_eq!(times.of("parry")[1], (1, at as f64 + 3.0));
        assert_eq!(times.of("kinetic"), [(0, 1.0), (1, 3.0), (2, 9.0)]);
    }
}
