//! `growth`: how certificates and queries grow with the number of triangles.

use anyhow::Result;
use serde::Serialize;
use sscc_io::write_whole;

use super::Session;
use super::amplitudes::steps;
use super::measure::{Asked, measure};
use super::plot::{Line, Plot};
use super::report::{Means, Report};
use super::sample::{directions, to_unit};
use crate::output::Output;
use crate::progress::Bar;
use sscc_sim::{ModesSpec, Recipe, SPRING_RINGS, Shape, machine_description};

/// The embedded spring, so many halves of its usual number of rings and of vertices in each; and the number of modes.
const SPRINGS: [(&str, usize, usize); 6] = [
    ("spring-4k", 1, RANK),
    ("spring-16k", 2, RANK),
    ("spring-64k", 4, RANK),
    ("spring-256k", 8, RANK),
    ("spring-1m", 16, RANK),
    ("spring-1m-r30", 16, 30),
];

/// Number of modes of the springs that exponents are fitted to.
const RANK: usize = 20;

/// The largest displacement in percent of half the diagonal of the box.
const SHARE: f64 = 5.0;

/// Samples of each spring.
const SAMPLES: usize = 20;

/// All springs, and with which power of the number of triangles values grow.
#[derive(Serialize)]
struct Growth<'a> {
    scenario: &'static str,
    mismatches: usize,
    sizes: &'a [Report],
    exponents: Exponents,
    machine: String,
}

/// None where there is only one size.
#[derive(Serialize)]
struct Exponents {
    certify_seconds: Option<f64>,
    certify_peak_bytes: Option<f64>,
    discrete_ms: Means<Option<f64>>,
}

/// Gives the number of mismatches.
pub fn run(session: &Session<'_>, out: &mut Output) -> Result<usize> {
    session.check_only(&SPRINGS.map(|(name, ..)| name))?;
    let mut reports = Vec::new();
    for (name, halves, rank) in SPRINGS.into_iter().filter(|(name, ..)| session.wants(name)) {
        let [rings, around] = SPRING_RINGS.map(|usual| usual * halves / 2);
        let recipe = Recipe::new(name, Shape::Spring { rings, around }, ModesSpec::Linear(rank));
        let case = session.case(&recipe)?;
        let unit = to_unit(&case.model, &directions(&case.model, session.samples(SAMPLES)));
        let measured = measure(&case, &steps(&unit, SHARE), None, Asked::Discrete, &Bar::new("measuring"))?;
        reports.push(Report::new(format!("growth/{name}"), SHARE, &case, &measured, 1, None));
    }
    let mismatches = reports.iter().map(|report| report.mismatches).sum();
    let exponents = Exponents::of(&reports);
    if let Some(path) = &session.args.plot {
        write_whole(path, plot(&reports).as_bytes())?;
    }
    if session.args.json.json {
        let machine = machine_description();
        reports.iter().for_each(|report| session.rows.add(report));
        out.json(&Growth { scenario: "growth", mismatches, sizes: &reports, exponents, machine })?;
    } else {
        reports.iter().try_for_each(|report| session.print(std::slice::from_ref(report), out))?;
        if exponents.certify_seconds.is_some() {
            exponents.lines().into_iter().try_for_each(|line| out.line(line))?;
        }
    }
    Ok(mismatches)
}

impl Exponents {
    fn of(reports: &[Report]) -> Self {
        let of = |value: &dyn Fn(&Report) -> Option<f64>| {
            let fitted = reports.iter().filter(|report| report.rank == RANK);
            exponent(&fitted.filter_map(|r| Some([r.triangles as f64, value(r)?])).collect::<Vec<_>>())
        };
        let keys = reports.first().map(|report| report.discrete_ms.0.iter().map(|(key, _)| *key));
        let of_column = |key: &'static str| (key, of(&|report: &Report| report.discrete_ms.get(key)));
        Self {
            certify_seconds: of(&|report| Some(report.certify_seconds)),
            certify_peak_bytes: of(&|report| report.certify_peak_bytes.map(|bytes| bytes as f64)),
            discrete_ms: Means(keys.into_iter().flatten().map(of_column).collect()),
        }
    }

    fn lines(&self) -> Vec<String> {
        let line = |name: &str, value: Option<f64>| {
            let value = value.map_or("-".into(), |value| format!("{value:.2}"));
            format!("  {name:<24}{value:>6}")
        };
        let mut lines = vec![
            format!("grows with which power of the number of triangles ({RANK} modes):"),
            line("seconds to certify", self.certify_seconds),
            line("memory meanwhile", self.certify_peak_bytes),
        ];
        lines.extend(self.discrete_ms.0.iter().map(|(key, value)| line(key, *value)));
        lines
    }
}

/// What is drawn, and how.
const LINES: [(&str, &str, &str); 4] = [
    ("parry", "parry (ms)", "#777777"),
    ("traditional", "traditional (ms)", "#cc6600"),
    ("full", "certified (ms)", "#0066cc"),
    ("", "certificates (s)", "#009966"),
];

/// Milliseconds of a query and seconds of certificates over the number of triangles, all in logarithms.
fn plot(reports: &[Report]) -> String {
    let fitted: Vec<&Report> = reports.iter().filter(|report| report.rank == RANK).collect();
    let line = |(key, label, color)| {
        let value = |report: &Report| match key {
            "" => Some(report.certify_seconds),
            key => report.discrete_ms.get(key),
        };
        let point = |report: &&Report| Some([(report.triangles as f64).log10(), value(report)?]);
        Line { label, color, points: fitted.iter().filter_map(point).collect(), dots: true }
    };
    let plot = Plot {
        title: "Growth with the number of triangles",
        x_label: "number of triangles, as a power of ten",
        y_label: "ms, s",
        lines: LINES.into_iter().map(line).collect(),
        marks: Vec::new(),
        marks_label: "",
        logarithmic: true,
    };
    plot.svg()
}

/// The slope of a line through logarithms (least squares); none of fewer than two different sizes.
fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(libm::log)).collect();
    let mean = |at: usize| logs.iter().map(|log| log[at]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let spread: f64 = logs.iter().map(|log| (log[0] - x) * (log[0] - x)).sum();
    let common: f64 = logs.iter().map(|log| (log[0] - x) * (log[1] - y)).sum();
    (spread > 0.0).then(|| common / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_slopes() {
        let points = [1.0, 4.0, 16.0].map(|n: f64| [n, 3.0 * n * n.sqrt()]);
        assert!((exponent(&points).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(exponent(&points[..1]), None);
        assert_eq!(exponent(&[]), None);
    }
}
