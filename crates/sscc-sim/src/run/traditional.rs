//! Measures the traditional method at some states of a simulation, for comparison.

use cpu_time::ThreadTime;
use sscc::{Method, Query};

use super::history::History;
use super::prepared::PreparedScene;
use crate::error::Result;
use crate::scenes::Scene;
use crate::watch::{Stage, Watch, check_cancelled};

/// Maximum number of measured states, evenly spread.
const MAX_STATES: usize = 100;

/// Maximum number of bodies in all of these states.
const MAX_BODY_STATES: usize = 2000;

/// Returns some states, evenly spread, each with the processor time (s) of the traditional method for all bodies on
/// this thread.
pub fn traditional_costs(
    scene: &Scene,
    prepared: &PreparedScene,
    history: &History,
    watch: &dyn Watch,
) -> Result<Vec<(usize, f64)>> {
    let mut queries: Vec<Query<'_>> = Vec::new();
    for model in &prepared.models {
        let certificates = &model.certified.full.certificates;
        queries.push(Query::with_method(&model.certified.model, certificates, Method::Traditional)?);
    }
    let count = MAX_STATES.min(MAX_BODY_STATES / scene.bodies.len()).clamp(1, history.len());
    watch.begin(Stage::Comparison);
    let mut costs = Vec::with_capacity(count);
    for sample in 0..count {
        check_cancelled(watch)?;
        let state = sample * history.len() / count;
        let start = ThreadTime::now();
        for (body, record) in scene.bodies.iter().zip(history.bodies(state)) {
            queries[body.model].discrete(record.q)?;
        }
        costs.push((state, start.elapsed().as_secs_f64()));
        watch.report(sample + 1, count);
    }
    Ok(costs)
}
