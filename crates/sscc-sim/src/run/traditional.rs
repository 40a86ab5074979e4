//! The cost of the traditional method at some states of a simulation, for comparison.

use cpu_time::ThreadTime;
use sscc::{Method, Query};

use super::history::History;
use super::prepared::PreparedScene;
use crate::error::Result;
use crate::scenes::Scene;
use crate::watch::{Stage, Watch, check_cancelled};

/// States at most, evenly spread.
const STATES: usize = 100;

/// Bodies in all of these states at most.
const BODIES: usize = 2000;

/// Some states, evenly spread, and for each the processor time (s) of the traditional method for all bodies, on this
/// thread.
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
    let count = STATES.min(BODIES / scene.bodies.len()).clamp(1, history.len());
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
