//! `amplitudes`: what queries cost over how far the shape is displaced.

use anyhow::Result;

use super::Session;
use super::measure::{Asked, Step, measure};
use super::report::Report;
use super::sample::{directions, scaled, to_unit};
use crate::output::Output;
use crate::progress::Bar;
use sscc_sim::{ModesSpec, Recipe, Shape};

/// Largest displacements in percent of half the diagonal of the box.
const SHARES: [f64; 7] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0];

/// Samples at each of them.
const SAMPLES: usize = 64;

/// A continuous query goes so much farther.
const ONWARD: f64 = 1.01;

/// Gives the number of mismatches.
pub fn run(session: &Session<'_>, out: &mut Output) -> Result<usize> {
    let recipes = [("bunny", Shape::Bunny, 30), ("dragon", Shape::Dragon, 30), ("spring", Shape::SPRING, 20)];
    session.check_only(&recipes.each_ref().map(|(name, ..)| *name))?;
    let mut mismatches = 0;
    for (name, shape, rank) in recipes.into_iter().filter(|(name, ..)| session.wants(name)) {
        let case = session.case(&Recipe::new(name, shape, ModesSpec::Linear(rank)))?;
        let unit = to_unit(&case.model, &directions(&case.model, session.samples(SAMPLES)));
        let mut reports = Vec::new();
        for share in SHARES {
            let steps = steps(&unit, share);
            let measured = measure(&case, &steps, None, Asked::Both, &Bar::new("measuring"))?;
            mismatches += measured.mismatches;
            let name = format!("amplitudes/{name}");
            reports.push(Report::new(name, share, &case, &measured, 1, None));
        }
        session.print(&reports, out)?;
        if session.is_over(out) {
            break;
        }
    }
    Ok(mismatches)
}

/// Steps at a share (percent) of the q that displace by all of it.
pub fn steps(unit: &[Vec<f64>], share: f64) -> Vec<Step> {
    let at = |q: &[f64], factor: f64| vec![scaled(q, share / 100.0 * factor)];
    unit.iter().map(|q| Step { before: None, q_t0: at(q, 1.0), q_t1: at(q, ONWARD) }).collect()
}
