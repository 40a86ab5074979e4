//! `--report`: what was measured, on the page.

use std::cell::RefCell;
use std::path::Path;

use anyhow::Result;
use sscc_io::write_whole;
use sscc_view::{Arrays, Axis, Plot, Report as Page, Scene, Series};

use super::measure::Times;
use super::report::{Means, Report};
use crate::output::duration;
use sscc_sim::machine_description;

/// What is told of each report.
#[derive(Default)]
pub struct Rows {
    rows: RefCell<Vec<Row>>,
    costs: RefCell<Vec<Plot>>,
}

struct Row {
    scenario: String,
    share: f64,
    triangles: usize,
    milliseconds: Vec<(&'static str, f64)>,
}

impl Rows {
    pub fn add(&self, report: &Report) {
        let Report { scenario, share, triangles, discrete_ms: Means(milliseconds), .. } = report;
        self.rows.borrow_mut().push(Row {
            scenario: scenario.clone(),
            share: *share,
            triangles: *triangles,
            milliseconds: milliseconds.clone(),
        });
    }

    /// Adds what each step of a scene took, in the manner of the paper's Figure 12; `seconds` is when a step was.
    pub fn add_costs(&self, scenario: &str, times: &Times, seconds: impl Fn(usize) -> f64) {
        let shown = ["traditional", "full", "kinetic"].map(|key| (key, times.of(key)));
        let line = |(key, times): (&str, Vec<(usize, f64)>)| {
            Series::new(key, times.into_iter().map(|(step, ms)| [seconds(step), ms]))
        };
        self.costs.borrow_mut().push(Plot {
            title: format!("Cost over time: {scenario}"),
            x: Axis::linear("time (s)"),
            y: Axis::logarithmic("discrete query, ms in a step"),
            series: shown.into_iter().filter(|(_, times)| !times.is_empty()).map(line).collect(),
        });
    }

    /// Writes all that was added.
    pub fn write(&self, path: &Path, title: &str) -> Result<()> {
        let rows = self.rows.borrow();
        let mut scene = Scene::new(format!("sscc bench {title}"));
        scene.summary = rows.iter().map(Row::line).collect();
        scene.summary.push(("machine".into(), machine_description()));
        scene.plots.extend(self.costs.borrow().iter().cloned());
        // A model over how far it is displaced; ...
        for group in rows.chunk_by(|a, b| a.scenario == b.scenario).filter(|group| group.len() > 1) {
            let x = Axis::logarithmic("largest displacement, % of half the box's diagonal");
            scene.plots.push(plot(&group[0].scenario, x, group, |row| row.share));
        }
        // ... one shape in several sizes.
        if title == "growth" && rows.len() > 1 {
            let x = Axis::logarithmic("triangles");
            scene.plots.push(plot(title, x, &rows, |row| row.triangles as f64));
        }
        write_whole(path, Page { scene, arrays: Arrays::default() }.html()?.as_bytes())?;
        Ok(())
    }
}

impl Row {
    fn get(&self, key: &str) -> Option<f64> {
        self.milliseconds.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }

    /// Both methods of the paper, and their ratio.
    fn line(&self) -> (String, String) {
        let label = format!("{}, displaced by {:.1}%", self.scenario, self.share);
        let value = match (self.get("full"), self.get("traditional")) {
            (Some(ours), Some(theirs)) => format!(
                "certified {}, traditional {}: {:.1} times",
                duration(1e3 * ours),
                duration(1e3 * theirs),
                theirs / ours
            ),
            _ => "-".into(),
        };
        (label, value)
    }
}

/// A line for each method.
fn plot(title: &str, x: Axis, rows: &[Row], at: impl Fn(&Row) -> f64) -> Plot {
    let keys = rows[0].milliseconds.iter().map(|(key, _)| *key);
    let line =
        |key: &'static str| Series::new(key, rows.iter().filter_map(|row| Some([at(row), row.get(key)?])));
    Plot {
        title: title.to_owned(),
        x,
        y: Axis::logarithmic("discrete query, mean ms"),
        series: keys.map(line).collect(),
    }
}
