//! The report of a simulation: one HTML file that needs no other.

use std::fmt::Write;

use super::history::History;
use super::plot::{Line, Plot, escaped, thinned};
use super::prepared::Prepared;
use super::summary::Summary;
use crate::scene::Scene;

/// Points of a line at most.
const POINTS: usize = 700;

const OURS: &str = "#2a8a3e";
const THEIRS: &str = "#c0392b";
const BLUE: &str = "#0b6bb8";
const GREY: &str = "#777";

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
    pub fn html(&self) -> String {
        let mut body = format!("<h1>{}</h1>\n", escaped(&self.scene.name));
        // Writing to a String never fails.
        if let Some(failure) = &self.failure {
            let _ = writeln!(body, "<p class=\"failure\">Stopped early: {}</p>", escaped(failure));
        }
        for line in self.summary.lines() {
            let _ = writeln!(body, "<p>{}</p>", escaped(&line));
        }
        let mut section = |title: &str, about: &str, svg: String| {
            let _ = writeln!(body, "<h2>{title}</h2>\n<p>{about}</p>\n{svg}");
        };
        section(
            "Cost over time",
            "What each step took to find the triangles in which bodies collide with themselves, in the manner of the paper's Figure \
             12. The certified method is timed within the simulation (the slowest of each stretch of steps), the traditional one, \
             without certificates, at some of its states.",
            self.costs(),
        );
        section(
            "Radius per level",
            "The median radius of each level of the hierarchies, the root's first, as in the paper's Figure 7: shapes whose q is \
             shorter are proven free of self-collisions within such a part.",
            self.radii(),
        );
        section("Energy", "Kinetic, elastic and potential energy of all bodies.", self.energy());
        if self.scene.sound.is_some() {
            section("Sound", "The loudest samples of each stretch.", self.sound());
        }
        let _ = writeln!(body, "<p class=\"small\">{}</p>", escaped(&self.summary.machine));
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width\">\n<title>{} - sscc simulate</title>\n<style>body{{font:16px/1.5 \
             sans-serif;max-width:900px;margin:2em auto;padding:0 1em}}svg{{width:100%}}p{{margin:.4em 0}}.failure{{color:#c0392b}}\
             .small{{color:#777;font-size:13px}}</style>\n{body}</html>\n",
            escaped(&self.scene.name)
        )
    }

    fn time(&self, state: usize) -> f64 {
        state as f64 * self.scene.step
    }

    /// A value of each state.
    fn line(&self, of: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
        (0..self.history.len()).map(|state| [self.time(state), of(state)]).collect()
    }

    fn costs(&self) -> String {
        let own = self.line(|state| 1e3 * self.history.facts(state).own());
        let traditional =
            self.traditional.iter().map(|(state, seconds)| [self.time(*state), 1e3 * seconds]).collect();
        let plot = Plot {
            title: "Cost over time",
            x_label: "time (s)",
            y_label: "ms in a step",
            lines: vec![
                Line { label: "traditional", color: THEIRS, points: traditional, dots: true },
                Line {
                    label: "certified",
                    color: OURS,
                    points: thinned(&own, POINTS, f64::max),
                    dots: false,
                },
            ],
            marks: self.contacts(),
            marks_label: "self-contact",
            logarithmic: true,
        };
        plot.svg()
    }

    /// Stretches of time in which some body collides with itself.
    fn contacts(&self) -> Vec<[f64; 2]> {
        let mut marks: Vec<[f64; 2]> = Vec::new();
        let gap = self.time(self.history.len()) / POINTS as f64;
        for state in (0..self.history.len()).filter(|state| self.history.colliding(*state) > 0) {
            let [from, to] = [self.time(state), self.time(state + 1)];
            match marks.last_mut() {
                Some(last) if from - last[1] <= gap => last[1] = to,
                _ => marks.push([from, to]),
            }
        }
        marks
    }

    fn radii(&self) -> String {
        let colors = [BLUE, OURS, THEIRS, GREY];
        let lines = self.prepared.models.iter().zip(colors.iter().cycle()).map(|(model, color)| {
            let parts = model.case.full.certificates.parts();
            let median = |level: std::ops::Range<usize>| {
                let mut radii = parts.node_radii[level].to_vec();
                radii.sort_by(f64::total_cmp);
                radii[radii.len() / 2]
            };
            let levels = parts.hierarchy.levels().into_iter().enumerate();
            let points = levels.map(|(level, nodes)| [level as f64, median(nodes)]).collect();
            Line { label: &model.case.name, color, points, dots: true }
        });
        let plot = Plot {
            title: "Radius per level",
            x_label: "level of the hierarchy",
            y_label: "median radius",
            lines: lines.collect(),
            marks: Vec::new(),
            marks_label: "",
            logarithmic: true,
        };
        plot.svg()
    }

    fn energy(&self) -> String {
        let mut points = self.line(|state| self.history.facts(state).energy);
        points.retain(|point| point[1].is_finite());
        let plot = Plot {
            title: "Energy",
            x_label: "time (s)",
            y_label: "energy (J)",
            lines: vec![Line {
                label: "all bodies",
                color: BLUE,
                points: thinned(&points, POINTS, f64::max),
                dots: false,
            }],
            marks: self.contacts(),
            marks_label: "self-contact",
            logarithmic: false,
        };
        plot.svg()
    }

    fn sound(&self) -> String {
        let points = self.line(|state| self.history.facts(state).sound);
        let line =
            |label, pick| Line { label, color: BLUE, points: thinned(&points, POINTS, pick), dots: false };
        let plot = Plot {
            title: "Sound",
            x_label: "time (s)",
            y_label: "sample",
            lines: vec![line("largest", f64::max as fn(f64, f64) -> f64), line("least", f64::min)],
            marks: self.contacts(),
            marks_label: "self-contact",
            logarithmic: false,
        };
        plot.svg()
    }
}
