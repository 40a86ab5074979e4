//! The paper's Tables 1 to 3 beside ours. Its times are of a machine of 2009; what compares is the ratios.

use super::report::Report;
use super::scenario::PaperTable;
use crate::output::grouped;

/// A row of the paper's Table 1: seconds of precomputation, milliseconds of a step for collisions between objects,
/// within them by the traditional method and by its own, and the speed-ups of detection and simulation.
struct Row {
    name: &'static str,
    precomputation: f64,
    inter: f64,
    traditional: f64,
    own: f64,
    speedup: f64,
    simulation: f64,
}

const fn row(name: &'static str, precomputation: f64, ms: [f64; 3], speedups: [f64; 2]) -> Row {
    let ([inter, traditional, own], [speedup, simulation]) = (ms, speedups);
    Row { name, precomputation, inter, traditional, own, speedup, simulation }
}

const TABLE_1: [Row; 5] = [
    row("spring", 29.0, [0.0, 30.0, 0.32], [127.1, 79.1]),
    row("bunny16", 113.0, [20.0, 640.0, 22.0], [29.1, 10.9]),
    row("bunny128", 113.0, [305.0, 3797.0, 255.0], [14.9, 6.4]),
    row("dragon-nonlinear", 4500.0, [0.0, 443.0, 28.0], [15.6, 15.1]),
    row("dragon-polynomial", 5340.0, [0.0, 381.0, 3.7], [102.9, 101.7]),
];

/// The paper's Table 2: traditional and certified milliseconds, and the speed-up.
const TABLE_2: [(&str, [f64; 3]); 2] =
    [("discrete", [640.0, 22.0, 29.1]), ("continuous", [2559.0, 81.0, 31.6])];

/// The paper's Table 3: the share (percent) of the time for self-collisions, dynamics with sound, the ground, penalty
/// forces.
const TABLE_3: [(&str, [&str; 4]); 2] =
    [("traditional", ["98", "1", "<1", "<0.01"]), ("certified", ["42", "51", "6", "1"])];

/// The lines of a table.
pub fn lines(table: PaperTable, reports: &[Report]) -> Vec<String> {
    match table {
        PaperTable::None => Vec::new(),
        PaperTable::One => one(reports),
        PaperTable::Two => reports.iter().flat_map(two).collect(),
        PaperTable::Three => reports.iter().flat_map(three).collect(),
    }
}

fn one(reports: &[Report]) -> Vec<String> {
    let mut lines = vec![
        "Table 1, ours and the paper's (ms in a step; parry/ours: detection by parry3d over ours):"
            .to_owned(),
        format!(
            "  {:<24}{:>10}{:>14}{:>10}{:>10}{:>12}{:>10}{:>12}{:>12}",
            "",
            "triangles",
            "precomp, s",
            "inter",
            "self",
            "certified",
            "speedup",
            "simulation",
            "parry/ours"
        ),
    ];
    for report in reports {
        let ms = |key: &str| report.discrete_ms.get(key).unwrap_or(f64::NAN);
        let (traditional, own) = (ms("traditional"), ms("full"));
        lines.push(format!(
            "  {:<24}{:>10}{:>14.2}{:>10.3}{:>10.3}{:>12.5}{:>9.1}x{:>11.1}x{:>11.1}x",
            report.scenario,
            grouped(report.triangles as u64),
            report.certify_seconds,
            report.simulation_ms.get("inter_object").unwrap_or(f64::NAN),
            traditional,
            own,
            traditional / own,
            report.simulation_speedup.unwrap_or(f64::NAN),
            ms("parry") / own
        ));
        if let Some(paper) = TABLE_1.iter().find(|row| row.name == report.scenario) {
            lines.push(format!(
                "  {:<24}{:>10}{:>14}{:>10}{:>10}{:>12}{:>9.1}x{:>11.1}x",
                "    the paper",
                "",
                paper.precomputation,
                paper.inter,
                paper.traditional,
                paper.own,
                paper.speedup,
                paper.simulation
            ));
        }
    }
    lines
}

fn two(report: &Report) -> Vec<String> {
    let mut lines = vec![
        format!("Table 2, ours and the paper's ({}, ms in a step):", report.scenario),
        format!("  {:<24}{:>12}{:>12}{:>10}", "", "traditional", "certified", "speedup"),
    ];
    for ((name, paper), means) in TABLE_2.iter().zip([&report.discrete_ms, &report.continuous_ms]) {
        let ms = |key: &str| means.get(key).unwrap_or(f64::NAN);
        let (traditional, own) = (ms("traditional"), ms("full"));
        let line =
            |name: &str, [a, b, ratio]: [f64; 3]| format!("  {name:<24}{a:>12.3}{b:>12.4}{ratio:>9.1}x");
        lines.push(line(name, [traditional, own, traditional / own]));
        lines.push(line("    the paper", *paper));
    }
    lines
}

fn three(report: &Report) -> Vec<String> {
    let mut lines = vec![
        format!("Table 3, ours and the paper's ({}, % of the time):", report.scenario),
        format!(
            "  {:<24}{:>10}{:>16}{:>10}{:>10}{:>14}",
            "", "self", "dynamics, sound", "ground", "penalty", "ms in a step"
        ),
    ];
    let ms = |part: &str| report.simulation_ms.get(part).unwrap_or(f64::NAN);
    let others = [ms("dynamics") + ms("sound"), ms("ground"), ms("penalty") + ms("inter_object")];
    let own = [report.discrete_ms.get("traditional").unwrap_or(f64::NAN), ms("self")];
    for ((name, paper), own) in TABLE_3.iter().zip(own) {
        let all = own + others.iter().sum::<f64>();
        let [a, b, c, d] = [own, others[0], others[1], others[2]].map(|part| 100.0 * part / all);
        lines.push(format!("  {name:<24}{a:>10.2}{b:>16.2}{c:>10.2}{d:>10.3}{all:>14.5}"));
        let [a, b, c, d] = paper;
        lines.push(format!("  {:<24}{a:>10}{b:>16}{c:>10}{d:>10}", "    the paper"));
    }
    lines
}
