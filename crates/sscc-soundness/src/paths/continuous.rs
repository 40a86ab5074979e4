//! Continuous queries: every pair that collides at an end must be listed. Pairs that are not listed, and times of impact, are
//! attacked one by one.

use sscc::{Impact, Proof, Query};

use super::moving_pairs::{Effort, Ends, attack_free, attack_impact};
use super::share::some;
use crate::exact::Point;
use crate::exact::work;
use crate::models::Extremes;
use crate::oracle::Oracle;
use crate::random::Random;
use crate::setup::{Setup, Wanted};
use crate::tally::Tally;

/// Maximum number of pairs of one query that are attacked.
const MOST_ATTACKS: usize = 24;

/// Runs some motions of one model.
pub fn run(random: &mut Random, tally: &mut Tally, share: f64) {
    let extremes = if random.one_in(3) { Extremes::All } else { Extremes::Shape };
    let triangles = random.of(&[130, 160, 220]);
    let (has_center, is_dense) = (random.one_in(4), random.one_in(5));
    let Ok(setup) = Setup::random(random, &Wanted { triangles, extremes, has_center, is_dense }) else {
        tally.reach("refused models");
        return;
    };
    let share = share * setup.share();
    let Ok(mut query) = Query::new(&setup.reduced, &setup.certificates) else {
        tally.wrong(|| format!("{}: its own certificates are refused", setup.model.name));
        return;
    };
    let mut last = setup.draw(random);
    for _ in 0..some(800, share) {
        if work::is_spent() {
            break;
        }
        let step = random.power(-6.0, 0.0);
        let target = setup.draw(random);
        let q: Vec<f64> = last.iter().zip(&target).map(|(a, b)| a + step * (b - a)).collect();
        let impacts = match query.continuous(&last, &q) {
            Ok(impacts) => impacts.to_vec(),
            Err(error) => {
                setup.refused(tally, &[&last, &q], &error);
                last = target;
                continue;
            }
        };
        let statistics = query.statistics();
        match statistics.proof {
            Proof::Radius => tally.reach("proof by radius"),
            Proof::Local => tally.reach("proof by local"),
            Proof::Search => tally.reach("proof by search"),
        }
        let ends = [&last, &q].map(|q| setup.model.positions(q));
        let place = format!("{}: from {last:?} to {q:?}", setup.model.name);
        check(random, tally, &setup.oracle, [&ends[0], &ends[1]], &impacts, &place);
        last = q;
    }
}

/// Attacks the answer of a continuous query.
pub fn check(
    random: &mut Random,
    tally: &mut Tally,
    oracle: &Oracle,
    ends: [&[Point]; 2],
    impacts: &[Impact],
    place: &str,
) {
    tally.answer();
    tally.reach_if(!impacts.is_empty(), "colliding");
    let listed: Vec<(u32, u32)> = impacts.iter().map(|impact| impact.pair).collect();
    if !listed.is_sorted_by(|a, b| a < b) {
        tally.wrong(|| format!("{place}: out of order"));
    }
    let is_listed = |pair: &(u32, u32)| listed.binary_search(pair).is_ok();
    for positions in ends {
        if let Some(pair) = oracle.pairs(positions).iter().find(|pair| !is_listed(pair)) {
            tally.false_negative(|| format!("{place}: {pair:?} collides at an end"));
        }
    }
    if let Some(pair) = listed.iter().find(|pair| !oracle.counts(**pair)) {
        tally.wrong(|| format!("{place}: {pair:?} does not count"));
    }
    let moving = |t: u32| -> Ends { ends.map(|positions| oracle.triangle(positions, t)) };
    let mut free = oracle.candidates(ends);
    free.retain(|pair| !is_listed(pair));
    let before = (tally.false_negatives, tally.wrong);
    for _ in 0..free.len().min(MOST_ATTACKS) {
        let (a, b) = free.swap_remove(random.below(free.len()));
        tally.reach("pairs attacked");
        let effort = if random.one_in(400) { Effort::Roots } else { Effort::Halving };
        attack_free(tally, &moving(a), &moving(b), effort);
    }
    for _ in 0..impacts.len().min(4) {
        let Impact { pair, time } = impacts[random.below(impacts.len())];
        if !oracle.counts_whole(pair) {
            continue;
        }
        let effort = if random.one_in(100) { Effort::Roots } else { Effort::Halving };
        attack_impact(random, tally, &moving(pair.0), &moving(pair.1), time, effort);
    }
    if (tally.false_negatives, tally.wrong) != before {
        tally.messages.push(format!("in {place}"));
    }
}
