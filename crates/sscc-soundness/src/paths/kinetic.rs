//! Kinetic queries along motions of small steps: straight, bent, and back and forth around a contact.

use sscc::{KineticQuery, Proof};

use super::share::some;
use crate::exact::work;
use crate::models::Extremes;
use crate::random::Random;
use crate::setup::{Setup, Wanted, direction};
use crate::tally::Tally;

/// Runs some motions of one model.
pub fn run(random: &mut Random, tally: &mut Tally, share: f64) {
    let extremes = if random.one_in(3) { Extremes::All } else { Extremes::Shape };
    let triangles = random.of(&[150, 200, 300]);
    let (has_center, is_dense) = (random.one_in(4), random.one_in(5));
    let Ok(setup) = Setup::random(random, &Wanted { triangles, extremes, has_center, is_dense }) else {
        tally.reach("refused models");
        return;
    };
    let share = share * setup.share();
    let Ok(mut query) = KineticQuery::new(&setup.reduced, &setup.certificates) else {
        tally.wrong(|| format!("{}: its own certificates are refused", setup.model.name));
        return;
    };
    for _ in 0..some(24, share) {
        // One query serves all motions, so it jumps from the end of one to the start of the next.
        motion(random, tally, &setup, &mut query, 120);
    }
}

fn motion(random: &mut Random, tally: &mut Tally, setup: &Setup, query: &mut KineticQuery, steps: usize) {
    let center = setup.certificates.center();
    let mut q = setup.draw(random);
    let length: Vec<f64> = q.iter().zip(center).map(|(q, c)| q - c).collect();
    let size = length.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let share = random.power(-7.0, -1.0);
    let mut velocity = direction(random, &setup.model);
    let speed = velocity.iter().fold(0.0, |m: f64, x| m.max(x.abs())).max(f64::MIN_POSITIVE);
    velocity.iter_mut().for_each(|v| *v *= share * size / speed);
    let kind = random.below(4);
    let mut last = q.clone();
    for step in 0..steps {
        if work::is_spent() {
            break;
        }
        match kind {
            // A motion away from the centre and back.
            0 => q
                .iter_mut()
                .zip(&length)
                .for_each(|(q, y)| *q += share * y * if step % 40 < 20 { 1.0 } else { -1.0 }),
            1 => q.iter_mut().zip(&velocity).for_each(|(q, v)| *q += v),
            2 => {
                let (s, c) = (step as f64 * 0.1).sin_cos();
                q.iter_mut().zip(&velocity).zip(&length).for_each(|((q, v), y)| *q += c * v + s * share * y);
            }
            _ => q.iter_mut().zip(&velocity).for_each(|(q, v)| *q += v * random.signed()),
        }
        if !ask(random, tally, setup, query, [&last, &q]) {
            return;
        }
        last.clone_from(&q);
    }
}

/// Compares the answer of one step. Returns false if q is out of range.
fn ask(
    random: &mut Random,
    tally: &mut Tally,
    setup: &Setup,
    query: &mut KineticQuery,
    [last, q]: [&[f64]; 2],
) -> bool {
    let place = || format!("{}: q={q:?} after {last:?}", setup.model.name);
    let exact = setup.oracle.pairs(&setup.model.positions(q));
    // The continuous query comes before the discrete one of this step, as in a simulation.
    if random.one_in(4) && !exact.is_empty() {
        swept(tally, setup, query, [last, q], &exact, &place);
    }
    let found = match query.discrete(q) {
        Ok(found) => found.to_vec(),
        Err(error) => {
            setup.refused(tally, &[q], &error);
            return false;
        }
    };
    let statistics = query.statistics();
    tally.compare(&found, &exact, place);
    if statistics.norm >= setup.certificates.root_radius() {
        // A search without active pairs opens at least the root.
        let is_search = statistics.proof == Proof::Search;
        tally.reach_if(is_search && statistics.opened == 0, "active pairs");
        tally.reach_if(statistics.proof == Proof::Local, "proof by local");
        tally.reach_if(is_search && statistics.opened > 0, "searches");
    } else {
        tally.reach("within the root");
    }
    true
}

/// Checks that a motion that ends in these pairs lists them.
fn swept(
    tally: &mut Tally,
    setup: &Setup,
    query: &mut KineticQuery,
    ends: [&[f64]; 2],
    exact: &[(u32, u32)],
    place: &dyn Fn() -> String,
) {
    let impacts = match query.continuous(ends[0], ends[1]) {
        Ok(impacts) => impacts,
        Err(error) => return setup.refused(tally, &ends, &error),
    };
    tally.reach("swept");
    let missing = exact.iter().find(|pair| impacts.iter().all(|impact| impact.pair != **pair));
    if let Some(pair) = missing {
        tally.false_negative(|| format!("{}: swept: {pair:?} collides at the end", place()));
    }
}
