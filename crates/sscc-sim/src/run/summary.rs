//! Results of a simulation as numbers: the keys of `sscc simulate --json`, and lines of text.

use serde::Serialize;
use sscc_tasks::machine_description;
use sscc_tasks::text::{counted, grouped};

use super::history::History;
use super::prepared::PreparedScene;
use crate::scenes::Scene;

/// The result as JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Its models.
    pub models: Vec<ModelSummary>,
    /// Number of bodies.
    pub objects: usize,
    /// Number of steps that were simulated.
    pub steps: usize,
    /// Number of steps of the scene.
    pub scene_steps: usize,
    /// Simulated seconds of a step.
    pub step: f64,
    /// Simulated seconds of all steps.
    pub simulated_seconds: f64,
    /// Processor time of all steps (s).
    pub simulation_seconds: f64,
    /// Simulated seconds per second of wall-clock time.
    pub real_time_factor: f64,
    /// Simulated seconds per second of processor time, if one thread simulated all steps.
    pub real_time_factor_processor: Option<f64>,
    /// Number of steps in which some body collides with itself.
    pub colliding_steps: usize,
    /// Number of steps times number of bodies.
    pub body_steps: usize,
    /// Number of steps, over all bodies, in which the body collides with itself.
    pub colliding_body_steps: usize,
    /// Number of colliding triangle pairs within bodies in the last state.
    pub last_self_pairs: usize,
    /// Number of colliding triangle pairs between bodies in the last state.
    pub last_inter_pairs: usize,
    /// Number of bodies that sleep in the last state.
    pub last_asleep: usize,
    /// Share of self-collision detection in the processor time.
    pub self_collision_share: f64,
    /// Kinetic, elastic and potential energy of the first state (J).
    pub energy_first: f64,
    /// The largest energy of a state (J).
    pub energy_largest: f64,
    /// The energy of the last state for which it was computed (J).
    pub energy_last: f64,
    /// The machine's description.
    pub machine: String,
}

/// One model of the scene.
#[derive(Clone, Debug, Serialize)]
pub struct ModelSummary {
    /// Its name in the scene.
    pub name: String,
    /// Origin of its shape.
    pub source: String,
    /// A note, for example on an embedded shape in place of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of modes.
    pub rank: usize,
    /// The certified radius of the root.
    pub root_radius: f64,
}

impl Summary {
    /// Sums up all states. `processor_seconds` is the processor time of the thread that simulated all of them.
    pub(crate) fn new(
        scene: &Scene,
        prepared: &PreparedScene,
        history: &History,
        processor_seconds: Option<f64>,
    ) -> Self {
        let steps = history.len();
        let colliding: Vec<usize> = (0..steps).map(|state| history.colliding_bodies(state)).collect();
        let records = || (0..steps).map(|state| history.step(state));
        let seconds: f64 = records().map(|record| record.total_seconds()).sum();
        let wall: f64 = records().map(|record| record.wall).sum();
        let own: f64 = records().map(|record| record.self_seconds()).sum();
        let energies =
            || (0..steps).map(|state| history.step(state).energy).filter(|energy| energy.is_finite());
        let models = prepared.models.iter().map(|model| ModelSummary {
            name: model.certified.name.clone(),
            source: model.certified.source.clone(),
            note: model.certified.note.clone(),
            triangles: model.certified.model.mesh().faces().len(),
            rank: model.certified.model.rank(),
            root_radius: model.certified.full.certificates.root_radius(),
        });
        Self {
            scene: scene.name.clone(),
            models: models.collect(),
            objects: scene.bodies.len(),
            steps,
            scene_steps: scene.steps,
            step: scene.step,
            simulated_seconds: steps as f64 * scene.step,
            simulation_seconds: seconds,
            real_time_factor: steps as f64 * scene.step / wall,
            // The factor is unknown for several bodies, which are tested on several threads.
            real_time_factor_processor: processor_seconds
                .filter(|_| scene.bodies.len() == 1)
                .map(|seconds| steps as f64 * scene.step / seconds),
            colliding_steps: colliding.iter().filter(|bodies| **bodies > 0).count(),
            body_steps: steps * scene.bodies.len(),
            colliding_body_steps: colliding.iter().sum(),
            last_self_pairs: steps.checked_sub(1).map_or(0, |last| history.self_pairs(last)),
            last_inter_pairs: steps.checked_sub(1).map_or(0, |last| history.step(last).inter_pairs),
            last_asleep: steps.checked_sub(1).map_or(0, |last| history.step(last).asleep),
            self_collision_share: own / seconds,
            energy_first: energies().next().unwrap_or_default(),
            energy_largest: energies().fold(f64::NEG_INFINITY, f64::max),
            energy_last: energies().next_back().unwrap_or_default(),
            machine: machine_description(),
        }
    }

    /// Returns the object that `sscc simulate --json` prints.
    pub fn to_json(&self) -> String {
        // Numbers that are not finite become null.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Returns the results as lines of text.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for model in &self.models {
            lines.push(format!("{}: {}", model.name, model.line()));
            lines.extend(model.note.iter().map(|note| format!("note: {note}")));
        }
        lines.push(format!("{}: {}", self.scene, self.motion()));
        lines.push(format!("self-contact in {}", self.contact()));
        lines.push(format!("at the end {}", self.end()));
        lines.push(format!("detecting self-collisions took {}", self.share()));
        lines
    }

    /// Returns the results as rows of a table, with the machine.
    pub fn table(&self) -> Vec<(String, String)> {
        let row = |label: &str, value: String| (label.to_owned(), value);
        let mut rows = Vec::new();
        for model in &self.models {
            rows.push(row(&model.name, model.line()));
            rows.extend(model.note.iter().map(|note| row("note", note.clone())));
        }
        rows.push(row("motion", self.motion()));
        rows.push(row("self-contact", format!("in {}", self.contact())));
        rows.push(row("at the end", self.end()));
        rows.push(row("detecting self-collisions", self.share()));
        rows.push(row("machine", self.machine.clone()));
        rows
    }

    fn motion(&self) -> String {
        format!(
            "{}, {}, {} s, simulated in {:.2} s of the processor ({:.2} times real time{})",
            if self.objects == 1 { "one body".into() } else { format!("{} bodies", self.objects) },
            counted(self.steps as u64, "step"),
            self.simulated_seconds,
            self.simulation_seconds,
            self.real_time_factor,
            self.real_time_factor_processor
                .map_or(String::new(), |factor| format!(", {factor:.2} on one core"))
        )
    }

    fn contact(&self) -> String {
        let share = |part: usize, all: usize| 100.0 * part as f64 / all.max(1) as f64;
        format!(
            "{} of {} steps ({:.1}%); {:.1}% of the steps of single bodies",
            grouped(self.colliding_steps as u64),
            grouped(self.steps as u64),
            share(self.colliding_steps, self.steps),
            share(self.colliding_body_steps, self.body_steps)
        )
    }

    fn end(&self) -> String {
        format!(
            "{} of triangles within bodies and {} between them; {} of {} bodies asleep",
            counted(self.last_self_pairs as u64, "colliding pair"),
            self.last_inter_pairs,
            self.last_asleep,
            self.objects
        )
    }

    fn share(&self) -> String {
        format!("{:.1}% of the time", 100.0 * self.self_collision_share)
    }
}

impl ModelSummary {
    fn line(&self) -> String {
        format!("{} triangles, {} modes ({})", grouped(self.triangles as u64), self.rank, self.source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::history::{StateLayout, StepRecord};
    use crate::scenes::SHIPPED;

    #[test]
    fn costs_are_processor_time_and_the_real_time_factor_is_by_the_wall() {
        let (name, text) = SHIPPED[0];
        let scene = Scene::parse(name.as_ref(), text).unwrap();
        let (layout, mut numbers) = (StateLayout::new([]), Vec::new());
        let facts =
            StepRecord { seconds: [1e-3, 2e-3, 0.0, 0.0, 5e-3, 0.0], wall: 0.1, ..StepRecord::default() };
        (0..4).for_each(|_| layout.push(facts, [], &mut numbers));
        let prepared = PreparedScene { models: Vec::new(), program: String::new() };
        let summary = Summary::new(&scene, &prepared, &History::new(layout, numbers), None);
        assert!((summary.simulation_seconds - 4.0 * 8e-3).abs() < 1e-12);
        assert!((summary.self_collision_share - 1.0 / 8.0).abs() < 1e-12);
        assert!((summary.real_time_factor - scene.step / 0.1).abs() < 1e-12 * summary.real_time_factor);
    }
}
