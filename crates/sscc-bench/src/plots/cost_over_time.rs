//! Plot of the cost of each step of a scene, as in the paper's Figure 12.

use sscc_view::{Axis, Plot, Series};

use crate::measure::Times;

/// Drawn methods; those that did not run are omitted.
const METHODS: [&str; 3] = ["traditional", "full", "kinetic"];

/// Returns the plot of milliseconds of discrete queries over time; `seconds` gives the time of a measured step.
pub fn cost_over_time(scenario: &str, times: &Times, seconds: impl Fn(usize) -> f64) -> Plot {
    let shown = METHODS.map(|key| (key, times.of(key)));
    let line = |(key, times): (&str, Vec<(usize, f64)>)| {
        Series::new(key, times.into_iter().map(|(step, ms)| [seconds(step), ms]))
    };
    Plot {
        title: format!("Cost over time: {scenario}"),
        x: Axis::linear("time (s)"),
        y: Axis::logarithmic("discrete query, ms per step"),
        series: shown.into_iter().filter(|(_, times)| !times.is_empty()).map(line).collect(),
    }
}
