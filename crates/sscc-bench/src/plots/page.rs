//! Page with the records of a scenario, in one file.

use sscc_tasks::text::duration;
use sscc_view::{Arrays, Axis, Plot, Report, Scene, Series};

use crate::error::Error;
use crate::record::Record;

/// A page with all records of a scenario.
#[derive(Clone, Debug, Default)]
pub struct BenchPage {
    records: Vec<Record>,
    costs: Vec<Plot>,
}

impl BenchPage {
    /// Adds a record.
    pub fn add(&mut self, record: &Record) {
        self.records.push(record.clone());
    }

    /// Adds the cost of each step of a scene.
    pub fn add_costs(&mut self, costs: Plot) {
        self.costs.push(costs);
    }

    /// Returns the page, titled with the name of the scenario.
    ///
    /// # Errors
    /// When the report cannot be written.
    pub fn html(&self, scenario: &str) -> Result<String, Error> {
        let records = &self.records;
        let mut scene = Scene::new(format!("sscc bench {scenario}"));
        scene.summary = records.iter().map(line).collect();
        scene.summary.push(("machine".into(), sscc_tasks::machine_description()));
        scene.plots.extend(self.costs.iter().cloned());
        // Cost of a model over its displacement.
        for group in records.chunk_by(|a, b| a.scenario == b.scenario).filter(|group| group.len() > 1) {
            let x = Axis::logarithmic("largest displacement, % of half the box's diagonal");
            scene.plots.push(plot(&group[0].scenario, x, group, |record| record.share));
        }
        // Cost of one shape over its number of triangles.
        if scenario == "growth" && records.len() > 1 {
            let x = Axis::logarithmic("triangles");
            scene.plots.push(plot(scenario, x, records, |record| record.triangles as f64));
        }
        Ok(Report { scene, arrays: Arrays::default(), checks: None }.html()?)
    }
}

/// Returns the label of a record, with the times of the certified and of the traditional method and their ratio.
fn line(record: &Record) -> (String, String) {
    let label = format!("{}, displaced by {:.1}%", record.scenario, record.share);
    let value = match (record.discrete_ms.get("full"), record.discrete_ms.get("traditional")) {
        (Some(certified), Some(traditional)) => format!(
            "certified {}, traditional {}: {:.1} times",
            duration(1e3 * certified),
            duration(1e3 * traditional),
            traditional / certified
        ),
        _ => "-".into(),
    };
    (label, value)
}

/// Returns a plot with a line for each method.
fn plot(title: &str, x: Axis, records: &[Record], at: impl Fn(&Record) -> f64) -> Plot {
    let keys = records[0].discrete_ms.0.iter().map(|(key, _)| *key);
    let line = |key: &'static str| {
        Series::new(key, records.iter().filter_map(|record| Some([at(record), record.discrete_ms.get(key)?])))
    };
    Plot {
        title: title.to_owned(),
        x,
        y: Axis::logarithmic("discrete query, mean ms"),
        series: keys.map(line).collect(),
    }
}
