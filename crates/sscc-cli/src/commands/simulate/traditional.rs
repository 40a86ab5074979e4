//! What the traditional method takes at some states of a simulation.

use anyhow::Result;
use cpu_time::ThreadTime;
use sscc::{Method, Progress, Query};

use crate::interrupt;
use crate::progress::Bar;
use crate::scene::Scene;
use crate::simulation::{History, Prepared};

/// States at most, evenly spread ...
const STATES: usize = 100;

/// ... and bodies in all of them.
const BODIES: usize = 2000;

/// States, and the seconds of the processor that the traditional method takes for all bodies of each, on this thread.
pub fn costs(scene: &Scene, prepared: &Prepared, history: &History) -> Result<Vec<(usize, f64)>> {
    let mut queries: Vec<Query<'_>> = Vec::new();
    for model in &prepared.models {
        let certificates = &model.case.full.certificates;
        queries.push(Query::with_method(&model.case.model, certificates, Method::Traditional)?);
    }
    let count = STATES.min(BODIES / scene.bodies.len()).clamp(1, history.len());
    let bar = Bar::new("measuring");
    let mut costs = Vec::with_capacity(count);
    for sample in 0..count {
        interrupt::check()?;
        let state = sample * history.len() / count;
        let start = ThreadTime::now();
        for (body, facts) in scene.bodies.iter().zip(history.bodies(state)) {
            queries[body.model].discrete(facts.q)?;
        }
        costs.push((state, start.elapsed().as_secs_f64()));
        bar.report(sample + 1, count);
    }
    Ok(costs)
}
