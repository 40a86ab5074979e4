//! Compares the pairs that methods list.

use sscc::{Impact, Pair, ReducedModel};

use super::mismatch::is_mismatch;
use super::step::Step;
use crate::error::Error;
use crate::methods::{COLUMNS, Column, Engine, Role};

/// Comparison of the answers of several methods to the same discrete queries.
pub struct Agreement {
    /// Whether some body collides with itself.
    pub is_colliding: bool,
    /// Whether all exact methods list the same pairs.
    pub is_equal: bool,
}

/// Runs discrete queries of all bodies by the methods that take part, and compares their pairs.
pub fn compare_discrete(
    engines: &mut [Box<dyn Engine + '_>],
    takes_part: impl Fn(&Column) -> bool,
    bodies: &[Vec<f64>],
) -> Result<Agreement, Error> {
    let mut agreement = Agreement { is_colliding: false, is_equal: true };
    for q in bodies {
        let mut expected: Option<Vec<Pair>> = None;
        for (column, engine) in COLUMNS.iter().zip(&mut *engines) {
            if !takes_part(column) {
                continue;
            }
            let pairs = engine.discrete(q)?;
            if column.role == Role::Approximate {
                continue;
            }
            match &expected {
                Some(expected) => agreement.is_equal &= pairs == expected,
                None => expected = Some(pairs.to_vec()),
            }
            agreement.is_colliding |= !pairs.is_empty();
        }
    }
    Ok(agreement)
}

/// Returns whether all methods list the same pairs for the motion of all bodies, apart from pairs within the tolerance.
pub fn agree_on_motion(
    engines: &mut [Box<dyn Engine + '_>],
    model: &ReducedModel,
    step: &Step,
) -> Result<bool, Error> {
    let mut is_equal = true;
    for (q_t0, q_t1) in step.q_t0.iter().zip(&step.q_t1) {
        let mut answers: Vec<Vec<Impact>> = Vec::new();
        for engine in &mut *engines {
            answers.push(engine.continuous(q_t0, q_t1)?.to_vec());
        }
        let lists = |answer: &[Impact], impact: &Impact| {
            answer.binary_search_by_key(&impact.pair, |impact| impact.pair).is_ok()
        };
        let disputed =
            answers.iter().flatten().filter(|impact| !answers.iter().all(|answer| lists(answer, impact)));
        for impact in disputed {
            is_equal &= !is_mismatch(model, q_t0, q_t1, impact);
        }
    }
    Ok(is_equal)
}
