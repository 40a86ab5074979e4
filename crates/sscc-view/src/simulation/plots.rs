//! The plots of a simulation's report.

use sscc_sim::{FinishedRun, TraditionalCost};

use crate::{Axis, Plot, Series};

/// Largest number of points of a line.
const MAX_POINTS: usize = 700;

/// Returns the cost of self-collision detection in each step, as in the paper's Figure 12. For the simulation's own method
/// the plot shows the maximum of each run of consecutive steps, for the traditional method single states.
pub fn costs(run: &FinishedRun) -> Plot {
    let own = line(run, |state| 1e3 * run.history.step(state).self_seconds());
    let of = |cost: &TraditionalCost| [run.time(cost.state), 1e3 * cost.seconds];
    Plot {
        title: "Cost over time".into(),
        x: time(),
        y: Axis::logarithmic("self-collisions, ms per step"),
        series: vec![
            Series::new("traditional", run.traditional.iter().map(of)),
            Series::new("certified", thin(&own, MAX_POINTS, f64::max)),
        ],
    }
}

/// Returns the total energy of all bodies.
pub fn energy(run: &FinishedRun) -> Plot {
    let mut points = line(run, |state| run.history.step(state).energy);
    points.retain(|point| point[1].is_finite());
    Plot {
        title: "Energy".into(),
        x: time(),
        y: Axis::linear("kinetic, elastic and potential (J)"),
        series: vec![Series::new("all bodies", thin(&points, MAX_POINTS, f64::max))],
    }
}

/// Returns the sound as the largest and the smallest sample of each run of consecutive steps.
pub fn sound(run: &FinishedRun) -> Plot {
    let points = line(run, |state| run.history.step(state).sound);
    let series = |name, pick| Series::new(name, thin(&points, MAX_POINTS, pick));
    Plot {
        title: "Sound".into(),
        x: time(),
        y: Axis::linear("sample"),
        series: vec![series("largest", f64::max as fn(f64, f64) -> f64), series("smallest", f64::min)],
    }
}

/// Returns the points (time, value) of all states.
fn line(run: &FinishedRun, of: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
    (0..run.history.len()).map(|state| [run.time(state), of(state)]).collect()
}

fn time() -> Axis {
    Axis::linear("time (s)")
}

/// Returns at most `max` points: for each run of consecutive points the mean x and the largest or smallest y (`pick`).
fn thin(points: &[[f64; 2]], max: usize, pick: fn(f64, f64) -> f64) -> Vec<[f64; 2]> {
    let run = points.len().div_ceil(max.max(1)).max(1);
    let one = |part: &[[f64; 2]]| {
        let x = part.iter().map(|p| p[0]).sum::<f64>() / part.len() as f64;
        [x, part.iter().map(|p| p[1]).fold(f64::NAN, pick)]
    };
    points.chunks(run).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_lines_keep_their_peaks() {
        let points: Vec<[f64; 2]> = (0..1000).map(|i| [f64::from(i), f64::from(i % 100)]).collect();
        let peaks = thin(&points, 10, f64::max);
        assert_eq!(peaks.len(), 10);
        assert!(peaks.iter().all(|p| p[1] == 99.0));
        assert_eq!(thin(&points[..3], 10, f64::max), points[..3]);
        assert!(thin(&[], 10, f64::max).is_empty());
    }
}
