//! The records of one model as a table.

use sscc_bench::{Means, Record};

use crate::output::{counted, grouped};

/// Ratios are times of the methods [`COMPARED`] over the time of this one.
const REFERENCE: &str = "full";

/// Methods whose times are divided by that of [`REFERENCE`].
const COMPARED: [&str; 2] = ["parry", "traditional"];

/// A table with a row for each record and a column for each method.
pub struct Table<'a> {
    records: &'a [Record],
}

/// A row of the table: label, number of the steps that it describes, and the mean or median times of the methods in
/// them.
struct Row<'a> {
    label: String,
    steps: String,
    means: &'a Means,
}

impl<'a> Table<'a> {
    /// Creates the table of records of one model.
    pub fn of(records: &'a [Record]) -> Self {
        Self { records }
    }

    pub fn lines(&self) -> Vec<String> {
        let Some(first) = self.records.first() else { return Vec::new() };
        let bodies = if first.objects == 1 { "one body".into() } else { format!("{} bodies", first.objects) };
        let mut lines = vec![format!(
            "{}: {bodies} of {} triangles, {} modes ({})",
            first.scenario,
            grouped(first.triangles as u64),
            first.rank,
            first.source
        )];
        let memory = first.certify_peak_bytes.map(|bytes| format!(", {} MB", grouped(bytes / 1_000_000)));
        lines.push(format!(
            "certified in {:.2} s on {}{}",
            first.certify_seconds,
            counted(first.certify_threads as u64, "thread"),
            memory.unwrap_or_default()
        ));
        if first.scene_steps > first.steps {
            lines.push(format!(
                "whole scene: {} of {} steps collide, {} of {} queries (one for each body and step)",
                first.scene_colliding_steps,
                first.scene_steps,
                grouped(first.scene_colliding_body_steps as u64),
                grouped(first.scene_body_steps as u64)
            ));
        }
        if let (Some(seconds), Some(share)) = (first.simulation_seconds, first.self_collision_share) {
            lines.push(format!(
                "simulated in {seconds:.2} s of processor time, {:.1}% of it for self-collisions; {} as fast as with the traditional method",
                100.0 * share,
                times(first.simulation_speedup)
            ));
        }
        lines.extend(first.note.iter().map(|note| format!("note: {note}")));
        if self.records.len() == 1 && first.scene_steps > first.compared_steps {
            let [scene, compared] = first.strata;
            let scene = scene.map(|steps| grouped(steps as u64));
            lines.push(format!(
                "means are of the whole scene: {} steps free by the root's certificate ({} compared), {} free where it fails ({}), {} colliding ({})",
                scene[0], compared[0], scene[1], compared[1], scene[2], compared[2]
            ));
        }
        let label = |record: &Record| match record.times_root {
            Some(times) => format!("{times} root radii"),
            None => format!("{}%", (record.share * 10.0).round() / 10.0),
        };
        let discrete = self.records.iter().flat_map(|record| {
            let (all, colliding, failed) = (record.steps, record.colliding_steps, record.root_failed_steps);
            let row = |label: &str, steps: usize, means| {
                Some(Row { label: label.into(), steps: format!("{steps} of {all}"), means })
            };
            // A second row would repeat the first if the root's certificate always or never fails.
            let is_same = failed == all || failed == 0;
            let rows = [
                row(&label(record), colliding, &record.discrete_ms),
                row("  root fails", failed, &record.discrete_ms_root_failed).filter(|_| !is_same),
                row("  free, median", all - colliding, &record.free_ms_median),
                row("  collide, median", colliding, &record.colliding_ms_median),
            ];
            rows.into_iter().flatten()
        });
        lines.extend(block("discrete, ms", discrete));
        let continuous = self.records.iter().map(|record| Row {
            label: label(record),
            steps: counted(record.continuous_steps as u64, "step"),
            means: &record.continuous_ms,
        });
        lines.extend(block("continuous, ms", continuous));
        let mismatches: usize = self.records.iter().map(|record| record.mismatches).sum();
        lines.push(match mismatches {
            0 => "all exact methods list the same pairs".into(),
            n => format!("DEFECT: exact methods differ in {n} steps"),
        });
        lines.push(String::new());
        lines
    }
}

fn block<'a>(title: &str, rows: impl Iterator<Item = Row<'a>>) -> Vec<String> {
    let rows: Vec<Row<'_>> = rows.filter(|row| !row.means.is_empty()).collect();
    let Some(first) = rows.first() else { return Vec::new() };
    let keys: Vec<&str> = first.means.0.iter().map(|(key, _)| *key).collect();
    let width = |key: &str| key.len().max(11) + 2;
    let heads: String = keys.iter().map(|key| format!("{key:>0$}", width(key))).collect();
    let over: String = COMPARED.iter().map(|key| format!("{:>18}", format!("{key}/{REFERENCE}"))).collect();
    let mut lines = vec![format!("  {title:<19}{:>12}{heads}{over}", "states")];
    for row in &rows {
        let cell = |key: &&str| format!("{:>1$}", shown(row.means.get(key)), width(key));
        let cells: String = keys.iter().map(cell).collect();
        let ratio = |key: &str| Some(row.means.get(key)? / row.means.get(REFERENCE)?);
        let ratios: String = COMPARED.iter().map(|key| format!("{:>18}", times(ratio(key)))).collect();
        lines.push(format!("  {:<19}{:>12}{cells}{ratios}", row.label, row.steps));
    }
    lines
}

/// Formats milliseconds with four significant digits, or all digits before the point; with at most eight after it.
fn shown(ms: Option<f64>) -> String {
    match ms {
        None => "-".into(),
        Some(ms) => {
            let decimals = (3 - ms.max(1e-9).log10().floor() as i32).clamp(0, 8) as usize;
            format!("{ms:.decimals$}")
        }
    }
}

fn times(ratio: Option<f64>) -> String {
    match ratio {
        None => "-".into(),
        Some(ratio) if ratio < 100.0 => format!("{ratio:.2} x"),
        Some(ratio) => format!("{} x", grouped(ratio.round() as u64)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_four_digits_and_ratios_two_decimals_below_100() {
        assert_eq!([123.456, 1.5, 0.000_05].map(|ms| shown(Some(ms))), ["123.5", "1.500", "0.00005000"]);
        assert_eq!([0.5, 99.0, 12_345.6].map(|x| times(Some(x))), ["0.50 x", "99.00 x", "12,346 x"]);
        assert_eq!((shown(None), times(None)), ("-".into(), "-".into()));
    }
}
