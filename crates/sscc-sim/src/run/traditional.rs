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

/// The processor time of the traditional method at one state, on one thread.
#[derive(Clone, Copy, Debug)]
pub struct TraditionalCost {
    /// The state.
    pub state: usize,
    /// For all bodies (s).
    pub seconds: f64,
    /// For those that are awake (s): simulations test no others.
    pub awake_seconds: f64,
}

/// Measures the traditional method at some states, evenly spread, on this thread.
pub fn traditional_costs(
    scene: &Scene,
    prepared: &PreparedScene,
    history: &History,
    watch: &dyn Watch,
) -> Result<Vec<TraditionalCost>> {
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
        // Those awake first, then the others.
        let mut seconds = [0.0; 2];
        for (seconds, is_awake) in seconds.iter_mut().zip([true, false]) {
            let start = ThreadTime::now();
            for (n, (body, record)) in scene.bodies.iter().zip(history.bodies(state)).enumerate() {
                if history.moves(state, n) == is_awake {
                    queries[body.model].discrete(record.q)?;
                }
            }
            *seconds = start.elapsed().as_secs_f64();
        }
        let [awake_seconds, asleep_seconds] = seconds;
        costs.push(TraditionalCost { state, seconds: awake_seconds + asleep_seconds, awake_seconds });
        watch.report(sample + 1, count);
    }
    Ok(costs)
}
