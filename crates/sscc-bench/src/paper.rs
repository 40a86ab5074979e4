//! Tables 1 to 3 of the paper beside our results. The paper's times are those of a machine of 2009; ratios can be
//! compared.

use sscc_tasks::text::grouped;

use crate::record::Record;

/// A table of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperTable {
    /// Statistics of all scenes.
    One,
    /// Discrete and continuous queries of the 16 bunnies.
    Two,
    /// The parts of a simulation with sound, of the spring.
    Three,
}

/// A row of Table 1.
struct Table1Row {
    /// The scene.
    name: &'static str,
    /// Seconds of precomputation.
    precomputation: f64,
    /// Milliseconds per step for collisions between objects.
    inter: f64,
    /// Milliseconds per step for self-collisions by the traditional method.
    traditional: f64,
    /// Milliseconds per step for self-collisions by the paper's method.
    certified: f64,
    /// Speed-up of detection.
    speedup: f64,
    /// Speed-up of the simulation.
    simulation: f64,
}

const fn row(name: &'static str, precomputation: f64, ms: [f64; 3], speedups: [f64; 2]) -> Table1Row {
    let ([inter, traditional, certified], [speedup, simulation]) = (ms, speedups);
    Table1Row { name, precomputation, inter, traditional, certified, speedup, simulation }
}

/// Table 1: all scenes.
const TABLE_1: [Table1Row; 5] = [
    row("spring", 29.0, [0.0, 30.0, 0.32], [127.1, 79.1]),
    row("bunny16", 113.0, [20.0, 640.0, 22.0], [29.1, 10.9]),
    row("bunny128", 113.0, [305.0, 3797.0, 255.0], [14.9, 6.4]),
    row("dragon-nonlinear", 4500.0, [0.0, 443.0, 28.0], [15.6, 15.1]),
    row("dragon-polynomial", 5340.0, [0.0, 381.0, 3.7], [102.9, 101.7]),
];

/// A row of Table 2.
struct Table2Row {
    /// Discrete or continuous queries.
    name: &'static str,
    /// Milliseconds per step by the traditional method.
    traditional: f64,
    /// Milliseconds per step by the paper's method.
    certified: f64,
    /// Their ratio.
    speedup: f64,
}

/// Table 2: queries of the 16 bunnies.
const TABLE_2: [Table2Row; 2] = [
    Table2Row { name: "discrete", traditional: 640.0, certified: 22.0, speedup: 29.1 },
    Table2Row { name: "continuous", traditional: 2559.0, certified: 81.0, speedup: 31.6 },
];

/// A row of Table 3: shares (percent) of the time of the simulation, as printed in the paper.
struct Table3Row {
    /// The method of self-collision detection.
    name: &'static str,
    /// Self-collisions.
    own: &'static str,
    /// Dynamics and sound.
    dynamics: &'static str,
    /// Contacts with the ground.
    ground: &'static str,
    /// Penalty forces.
    penalty: &'static str,
}

/// Table 3: the spring.
const TABLE_3: [Table3Row; 2] = [
    Table3Row { name: "traditional", own: "98", dynamics: "1", ground: "<1", penalty: "<0.01" },
    Table3Row { name: "certified", own: "42", dynamics: "51", ground: "6", penalty: "1" },
];

/// Label of the row with the paper's numbers, below our row.
const PAPER: &str = "    the paper";

impl PaperTable {
    /// Returns the table as lines of text, with the records of its scenes.
    pub fn lines(self, records: &[Record]) -> Vec<String> {
        match self {
            Self::One => table_1(records),
            Self::Two => records.iter().flat_map(table_2).collect(),
            Self::Three => records.iter().flat_map(table_3).collect(),
        }
    }
}

fn table_1(records: &[Record]) -> Vec<String> {
    let mut lines = vec![
        "Table 1, ours and the paper's (ms per step; parry/ours: time of parry3d over time of sscc):"
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
    for record in records {
        let ms = |key: &str| record.discrete_ms.get(key).unwrap_or(f64::NAN);
        let (traditional, full) = (ms("traditional"), ms("full"));
        lines.push(format!(
            "  {:<24}{:>10}{:>14.2}{:>10.3}{:>10.3}{:>12.5}{:>9.1}x{:>11.1}x{:>11.1}x",
            record.scenario,
            grouped(record.triangles as u64),
            record.certify_seconds,
            record.simulation_ms.get("inter_object").unwrap_or(f64::NAN),
            traditional,
            full,
            traditional / full,
            record.simulation_speedup.unwrap_or(f64::NAN),
            ms("parry") / full
        ));
        lines.extend(substitute(record));
        if let Some(row) = TABLE_1.iter().find(|row| row.name == record.scenario) {
            lines.push(format!(
                "  {PAPER:<24}{:>10}{:>14}{:>10}{:>10}{:>12}{:>9.1}x{:>11.1}x",
                "",
                row.precomputation,
                row.inter,
                row.traditional,
                row.certified,
                row.speedup,
                row.simulation
            ));
        }
    }
    lines
}

fn table_2(record: &Record) -> Vec<String> {
    let mut lines = vec![
        format!("Table 2, ours and the paper's ({}, ms per step):", record.scenario),
        format!("  {:<24}{:>12}{:>12}{:>10}", "", "traditional", "certified", "speedup"),
    ];
    let line = |name: &str, traditional: f64, certified: f64, speedup: f64| {
        format!("  {name:<24}{traditional:>12.3}{certified:>12.4}{speedup:>9.1}x")
    };
    for (row, means) in TABLE_2.iter().zip([&record.discrete_ms, &record.continuous_ms]) {
        let ms = |key: &str| means.get(key).unwrap_or(f64::NAN);
        let (traditional, full) = (ms("traditional"), ms("full"));
        lines.push(line(row.name, traditional, full, traditional / full));
        lines.push(line(PAPER, row.traditional, row.certified, row.speedup));
    }
    lines.extend(substitute(record));
    lines
}

/// Returns a line that names the shape that replaces the shape of a scene: under `--quick`, or without files of the models.
fn substitute(record: &Record) -> Option<String> {
    record.is_substitute.then(|| {
        let triangles = grouped(record.triangles as u64);
        format!("    not the shape of {}: {}, {triangles} triangles", record.scenario, record.source)
    })
}

fn table_3(record: &Record) -> Vec<String> {
    let mut lines = vec![
        format!("Table 3, ours and the paper's ({}, % of the time):", record.scenario),
        format!(
            "  {:<24}{:>10}{:>16}{:>10}{:>10}{:>14}",
            "", "self", "dynamics, sound", "ground", "penalty", "ms per step"
        ),
    ];
    let ms = |part: &str| record.simulation_ms.get(part).unwrap_or(f64::NAN);
    let others = [ms("dynamics") + ms("sound"), ms("ground"), ms("penalty") + ms("inter_object")];
    let own = [record.discrete_ms.get("traditional").unwrap_or(f64::NAN), ms("self")];
    for (row, own) in TABLE_3.iter().zip(own) {
        let all = own + others.iter().sum::<f64>();
        let [a, b, c, d] = [own, others[0], others[1], others[2]].map(|part| 100.0 * part / all);
        lines.push(format!("  {:<24}{a:>10.2}{b:>16.2}{c:>10.2}{d:>10.3}{all:>14.5}", row.name));
        let (own, dynamics, ground, penalty) = (row.own, row.dynamics, row.ground, row.penalty);
        lines.push(format!("  {PAPER:<24}{own:>10}{dynamics:>16}{ground:>10}{penalty:>10}"));
    }
    lines.extend(substitute(record));
    lines
}
