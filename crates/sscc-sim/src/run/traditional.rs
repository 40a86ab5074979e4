//! Measures the traditional method at some states of a simulation, for comparison.

use cpu_time::ThreadTime;
use sscc::{Method, Query};
use sscc_tasks::{Stage, Watch, check_cancelled};

use super::history::History;
use super::prepared::PreparedScene;
use crate::error::Result;
use crate::scenes::Scene;

/// Maximum number of measured states, evenly spread.
const MAX_STATES: usize = 100;

/// Maximum product of the numbers of measured states and bodies; at least one state is measured.
const MAX_BODY_STATES: usize = 2000;

/// The processor time of the traditional method at one state, on one thread.
#[derive(Clone, Copy, Debug)]
pub struct TraditionalCost {
    /// The state.
    pub state: usize,
    /// Time for all bodies (s).
    pub seconds: f64,
    /// Time for the bodies that are awake (s). Simulations test only these.
    pub awake_seconds: f64,
}

/// Measures the traditional method at some states, evenly spread, on this thread.
pub fn traditional_costs(
    scene: &Scene,
    prepared: &PreparedScene,
    history: &History,
    watch: &dyn Watch,
) -> Result<Vec<TraditionalCost>> {
    let mut queries: Vec<Query> = Vec::new();
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
        let bodies = scene.bodies.iter().zip(history.bodies(state)).enumerate();
        let (awake, asleep): (Vec<_>, Vec<_>) = bodies.partition(|(n, _)| history.moves(state, *n));
        let mut seconds = [0.0; 2];
        for (seconds, bodies) in seconds.iter_mut().zip([awake, asleep]).filter(|(_, all)| !all.is_empty()) {
            let start = ThreadTime::now();
            for (_, (body, record)) in bodies {
                queries[body.model].discrete(record.q)?;
            }
            *seconds = start.elapsed().as_secs_f64();
        }
        let [awake_seconds, asleep_seconds] = seconds;
        costs.push(TraditionalCost { state, seconds: awake_seconds + asleep_seconds, awake_seconds });
        watch.report(sample + 1, count);
    }
    Ok(costs)
}
