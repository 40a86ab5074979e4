//! Scenario `kinetic`: the cost of queries along a motion in small steps.

use std::iter;

use sscc::{KineticQuery, Query};
use sscc_tasks::{CertifiedModel, ModesSpec, Recipe, Shape, check_cancelled};

use super::kinetic_record::KineticRecord;
use super::vibration::Vibration;
use crate::error::Error;
use crate::measure::{REPETITIONS, median, seconds};
use crate::methods::{COLUMNS, Engine, Role};
use crate::record::Means;
use crate::sampling::{Strata, Stratum, weighted_mean};
use crate::setup::Setup;

/// Steps per second; each is a sample of sound.
const RATE: f64 = 44_100.0;

/// Natural frequencies of the first mode (Hz) of stiffer materials, beside the spring's own.
const STIFFER: [f64; 3] = [2.0, 20.0, 200.0];

/// Duration of the motion in periods of the first mode.
const PERIODS: f64 = 5.0;

/// Number of blocks of steps, which are spread over the motion.
const BLOCKS: usize = 10;

/// Number of steps, drawn from all strata, on which comparators run.
const COMPARED_STEPS: usize = 20;

/// A spring that vibrates.
pub struct KineticBench<'a> {
    setup: Setup<'a>,
    model: CertifiedModel,
    vibration: Vibration,
}

/// The steps of one vibration, and the times of the methods that run on all of them.
#[derive(Default)]
struct Motion {
    states: Vec<Vec<f64>>,
    strata: Vec<Stratum>,
    mismatches: usize,
    /// Seconds of kinetic queries.
    kinetic: f64,
    /// Seconds of kinetic queries in steps that collide.
    kinetic_colliding: f64,
    /// Seconds of certified discrete queries.
    full: f64,
    /// Length of a step relative to `|z|`, the mean over blocks.
    step: f64,
}

impl<'a> KineticBench<'a> {
    /// Default number of steps.
    pub const STEPS: usize = 20_000;

    /// Computes the spring and chooses the amplitude of its vibration.
    ///
    /// # Errors
    /// When the cache cannot be written to, or the work is cancelled.
    pub fn new(setup: Setup<'a>) -> Result<Self, Error> {
        let model = setup.certified_model(&Recipe::new("spring", Shape::SPRING, ModesSpec::Linear(20)))?;
        let vibration = Vibration::new(&model, setup.watch)?;
        Ok(Self { setup, model, vibration })
    }

    /// Returns the spring.
    pub fn model(&self) -> &CertifiedModel {
        &self.model
    }

    /// Returns frequencies of the first mode (Hz): the spring's own, and those of stiffer materials.
    pub fn frequencies(&self) -> impl Iterator<Item = f64> + use<> {
        iter::once(self.vibration.first_frequency()).chain(STIFFER)
    }

    /// Measures some steps of the spring with this frequency of its first mode (Hz).
    ///
    /// # Errors
    /// When the work is cancelled.
    pub fn measure(&self, frequency: f64, steps: usize) -> Result<KineticRecord, Error> {
        self.setup.begin_measuring();
        let mut motion = self.follow(frequency, steps)?;
        let microseconds = |seconds: f64| seconds * 1e6 / steps as f64;
        let mut times = vec![("kinetic", microseconds(motion.kinetic)), ("full", microseconds(motion.full))];
        let colliding = motion.strata.iter().filter(|stratum| **stratum == Stratum::Colliding).count();
        let compared_steps = self.compare(&mut motion, &mut times)?;
        Ok(KineticRecord {
            scenario: "kinetic",
            source: self.model.source.clone(),
            note: self.model.note.clone(),
            frequency,
            share: self.vibration.share,
            triangles: self.model.model.mesh().faces().len(),
            rank: self.model.model.rank(),
            step: motion.step,
            steps,
            colliding_steps: colliding,
            compared_steps,
            mismatches: motion.mismatches,
            kinetic_us_colliding: (colliding > 0).then(|| motion.kinetic_colliding * 1e6 / colliding as f64),
            microseconds: Means(times),
            machine: sscc_tasks::machine_description(),
        })
    }

    /// Runs kinetic and certified discrete queries on all steps.
    fn follow(&self, frequency: f64, steps: usize) -> Result<Motion, Error> {
        let (model, certificates) = (&self.model.model, &self.model.full.certificates);
        let mut compared = KineticQuery::new(model, certificates)?;
        let mut kinetic = KineticQuery::new(model, certificates)?;
        let mut full = Query::new(model, certificates)?;
        let mut motion = Motion::default();
        let blocks = BLOCKS.min(steps);
        for block in 0..blocks {
            check_cancelled(self.setup.watch)?;
            let count = steps / blocks + usize::from(block < steps % blocks);
            let start = PERIODS * block as f64 / blocks as f64;
            let states: Vec<Vec<f64>> =
                (0..count).map(|i| self.vibration.at(start + i as f64 * frequency / RATE)).collect();
            // Untimed queries find the collisions and compare the answers.
            let mut hits = Vec::with_capacity(count);
            for q in &states {
                let expected = full.discrete(q)?;
                motion.mismatches += usize::from(compared.discrete(q)? != expected);
                hits.push(!expected.is_empty());
                motion.strata.push(Stratum::of(!self.model.is_root_certified(q), !expected.is_empty()));
            }
            // Each method runs alone, as in a simulation. Consecutive steps that all collide or are all free share one
            // reading of the clock.
            let mut at = 0;
            while at < count {
                let end = (at..count).find(|i| hits[*i] != hits[at]).unwrap_or(count);
                let time =
                    seconds(|| states[at..end].iter().try_for_each(|q| kinetic.discrete(q).map(drop)))?;
                motion.kinetic += time;
                motion.kinetic_colliding += if hits[at] { time } else { 0.0 };
                at = end;
            }
            motion.full += seconds(|| states.iter().try_for_each(|q| full.discrete(q).map(drop)))?;
            if let [a, b, ..] = &states[..] {
                let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
                motion.step +=
                    certificates.metric().norm(&difference)? / certificates.norm(a)? / blocks as f64;
            }
            motion.states.extend(states);
            self.setup.watch.report(block + 1, blocks);
        }
        Ok(motion)
    }

    /// Runs comparators on some of the steps and appends their mean microseconds. Returns the number of these steps.
    fn compare(&self, motion: &mut Motion, times: &mut Vec<(&'static str, f64)>) -> Result<usize, Error> {
        let mut full = Query::new(&self.model.model, &self.model.full.certificates)?;
        let strata = Strata::new(motion.strata.clone(), None);
        let steps = strata.draw(COMPARED_STEPS);
        let weights = strata.weights(&steps);
        for column in COLUMNS.iter().filter(|column| column.role == Role::Comparator) {
            let mut engine = column.engine(&self.model)?;
            let mut own = Vec::with_capacity(steps.len());
            for q in steps.iter().map(|step| &motion.states[*step]) {
                motion.mismatches += usize::from(engine.discrete(q)? != full.discrete(q)?);
                let repetitions: Result<Vec<f64>, sscc::Error> = (0..REPETITIONS)
                    .map(|_| seconds(|| Engine::discrete(engine.as_mut(), q).map(drop)))
                    .collect();
                own.push(median(repetitions?));
            }
            let mean = 1e6 * weighted_mean(own, &weights);
            match times.iter_mut().find(|(key, _)| *key == column.key) {
                Some((_, known)) => *known = known.min(mean),
                None => times.push((column.key, mean)),
            }
        }
        Ok(steps.len())
    }
}
