//! `kinetic`: what queries cost that follow a motion in small steps.

use std::iter;

use anyhow::Result;
use cpu_time::ThreadTime;
use serde::Serialize;
use sscc::{KineticQuery, Progress, Query};

use super::Session;
use super::clock::median;
use super::columns::{COLUMNS, Engine, Role};
use super::report::Means;
use super::strata::{Strata, Stratum, weighted_mean};
use super::vibration::Vibration;
use crate::interrupt;
use crate::output::{Output, grouped};
use crate::progress::Bar;
use sscc_sim::{CertifiedModel, ModesSpec, Recipe, Shape, machine_description};

/// Steps in a second: each is a sample of sound.
const RATE: f64 = 44_100.0;

/// Natural frequencies of the first mode (Hz) beside the spring's own: stiffer materials.
const STIFFER: [f64; 3] = [2.0, 20.0, 200.0];

/// The motion lasts so many periods of the first mode; the steps are in blocks spread over it.
const PERIODS: f64 = 5.0;
const BLOCKS: usize = 10;
const STEPS: usize = 20_000;

/// Methods that do not follow are asked so many of the steps, drawn of each stratum.
const COMPARED: usize = 20;

/// Repetitions of what is asked of comparators; the median counts.
const ROUNDS: usize = 3;

/// One line of JSON. Times are means over steps.
#[derive(Serialize)]
struct Report {
    scenario: &'static str,
    source: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    /// Of the first mode, in Hz.
    frequency: f64,
    share: f64,
    triangles: usize,
    rank: usize,
    /// Length of a step over the length of z, the mean over blocks.
    step: f64,
    steps: usize,
    colliding_steps: usize,
    compared_steps: usize,
    mismatches: usize,
    /// Over the steps that collide.
    kinetic_us_colliding: Option<f64>,
    /// Comparators over `compared_steps`, each of which counts by its stratum's share of all steps.
    microseconds: Means,
    machine: String,
}

/// Gives the number of mismatches.
pub fn run(session: &Session<'_>, out: &mut Output) -> Result<usize> {
    let case = session.case(&Recipe::new("spring", Shape::SPRING, ModesSpec::Linear(20)))?;
    let vibration = Vibration::new(&case, 1)?;
    let steps = session.args.steps.map_or(STEPS, |steps| steps as usize);
    let own = vibration.bodies[0].first_frequency() / std::f64::consts::TAU;
    let mut mismatches = 0;
    if !session.args.json.json {
        let (triangles, rank) = (grouped(case.model.mesh().faces().len() as u64), case.model.rank());
        out.line(format_args!("kinetic: {triangles} triangles, {rank} modes ({})", case.source))?;
        case.note.iter().try_for_each(|note| out.line(format_args!("note: {note}")))?;
    }
    for frequency in iter::once(own).chain(STIFFER) {
        let report = measure(&case, &vibration, frequency, steps)?;
        mismatches += report.mismatches;
        if session.args.json.json {
            out.json(&report)?;
        } else {
            report.lines().into_iter().try_for_each(|line| out.line(line))?;
        }
        out.flush()?;
        if session.is_over(out) {
            break;
        }
    }
    Ok(mismatches)
}

fn measure(case: &CertifiedModel, vibration: &Vibration, frequency: f64, steps: usize) -> Result<Report> {
    let (blocks, body) = (BLOCKS.min(steps), &vibration.bodies[0]);
    let certificates = &case.full.certificates;
    let mut follower = KineticQuery::new(&case.model, certificates)?;
    let mut kinetic = KineticQuery::new(&case.model, certificates)?;
    let mut full = Query::new(&case.model, certificates)?;
    let bar = Bar::new("measuring");
    let (mut colliding, mut mismatches, mut step) = (0, 0, 0.0);
    let (mut times, mut time_colliding) = ([0.0; 2], 0.0);
    let (mut states, mut strata) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
    for block in 0..blocks {
        interrupt::check()?;
        let count = steps / blocks + usize::from(block < steps % blocks);
        let start = PERIODS * block as f64 / blocks as f64;
        let path: Vec<Vec<f64>> = (0..count).map(|i| body.at(start + i as f64 * frequency / RATE)).collect();
        // Untimed: what collides, and whether both agree.
        let mut hits = Vec::with_capacity(count);
        for q in &path {
            let expected = full.discrete(q)?;
            mismatches += usize::from(follower.discrete(q)? != expected);
            hits.push(!expected.is_empty());
            strata.push(Stratum::of(!case.is_root_certified(q), !expected.is_empty()));
        }
        colliding += hits.iter().filter(|hit| **hit).count();
        // Each method by itself, as in a simulation; stretches of steps that all collide or are all free share a look
        // at the clock.
        let mut at = 0;
        while at < count {
            let end = (at..count).find(|i| hits[*i] != hits[at]).unwrap_or(count);
            let time = seconds(|| path[at..end].iter().try_for_each(|q| kinetic.discrete(q).map(drop)))?;
            times[0] += time;
            time_colliding += if hits[at] { time } else { 0.0 };
            at = end;
        }
        times[1] += seconds(|| path.iter().try_for_each(|q| full.discrete(q).map(drop)))?;
        step += match &path[..] {
            [a, b, ..] => {
                let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
                certificates.metric().norm(&difference) / certificates.norm(a) / blocks as f64
            }
            _ => 0.0,
        };
        states.extend(path);
        bar.report(block + 1, blocks);
    }
    let mut microseconds =
        vec![("kinetic", times[0] * 1e6 / steps as f64), ("full", times[1] * 1e6 / steps as f64)];
    let strata = Strata::new(strata, None);
    let compared = strata.draw(COMPARED);
    let weights = strata.weights(&compared);
    for column in COLUMNS.iter().filter(|column| column.role == Role::Comparator) {
        let mut engine = column.engine(case)?;
        let mut times = Vec::with_capacity(compared.len());
        for q in compared.iter().map(|step| &states[*step]) {
            mismatches += usize::from(engine.discrete(q)? != full.discrete(q)?);
            let rounds: Result<Vec<f64>> =
                (0..ROUNDS).map(|_| seconds(|| Engine::discrete(engine.as_mut(), q).map(drop))).collect();
            times.push(median(rounds?));
        }
        let mean = 1e6 * weighted_mean(times, &weights);
        match microseconds.iter_mut().find(|(key, _)| *key == column.key) {
            Some((_, known)) => *known = known.min(mean),
            None => microseconds.push((column.key, mean)),
        }
    }
    Ok(Report {
        scenario: "kinetic",
        source: case.source.clone(),
        note: case.note.clone(),
        frequency,
        share: vibration.share,
        triangles: case.model.mesh().faces().len(),
        rank: case.model.rank(),
        step,
        steps,
        colliding_steps: colliding,
        compared_steps: compared.len(),
        mismatches,
        kinetic_us_colliding: (colliding > 0).then(|| time_colliding * 1e6 / colliding as f64),
        microseconds: Means(microseconds),
        machine: machine_description(),
    })
}

/// Processor time of this thread.
fn seconds(work: impl FnOnce() -> Result<(), sscc::Error>) -> Result<f64> {
    let start = ThreadTime::now();
    work()?;
    Ok(start.elapsed().as_secs_f64())
}

impl Report {
    fn lines(&self) -> Vec<String> {
        let per_cent = 100.0 * self.colliding_steps as f64 / self.steps as f64;
        let mut lines = vec![format!(
            "  first mode {:.3} Hz: {} steps of {:.5} |z|, {per_cent:.1}% collide",
            self.frequency,
            grouped(self.steps as u64),
            self.step
        )];
        let kinetic = self.microseconds.get("kinetic").unwrap_or(f64::NAN);
        for (key, time) in &self.microseconds.0 {
            let ratio = if *key == "kinetic" {
                self.kinetic_us_colliding
                    .map_or(String::new(), |time| format!("{time:>12.2} us where it collides"))
            } else {
                format!("{:>11.1} x", time / kinetic)
            };
            lines.push(format!("    {key:<14}{time:>12.2} us{ratio}"));
        }
        lines
    }
}
