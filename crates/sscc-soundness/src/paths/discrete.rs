//! Discrete queries by certificates: at random q, at the edge of the root's radius, and next to contacts, which are found by
//! bisection between a free q and a colliding one. Only q beyond the root's radius are counted.

use sscc::parts::ProvenShares;
use sscc::{Proof, Query, Statistics};

use super::share::some;
use crate::exact::work;
use crate::models::Extremes;
use crate::random::Random;
use crate::setup::{Setup, Wanted};
use crate::tally::Tally;

/// Runs queries with certificates about the rest pose.
pub fn run_rest(random: &mut Random, tally: &mut Tally, share: f64) {
    run(random, tally, share, false, false);
}

/// Runs queries with certificates about other centres.
pub fn run_centers(random: &mut Random, tally: &mut Tally, share: f64) {
    run(random, tally, share, true, false);
}

/// Runs queries with dense metrics.
pub fn run_dense(random: &mut Random, tally: &mut Tally, share: f64) {
    let has_center = random.one_in(3);
    run(random, tally, share, has_center, true);
}

fn run(random: &mut Random, tally: &mut Tally, share: f64, has_center: bool, is_dense: bool) {
    let extremes = if random.one_in(2) { Extremes::All } else { Extremes::Shape };
    let triangles = random.of(&[150, 200, 300, 500]);
    let Ok(setup) = Setup::random(random, &Wanted { triangles, extremes, has_center, is_dense }) else {
        tally.reach("refused models");
        return;
    };
    let share = share * setup.share();
    let Ok(query) = Query::new(&setup.reduced, &setup.certificates) else {
        tally.wrong(|| format!("{}: its own certificates are refused", setup.model.name));
        return;
    };
    let mut asker = Asker { setup: &setup, query, tally };
    let (mut free, mut colliding) = (vec![setup.certificates.center().to_vec()], Vec::new());
    for _ in 0..some(1500, share) {
        if work::is_spent() {
            break;
        }
        let q = setup.draw(random);
        match asker.ask(&q) {
            Some(true) => free.push(q),
            Some(false) => colliding.push(q),
            None => {}
        }
    }
    for _ in 0..some(30, share) {
        if colliding.is_empty() || work::is_spent() {
            break;
        }
        let (a, b) = (&free[random.below(free.len())], &colliding[random.below(colliding.len())]);
        asker.bisect(a, b, 44);
    }
}

/// Compares answers of a query with the oracle.
struct Asker<'s, 't> {
    setup: &'s Setup,
    query: Query,
    tally: &'t mut Tally,
}

impl Asker<'_, '_> {
    /// Compares the answer at q. Returns whether the shape is free there; None if q is out of range.
    fn ask(&mut self, q: &[f64]) -> Option<bool> {
        let Self { setup, query, tally } = self;
        let found = match query.discrete(q) {
            Ok(found) => found.to_vec(),
            Err(error) => {
                setup.refused(tally, &[q], &error);
                return None;
            }
        };
        let exact = setup.oracle.pairs(&setup.model.positions(q));
        let statistics = query.statistics();
        let before = tally.done;
        tally.compare(&found, &exact, || format!("{}: q={q:?}", setup.model.name));
        if statistics.norm < setup.certificates.root_radius() {
            tally.done = before;
            tally.reach("within the root");
        }
        count_proof(setup, &statistics, tally);
        if statistics.proof == Proof::Search && tally.done.is_multiple_of(16) {
            let local = ProvenShares::of(query, q).map_or(0.0, |shares| shares.local);
            tally.reach_if(local > 0.0, "nodes by local");
        }
        Some(exact.is_empty())
    }

    /// Bisects the line from a free q to a colliding one, and compares the answer at each midpoint.
    fn bisect(&mut self, free: &[f64], colliding: &[f64], steps: usize) {
        let (mut lower, mut upper) = (0.0, 1.0);
        for _ in 0..steps {
            if work::is_spent() {
                break;
            }
            let t = 0.5 * (lower + upper);
            let q: Vec<f64> = free.iter().zip(colliding).map(|(a, b)| a + t * (b - a)).collect();
            match self.ask(&q) {
                Some(true) => lower = t,
                Some(false) => upper = t,
                None => return,
            }
        }
        self.tally.reach("next to contact");
    }
}

/// Counts the kind of proof and the kinds of tests of a search.
fn count_proof(setup: &Setup, statistics: &Statistics, tally: &mut Tally) {
    match statistics.proof {
        Proof::Radius => tally.reach("proof by radius"),
        Proof::Local => tally.reach("proof by local"),
        Proof::Search => tally.reach("proof by search"),
    }
    let parts = setup.certificates.parts();
    tally.reach_if(statistics.box_tests > 0, "boxes");
    tally.reach_if(statistics.triangle_tests > 0, "tests");
    tally.reach_if(statistics.norm < parts.pair_tree.limit(), "within the tree");
    tally.reach_if(statistics.norm >= setup.certificates.global_radius(), "beyond all radii");
    tally.reach_if(!setup.certificates.exceptions().is_empty(), "exceptions");
}
