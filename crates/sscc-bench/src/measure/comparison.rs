//! Compares all methods on the same steps: their times and their answers.

use sscc::Progress;
use sscc_tasks::{CertifiedModel, check_cancelled};

use super::agreement::{agree_on_motion, compare_discrete};
use super::step::Step;
use super::timer::{REPETITIONS, Timer};
use super::times::Times;
use crate::error::Error;
use crate::methods::{COLUMNS, Column, Engine, Role};
use crate::progress::Counter;
use crate::sampling::{Counts, Strata, Stratum};

/// Maximum number of queries (steps times bodies) for which comparators run on all discrete queries.
const MAX_QUERIES_OF_COMPARATORS: usize = 64;

/// Number of steps, drawn from all strata, on which comparators run if there are more queries. Continuous queries always use it.
const COMPARED_STEPS: usize = 20;

/// Results of all methods on some steps.
pub struct Comparison {
    /// Whether a body collides with itself at the start, for each step.
    pub colliding: Vec<bool>,
    /// Whether the root's certificate fails for a body at the start, for each step.
    pub root_failed: Vec<bool>,
    /// Strata of the steps, which give their weights.
    pub strata: Strata,
    /// Times of discrete queries.
    pub discrete: Times,
    /// Times of continuous queries.
    pub continuous: Times,
    /// Steps in which two exact methods differ.
    pub mismatches: usize,
}

/// Kinds of measured queries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinds {
    /// Discrete and continuous queries.
    Both,
    /// Discrete queries only.
    Discrete,
}

/// Runs all methods. `scene` counts the strata of all steps of the scene that the given steps represent; None if the given steps
/// are the whole scene.
///
/// # Errors
/// When some q is out of range, or `progress` cancels.
pub fn compare(
    model: &CertifiedModel,
    steps: &[Step],
    scene: Option<Counts>,
    kinds: Kinds,
    progress: &dyn Progress,
) -> Result<Comparison, Error> {
    let mut engines: Vec<Box<dyn Engine + '_>> =
        COLUMNS.iter().map(|column| column.engine(model)).collect::<Result<_, _>>()?;
    let objects = steps.first().map_or(0, |step| step.q_t0.len());
    let is_certified = |column: &Column| column.role == Role::Certified;
    // The choice of compared steps requires the strata of all steps.
    let (mut colliding, mut root_failed) = (Vec::with_capacity(steps.len()), Vec::with_capacity(steps.len()));
    let mut differs = Vec::with_capacity(steps.len());
    for step in steps {
        check_cancelled(progress)?;
        let agreement = compare_discrete(&mut engines, is_certified, &step.q_t0)?;
        colliding.push(agreement.is_colliding);
        root_failed.push(step.q_t0.iter().any(|q| !model.is_root_certified(q)));
        differs.push(!agreement.is_equal);
    }
    let of = root_failed.iter().zip(&colliding).map(|(failed, collides)| Stratum::of(*failed, *collides));
    let strata = Strata::new(of.collect(), scene);
    let all: Vec<usize> = (0..steps.len()).collect();
    let is_few = steps.len() * objects <= MAX_QUERIES_OF_COMPARATORS;
    let compared = if is_few { all.clone() } else { strata.draw(COMPARED_STEPS) };
    let continuous = match kinds {
        Kinds::Both if is_few => strata.draw(COMPARED_STEPS),
        Kinds::Both => compared.clone(),
        Kinds::Discrete => Vec::new(),
    };
    let is_compared = |step: &usize| compared.binary_search(step).is_ok();
    let others: Vec<usize> = all.into_iter().filter(|step| !is_compared(step)).collect();

    let (columns, certified) = (COLUMNS.len(), COLUMNS.iter().filter(|column| is_certified(column)).count());
    let runs = columns * (compared.len() + continuous.len()) + certified * others.len();
    let mut counter = Counter::new(progress, compared.len() + REPETITIONS * runs);
    for at in &compared {
        let step = &steps[*at];
        let is_equal = compare_discrete(&mut engines, |_| true, &step.q_t0)?.is_equal
            && (continuous.binary_search(at).is_err() || agree_on_motion(&mut engines, &model.model, step)?);
        differs[*at] |= !is_equal;
        counter.count()?;
    }
    let mut discrete = Timer::new(&mut engines, steps, &mut counter);
    discrete.time(&compared, |_| true, &discrete_queries)?;
    discrete.time(&others, is_certified, &discrete_queries)?;
    let discrete = Times { compared, interleaved: discrete.times, kinetic: Vec::new() };
    let mut moving = Timer::new(&mut engines, steps, &mut counter);
    moving.time(&continuous, |_| true, &continuous_queries)?;
    let continuous = Times { compared: continuous, interleaved: moving.times, kinetic: Vec::new() };
    let mismatches = differs.into_iter().filter(|differs| *differs).count();
    Ok(Comparison { colliding, root_failed, strata, discrete, continuous, mismatches })
}

fn discrete_queries(engine: &mut dyn Engine, step: &Step) -> Result<(), Error> {
    Ok(step.q_t0.iter().try_for_each(|q| engine.discrete(q).map(drop))?)
}

fn continuous_queries(engine: &mut dyn Engine, step: &Step) -> Result<(), Error> {
    let mut bodies = step.q_t0.iter().zip(&step.q_t1);
    Ok(bodies.try_for_each(|(q_t0, q_t1)| engine.continuous(q_t0, q_t1).map(drop))?)
}
