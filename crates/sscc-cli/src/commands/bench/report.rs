//! What a scenario reports of one model: the keys that scripts rely on.

use serde::{Serialize, Serializer};

use super::measure::Measured;
use super::strata::Counts;
use sscc_sim::{CertifiedModel, STEP_PARTS, machine_description};

/// One line of JSON. Times are means over the whole scene, estimated from steps that count by the shares of their strata;
/// where comparators were not asked all steps, those that they were asked count for every method, so that ratios are of
/// the same steps.
#[derive(Serialize)]
pub struct Report {
    /// With the model, where the scenario has several.
    pub scenario: String,
    pub model: String,
    /// The mesh.
    pub source: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The largest displacement in percent of half the diagonal of the box.
    pub share: f64,
    pub triangles: usize,
    pub rank: usize,
    pub objects: usize,
    pub steps: usize,
    pub colliding_steps: usize,
    pub root_failed_steps: usize,
    pub compared_steps: usize,
    pub compared_root_failed_steps: usize,
    pub continuous_steps: usize,
    pub scene_steps: usize,
    pub scene_colliding_steps: usize,
    pub scene_body_steps: usize,
    pub scene_colliding_body_steps: usize,
    pub mismatches: usize,
    pub certify_seconds: f64,
    pub certify_threads: usize,
    pub certify_peak_bytes: Option<u64>,
    /// One discrete query of one body.
    pub parry_query_seconds: Option<f64>,
    /// How many steps of each stratum the scene has, and how many of them are compared.
    #[serde(skip)]
    pub strata: [Counts; 2],
    /// Processor time of the whole scene; none where nothing is simulated. It looks for self-collisions as its file says.
    pub simulation_seconds: Option<f64>,
    pub self_collision_share: Option<f64>,
    /// What it would take with the traditional method, over what it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation_speedup: Option<f64>,
    /// Mean milliseconds of the processor of the parts of a step, over the whole scene.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub simulation_ms: Means,
    pub discrete_ms: Means,
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub continuous_ms: Means,
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub discrete_ms_root_failed: Means,
    /// Of the methods that were asked all steps, where others were not.
    #[serde(skip_serializing_if = "Means::is_empty")]
    pub discrete_ms_all_steps: Means,
    pub machine: String,
}

/// What collides in a whole scene.
pub struct Whole {
    pub steps: usize,
    pub colliding_steps: usize,
    pub body_steps: usize,
    pub colliding_body_steps: usize,
    /// What the parts of its simulation took.
    pub seconds: Option<[f64; STEP_PARTS.len()]>,
}

/// A value for each column.
pub struct Means<T = f64>(pub Vec<(&'static str, T)>);

impl<T: Copy> Means<T> {
    pub fn get(&self, key: &str) -> Option<T> {
        self.0.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<T: Serialize> Serialize for Means<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl Report {
    /// `whole` is the scene; if not given, the steps are all there is.
    pub fn new(
        scenario: String,
        share: f64,
        case: &CertifiedModel,
        measured: &Measured,
        objects: usize,
        whole: Option<Whole>,
    ) -> Self {
        let count = |flags: &[bool]| flags.iter().filter(|flag| **flag).count();
        let (steps, colliding_steps) = (measured.colliding.len(), count(&measured.colliding));
        let whole = whole.unwrap_or(Whole {
            steps,
            colliding_steps,
            body_steps: steps * objects,
            colliding_body_steps: colliding_steps,
            seconds: None,
        });
        let seconds = whole.seconds.unwrap_or_default();
        let simulation_seconds = whole.seconds.map(|parts| parts.iter().sum::<f64>());
        let of_step = |seconds: f64| seconds * 1e3 / whole.steps as f64;
        let simulation_ms = match whole.seconds {
            Some(parts) => {
                STEP_PARTS.iter().zip(parts).map(|(part, seconds)| (*part, of_step(seconds))).collect()
            }
            None => Vec::new(),
        };
        let Measured { discrete, continuous, strata, .. } = measured;
        let (compared, all): (&[usize], Vec<usize>) = (&discrete.compared, (0..steps).collect());
        let root_failed: Vec<usize> =
            compared.iter().copied().filter(|step| measured.root_failed[*step]).collect();
        let everywhere = if compared.len() < steps { discrete.means(&all, strata) } else { Vec::new() };
        let discrete_ms = Means(discrete.means(compared, strata));
        Self {
            scenario,
            model: case.name.clone(),
            source: case.source.clone(),
            note: notes(case.note.clone(), strata.missing()),
            share,
            triangles: case.model.mesh().faces().len(),
            rank: case.model.rank(),
            objects,
            steps,
            colliding_steps,
            root_failed_steps: count(&measured.root_failed),
            compared_steps: compared.len(),
            compared_root_failed_steps: root_failed.len(),
            continuous_steps: continuous.compared.len(),
            strata: [strata.scene(), strata.counts(compared)],
            scene_steps: whole.steps,
            scene_colliding_steps: whole.colliding_steps,
            scene_body_steps: whole.body_steps,
            scene_colliding_body_steps: whole.colliding_body_steps,
            mismatches: measured.mismatches,
            certify_seconds: case.full.cost.seconds,
            certify_threads: case.full.cost.threads,
            certify_peak_bytes: case.full.cost.peak_bytes,
            parry_query_seconds: discrete_ms.get("parry").map(|ms| ms / 1e3 / objects as f64),
            simulation_seconds,
            self_collision_share: simulation_seconds.map(|all| seconds[0] / all),
            simulation_speedup: simulation_seconds.and_then(|all| {
                let traditional = discrete_ms.get("traditional")?;
                Some((of_step(all - seconds[0]) + traditional) / of_step(all))
            }),
            simulation_ms: Means(simulation_ms),
            discrete_ms,
            continuous_ms: Means(continuous.means(&continuous.compared, strata)),
            discrete_ms_root_failed: Means(discrete.means(&root_failed, strata)),
            discrete_ms_all_steps: Means(everywhere),
            machine: machine_description(),
        }
    }
}

/// Both notes, if there are any.
fn notes(first: Option<String>, second: Option<String>) -> Option<String> {
    let notes: Vec<String> = first.into_iter().chain(second).collect();
    (!notes.is_empty()).then(|| notes.join("; "))
}
