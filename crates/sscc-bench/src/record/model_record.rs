//! The record of one model in a scenario. Scripts rely on its keys.

use serde::Serialize;
use sscc_sim::STEP_PARTS;
use sscc_tasks::CertifiedModel;

use super::means::Means;
use crate::measure::Comparison;
use crate::sampling::Counts;

/// Record of one model: one line of JSON. Times are means over the whole scene, estimated from steps weighted by the
/// shares of their strata. If comparators did not run on all steps, the times of every method are those of the steps on
/// which they ran, so that ratios compare the same steps.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// Name of the scenario, with the model if the scenario has several.
    pub scenario: String,
    /// The name of the model.
    pub model: String,
    /// Origin of its mesh.
    pub source: String,
    /// Note on a replaced model or on missing strata.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Whether another shape replaces the shape of the scenario: under `--quick`, or without its file.
    #[serde(skip)]
    pub is_substitute: bool,
    /// The largest displacement in percent of half the diagonal of the AABB.
    pub share: f64,
    /// The largest `|z|` over the root's radius, in scenarios that scale motions by it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times_root: Option<f64>,
    /// Mean share of the triangles for each kind of proof, in free states, where it was measured.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub proven_shares: Means,
    /// Triangles of one body.
    pub triangles: usize,
    /// Modes of one body.
    pub rank: usize,
    /// Number of bodies.
    pub objects: usize,
    /// Steps that were measured.
    pub steps: usize,
    /// Measured steps in which some body collides with itself.
    pub colliding_steps: usize,
    /// Measured steps in which some body's root certificate fails.
    pub root_failed_steps: usize,
    /// Measured steps on which all methods ran.
    pub compared_steps: usize,
    /// Compared steps in which some body's root certificate fails.
    pub compared_root_failed_steps: usize,
    /// Steps with continuous queries.
    pub continuous_steps: usize,
    /// Steps of the whole scene.
    pub scene_steps: usize,
    /// Steps of the whole scene in which some body collides with itself.
    pub scene_colliding_steps: usize,
    /// Steps of the whole scene times bodies.
    pub scene_body_steps: usize,
    /// Pairs of a step and a body, in the whole scene, in which the body collides with itself.
    pub scene_colliding_body_steps: usize,
    /// Steps in which two exact methods differ.
    pub mismatches: usize,
    /// Wall-clock seconds of the certificates.
    pub certify_seconds: f64,
    /// Number of threads that computed the certificates.
    pub certify_threads: usize,
    /// Peak memory of the process during the computation of certificates (bytes).
    pub certify_peak_bytes: Option<u64>,
    /// Seconds of one discrete query of one body by parry.
    pub parry_query_seconds: Option<f64>,
    /// Steps of each stratum in the scene, and among the compared steps.
    #[serde(skip)]
    pub strata: [Counts; 2],
    /// Processor time of the whole scene (s) with the method of detection in its file; None without a simulation.
    pub simulation_seconds: Option<f64>,
    /// Share of self-collision detection in this time.
    pub self_collision_share: Option<f64>,
    /// Time with the traditional method over the measured time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation_speedup: Option<f64>,
    /// Mean processor time of the parts of a step over the whole scene (ms).
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub simulation_ms: Means,
    /// Mean milliseconds of discrete queries over the compared steps.
    pub discrete_ms: Means,
    /// Mean milliseconds of continuous queries.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub continuous_ms: Means,
    /// Mean milliseconds of discrete queries in the compared steps in which the root certificate fails.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub discrete_ms_root_failed: Means,
    /// Mean milliseconds of discrete queries over the steps that are free, of the methods that ran on all of them.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub free_ms: Means,
    /// Median milliseconds of discrete queries over the free steps, of the methods that ran on all of them.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub free_ms_median: Means,
    /// Mean milliseconds of discrete queries over the colliding steps, of the methods that ran on all of them.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub colliding_ms: Means,
    /// Median milliseconds of discrete queries over the colliding steps, of the methods that ran on all of them.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub colliding_ms_median: Means,
    /// Mean milliseconds of discrete queries over all measured steps, of the methods that ran on all of them; empty if
    /// all methods did.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub discrete_ms_all_steps: Means,
    /// Description of the machine.
    pub machine: String,
}

/// Totals of the whole scene that the measured steps represent.
pub struct SceneTotals {
    /// Number of steps.
    pub steps: usize,
    /// Number of steps in which some body collides with itself.
    pub colliding_steps: usize,
    /// Number of steps times bodies.
    pub body_steps: usize,
    /// Pairs of a step and a body in which the body collides with itself.
    pub colliding_body_steps: usize,
    /// Processor seconds of the parts of the scene's simulation; None without a simulation.
    pub seconds: Option<[f64; STEP_PARTS.len()]>,
}

impl Record {
    /// Creates the record of `objects` bodies of one model. `scene` has the totals of the whole scene; None if the
    /// measured steps are the whole scene, with one body.
    pub fn new(
        scenario: String,
        share: f64,
        model: &CertifiedModel,
        comparison: &Comparison,
        objects: usize,
        scene: Option<SceneTotals>,
    ) -> Self {
        let count = |flags: &[bool]| flags.iter().filter(|flag| **flag).count();
        let (steps, colliding_steps) = (comparison.colliding.len(), count(&comparison.colliding));
        let scene = scene.unwrap_or(SceneTotals {
            steps,
            colliding_steps,
            body_steps: steps * objects,
            colliding_body_steps: colliding_steps,
            seconds: None,
        });
        let seconds = scene.seconds.unwrap_or_default();
        let simulation_seconds = scene.seconds.map(|parts| parts.iter().sum::<f64>());
        let per_step = |seconds: f64| seconds * 1e3 / scene.steps as f64;
        let simulation_ms = match scene.seconds {
            Some(parts) => {
                STEP_PARTS.iter().zip(parts).map(|(part, seconds)| (*part, per_step(seconds))).collect()
            }
            None => Vec::new(),
        };
        let Comparison { discrete, continuous, strata, .. } = comparison;
        let (compared, all): (&[usize], Vec<usize>) = (&discrete.compared, (0..steps).collect());
        let root_failed: Vec<usize> =
            compared.iter().copied().filter(|step| comparison.root_failed[*step]).collect();
        let all_steps = if compared.len() < steps { discrete.means(&all, strata) } else { Vec::new() };
        let [free, colliding] = [false, true].map(|collides| -> Vec<usize> {
            all.iter().copied().filter(|step| comparison.colliding[*step] == collides).collect()
        });
        let discrete_ms = Means(discrete.means(compared, strata));
        Self {
            scenario,
            model: model.name.clone(),
            source: model.source.clone(),
            is_substitute: model.note.is_some(),
            note: notes(model.note.clone(), strata.missing()),
            share,
            times_root: None,
            proven_shares: Means(Vec::new()),
            triangles: model.model.mesh().faces().len(),
            rank: model.model.rank(),
            objects,
            steps,
            colliding_steps,
            root_failed_steps: count(&comparison.root_failed),
            compared_steps: compared.len(),
            compared_root_failed_steps: root_failed.len(),
            continuous_steps: continuous.compared.len(),
            strata: [strata.scene(), strata.counts(compared)],
            scene_steps: scene.steps,
            scene_colliding_steps: scene.colliding_steps,
            scene_body_steps: scene.body_steps,
            scene_colliding_body_steps: scene.colliding_body_steps,
            mismatches: comparison.mismatches,
            certify_seconds: model.full.cost.seconds,
            certify_threads: model.full.cost.threads,
            certify_peak_bytes: model.full.cost.peak_bytes,
            parry_query_seconds: discrete_ms.get("parry").map(|ms| ms / 1e3 / objects as f64),
            simulation_seconds,
            self_collision_share: simulation_seconds.map(|all| seconds[0] / all),
            simulation_speedup: simulation_seconds.and_then(|all| {
                let traditional = discrete_ms.get("traditional")?;
                Some((per_step(all - seconds[0]) + traditional) / per_step(all))
            }),
            simulation_ms: Means(simulation_ms),
            discrete_ms,
            continuous_ms: Means(continuous.means(&continuous.compared, strata)),
            discrete_ms_root_failed: Means(discrete.means(&root_failed, strata)),
            free_ms: Means(discrete.means(&free, strata)),
            free_ms_median: Means(discrete.medians(&free, strata)),
            colliding_ms: Means(discrete.means(&colliding, strata)),
            colliding_ms_median: Means(discrete.medians(&colliding, strata)),
            discrete_ms_all_steps: Means(all_steps),
            machine: sscc_tasks::machine_description(),
        }
    }
}

/// Joins two notes.
fn notes(first: Option<String>, second: Option<String>) -> Option<String> {
    let notes: Vec<String> = first.into_iter().chain(second).collect();
    (!notes.is_empty()).then(|| notes.join("; "))
}
