//! Safe scales, sweeps and free configurations. Each answer promises that a part of a line in q-space, or one q, is free. The
//! promise is attacked at its end and at random places.

use sscc::{Query, ResolveOptions, SweepOutcome};

use super::share::some;
use crate::exact::work;
use crate::models::Extremes;
use crate::random::Random;
use crate::setup::{Setup, Wanted};
use crate::tally::Tally;

/// Returns a model for queries that take as long as several discrete queries.
fn setup(random: &mut Random, tally: &mut Tally) -> Option<(Setup, Query)> {
    let extremes = if random.one_in(3) { Extremes::All } else { Extremes::Shape };
    let wanted = Wanted {
        triangles: random.of(&[130, 160, 220]),
        extremes,
        has_center: random.one_in(3),
        is_dense: random.one_in(4),
    };
    let setup = Setup::random(random, &wanted).ok();
    tally.reach_if(setup.is_none(), "refused models");
    let setup = setup?;
    match Query::new(&setup.reduced, &setup.certificates) {
        Ok(query) => Some((setup, query)),
        Err(error) => {
            tally.wrong(|| format!("{}: its own certificates are refused: {error}", setup.model.name));
            None
        }
    }
}

/// Runs queries for safe scales.
pub fn run_scales(random: &mut Random, tally: &mut Tally, share: f64) {
    let Some((setup, mut query)) = setup(random, tally) else { return };
    let share = share * setup.share();
    let center = setup.certificates.center().to_vec();
    for _ in 0..some(400, share) {
        if work::is_spent() {
            break;
        }
        let q = setup.draw(random);
        let scale = match query.safe_scale(&q) {
            Ok(scale) => scale,
            Err(error) => {
                setup.refused(tally, &[&q], &error);
                continue;
            }
        };
        tally.answer();
        tally.reach_if(scale > 0.0, "positive");
        let at = |t: f64| -> Vec<f64> { center.iter().zip(&q).map(|(c, q)| c + t * (q - c)).collect() };
        let last = if scale.is_finite() { scale } else { 2.0 };
        let mut times = vec![last, last.next_down(), last * (1.0 - 1e-12), last * random.unit()];
        times.push(last * (1.0 - random.power(-9.0, -1.0)));
        for t in times.into_iter().filter(|t| *t > 0.0) {
            let q = at(t);
            if !setup.is_beyond_range(&q) && !setup.oracle.is_free(&setup.model.positions(&q)) {
                tally.false_negative(|| {
                    format!("{}: safe scale {scale}, colliding at {t}: q={q:?}", setup.model.name)
                });
            }
        }
        let beyond = at(last * 1.01);
        tally.reach_if(
            !setup.is_beyond_range(&beyond) && !setup.oracle.is_free(&setup.model.positions(&beyond)),
            "colliding beyond",
        );
    }
}

/// Runs sweeps of one mode.
pub fn run_sweeps(random: &mut Random, tally: &mut Tally, share: f64) {
    let Some((setup, mut query)) = setup(random, tally) else { return };
    let share = share * setup.share();
    for _ in 0..some(400, share) {
        if work::is_spent() {
            break;
        }
        let mut q = if random.one_in(2) { setup.certificates.center().to_vec() } else { setup.draw(random) };
        let mode = random.below(setup.model.rank);
        let to = setup.draw(random)[mode] * random.of(&[1.0, 3.0, -1.0]);
        let sweep = match query.sweep(&q, mode, to) {
            Ok(sweep) => sweep,
            Err(error) => {
                let mut end = q.clone();
                end[mode] = to;
                setup.refused(tally, &[&q, &end], &error);
                continue;
            }
        };
        tally.answer();
        let name = &setup.model.name;
        let place = format!("{name}: mode {mode} from {q:?} to {to}: {sweep:?}");
        let mut pairs_at = |weight: f64| {
            q[mode] = weight;
            setup.oracle.pairs(&setup.model.positions(&q))
        };
        let from = sweep.from;
        let Some(free) = sweep.first_free else {
            tally.reach("colliding at start");
            if pairs_at(from).is_empty() {
                tally.wrong(|| format!("{place}: the shape does not collide at the start"));
            }
            continue;
        };
        let random_weight = from + random.unit() * (free - from);
        for weight in [from, free, random_weight, free - (free - from) * random.power(-9.0, -1.0)] {
            let is_inside = (from.min(free)..=from.max(free)).contains(&weight);
            if is_inside && !pairs_at(weight).is_empty() {
                tally.false_negative(|| format!("{place}: colliding at {weight}"));
            }
        }
        match (sweep.outcome, sweep.first_hit) {
            (SweepOutcome::Hit, Some(hit)) => {
                tally.reach("hit");
                if pairs_at(hit) != sweep.pairs || sweep.pairs.is_empty() {
                    tally.wrong(|| format!("{place}: other pairs at the hit"));
                }
            }
            (SweepOutcome::Free, _) => tally.reach("free"),
            _ => tally.reach("other ends"),
        }
    }
}

/// Runs queries for free configurations near colliding ones.
pub fn run_resolves(random: &mut Random, tally: &mut Tally, share: f64) {
    let Some((setup, mut query)) = setup(random, tally) else { return };
    let share = share * setup.share();
    for _ in 0..some(200, share) {
        if work::is_spent() {
            break;
        }
        let q = setup.draw(random);
        let all = random.one_in(2);
        let resolved = match query.resolve(&q, &ResolveOptions::default().all(all)) {
            Ok(resolved) => resolved,
            Err(error) => {
                setup.refused(tally, &[&q], &error);
                continue;
            }
        };
        tally.answer();
        let place = || format!("{}: all={all} q={q:?}: {resolved:?}", setup.model.name);
        let Some(answer) = &resolved.q else {
            tally.reach("none");
            continue;
        };
        tally.reach(if *answer == q { "already free" } else { "resolved" });
        let exceptions = setup.certificates.exceptions();
        let mut pairs = setup.oracle.pairs(&setup.model.positions(answer));
        pairs.retain(|pair| all || !exceptions.contains(pair));
        if !pairs.is_empty() {
            tally.false_negative(|| format!("{}: {pairs:?} collide", place()));
        }
        if resolved.change > resolved.safe_scale_change {
            tally.wrong(|| format!("{}: farther than a step back along the line", place()));
        }
    }
}
