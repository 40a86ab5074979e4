//! The report of a simulation: the page with its motion, one HTML file that needs no other.

use anyhow::{Context, Result};
use sscc_view::{Arrays, Axis, ModelDetails, ModelScene, Plot, Report, Scene as View, Series};

use super::history::History;
use super::playback::playback;
use super::plot::thinned;
use super::prepared::Prepared;
use super::summary::Summary;
use crate::frequencies;
use crate::scene::Scene;

/// Points of a line at most.
const POINTS: usize = 700;

/// What a page tells of.
pub struct Page<'a> {
    pub scene: &'a Scene,
    pub prepared: &'a Prepared,
    pub history: &'a History,
    pub summary: &'a Summary,
    /// States at which the traditional method was asked, and seconds for all bodies.
    pub traditional: Vec<(usize, f64)>,
    /// Why the simulation ended early, if it did.
    pub failure: Option<String>,
}

impl Page<'_> {
    pub fn html(&self) -> Result<String> {
        let mut arrays = Arrays::default();
        let mut view = View::new(&self.scene.name);
        for (index, model) in self.prepared.models.iter().enumerate() {
            let case = &model.case;
            let details = ModelDetails {
                frequencies: frequencies::of_modes(&case.elasticity),
                ..ModelDetails::default()
            };
            let certificates = &case.full.certificates;
            let made = ModelScene::new(index, &case.name, &case.model, certificates, details, &mut arrays);
            view.models.push(made.with_context(|| case.name.clone())?);
        }
        let failure = self.failure.iter().map(|failure| ("stopped early".to_owned(), failure.clone()));
        view.summary = failure.chain(self.summary.table()).collect();
        view.plots.push(self.energy());
        if self.scene.sound.is_some() {
            view.plots.push(self.sound());
        }
        let (playback, notes) = playback(self, &mut arrays)?;
        view.playback = playback;
        view.summary.extend(notes.into_iter().map(|note| ("note".to_owned(), note)));
        Ok(Report { scene: view, arrays }.html()?)
    }

    pub(super) fn time(&self, state: usize) -> f64 {
        state as f64 * self.scene.step
    }

    /// The sound, and its samples in a second.
    pub(super) fn samples(&self) -> (Vec<f64>, u32) {
        let samples = (0..self.history.len()).map(|state| self.history.facts(state).sound).collect();
        (samples, (1.0 / self.scene.step).round() as u32)
    }

    /// A value of each state.
    fn line(&self, of: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
        (0..self.history.len()).map(|state| [self.time(state), of(state)]).collect()
    }

    /// What each step took to find the triangles in which bodies collide with themselves, in the manner of the
    /// paper's Figure 12. The certified method is timed within the simulation (the slowest of each stretch of
    /// steps), the traditional one, without certificates, at some of its states.
    pub(super) fn costs(&self) -> Plot {
        let own = self.line(|state| 1e3 * self.history.facts(state).own());
        let of = |(state, seconds): &(usize, f64)| [self.time(*state), 1e3 * seconds];
        Plot {
            title: "Cost over time".into(),
            x: time(),
            y: Axis::logarithmic("self-collisions, ms in a step"),
            series: vec![
                Series::new("traditional", self.traditional.iter().map(of)),
                Series::new("certified", thinned(&own, POINTS, f64::max)),
            ],
        }
    }

    fn energy(&self) -> Plot {
        let mut points = self.line(|state| self.history.facts(state).energy);
        points.retain(|point| point[1].is_finite());
        Plot {
            title: "Energy".into(),
            x: time(),
            y: Axis::linear("kinetic, elastic and potential (J)"),
            series: vec![Series::new("all bodies", thinned(&points, POINTS, f64::max))],
        }
    }

    fn sound(&self) -> Plot {
        let points = self.line(|state| self.history.facts(state).sound);
        let line = |name, pick| Series::new(name, thinned(&points, POINTS, pick));
        Plot {
            title: "Sound".into(),
            x: time(),
            y: Axis::linear("sample"),
            series: vec![line("largest", f64::max as fn(f64, f64) -> f64), line("least", f64::min)],
        }
    }
}

fn time() -> Axis {
    Axis::linear("time (s)")
}
