//! The result of one sweep, with the name of its mode: a JSON line, and a line of a table.

use serde::Serialize;
use sscc::{Pair, Sweep, SweepOutcome};

use crate::text::{counted, one_line};

/// The result of one sweep: the keys of its JSON line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepRow {
    /// The mode, from 0.
    #[serde(skip)]
    pub mode: usize,
    /// The name of the mode, or its number.
    pub name: String,
    /// The weight at the start.
    pub from: f64,
    /// The weight at the end.
    pub to: f64,
    /// The shape is proven free from the start up to this weight.
    pub first_free: Option<f64>,
    /// The first weight at which it collides.
    pub first_hit: Option<f64>,
    /// The pairs that collide there.
    pub pairs: Vec<Pair>,
    /// What is unusual about the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// How the sweep ended.
    #[serde(skip)]
    pub outcome: SweepOutcome,
}

impl SweepRow {
    /// `mode_names`: all names, or none.
    pub(super) fn new(sweep: Sweep, mode_names: &[String]) -> Self {
        let is_usual = matches!(sweep.outcome, SweepOutcome::Free | SweepOutcome::Hit);
        Self {
            mode: sweep.mode,
            name: mode_names.get(sweep.mode).cloned().unwrap_or_else(|| sweep.mode.to_string()),
            from: sweep.from,
            to: sweep.to,
            first_free: sweep.first_free,
            first_hit: sweep.first_hit,
            pairs: sweep.pairs,
            note: (!is_usual).then(|| sweep.outcome.to_string()),
            outcome: sweep.outcome,
        }
    }

    /// The name of the file for the pose at the hit: number, name and direction of the mode.
    pub(super) fn file_name(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let name: String = self.name.chars().take(60).map(plain).collect();
        format!("{:03}_{name}_{}.ply", self.mode, if self.to > self.from { "up" } else { "down" })
    }

    fn result(&self) -> String {
        let pairs = || match self.pairs.first() {
            Some((i, j)) => format!("  {}, first {i} {j}", counted(self.pairs.len() as u64, "pair")),
            None => String::new(),
        };
        match (self.outcome, self.first_free, self.first_hit) {
            (SweepOutcome::Free, ..) => "free".into(),
            (SweepOutcome::CollidingAtStart, ..) => format!("COLLIDING at the start{}", pairs()),
            (SweepOutcome::Hit, _, Some(hit)) => format!("touches at {}{}", weight(hit), pairs()),
            (outcome, free, hit) => {
                let free = free.map(|free| format!("free up to {}; ", weight(free))).unwrap_or_default();
                let hit = hit.map(|hit| format!("touches at {}{}; ", weight(hit), pairs()));
                format!("{free}{}{outcome}", hit.unwrap_or_default())
            }
        }
    }
}

/// Returns the rows as the lines of a table, and a summary.
pub fn sweep_table(rows: &[SweepRow]) -> Vec<String> {
    let cells: Vec<[String; 3]> =
        rows.iter().map(|row| [one_line(&row.name), weight(row.from), weight(row.to)]).collect();
    let width = |column: usize| {
        let widths = cells.iter().map(|row| row[column].chars().count());
        widths.fold(4, usize::max).min(40)
    };
    let [name, from, to] = [0, 1, 2].map(width);
    let mut lines = vec![format!("{:<name$}  {:>from$}  {:>to$}  result", "mode", "from", "to")];
    for (row, [n, f, t]) in rows.iter().zip(&cells) {
        lines.push(format!("{n:<name$}  {f:>from$}  {t:>to$}  {}", row.result()));
    }
    if let Some(row) = rows.iter().find(|row| row.outcome == SweepOutcome::CollidingAtStart) {
        lines.push(format!("{} (--q, --ignore-rest)", row.outcome));
    }
    let free = rows.iter().filter(|row| row.outcome == SweepOutcome::Free).count();
    let proven = "free means proven free at every weight";
    lines.push(format!(
        "{}: {free} free, {} not; {proven}",
        counted(rows.len() as u64, "sweep"),
        rows.len() - free
    ));
    lines
}

/// Returns a weight with seven digits.
fn weight(w: f64) -> String {
    if w == 0.0 || (1e-4..1e7).contains(&w.abs()) {
        let text = format!("{w:.7}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{w:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(outcome: SweepOutcome, free: Option<f64>, hit: Option<f64>, pairs: &[Pair]) -> SweepRow {
        let (first_free, first_hit, pairs) = (free, hit, pairs.to_vec());
        let sweep = Sweep { mode: 1, from: 0.0, to: -1.5, first_free, first_hit, pairs, outcome };
        SweepRow::new(sweep, &["a".into(), "smile\u{7} L/R".into()])
    }

    #[test]
    fn rows_have_the_keys_of_the_contract() {
        let hit = row(SweepOutcome::Hit, Some(-0.25), Some(-0.250_000_000_1), &[(3, 9), (4, 9)]);
        let json = r#"{"name":"smile\u0007 L/R","from":0.0,"to":-1.5,"first_free":-0.25,"first_hit":-0.2500000001,"pairs":[[3,9],[4,9]]}"#;
        assert_eq!(serde_json::to_string(&hit).unwrap(), json);
        assert_eq!(hit.file_name(), "001_smile__L_R_down.ply");
        let free = row(SweepOutcome::Free, Some(-1.5), None, &[]);
        let start = row(SweepOutcome::CollidingAtStart, None, Some(0.0), &[(0, 7)]);
        let json = serde_json::to_value(&start).unwrap();
        assert_eq!((json["first_free"].is_null(), json["note"].is_string()), (true, true));
        let close = row(SweepOutcome::TooClose((1, 2)), Some(-1e-9), None, &[]);
        let lines = sweep_table(&[hit, free, start, close]);
        assert_eq!(lines[0], "mode            from    to  result");
        assert_eq!(lines[1], "smile\\u{7} L/R     0  -1.5  touches at -0.25  2 pairs, first 3 9");
        assert_eq!(lines[2], "smile\\u{7} L/R     0  -1.5  free");
        assert_eq!(lines[3], "smile\\u{7} L/R     0  -1.5  COLLIDING at the start  1 pair, first 0 7");
        assert!(lines[4].contains("free up to -1.000000e-9; beyond it triangles 1 and 2"), "{}", lines[4]);
        assert!(lines[5].starts_with("the shape collides at the start: start elsewhere"), "{}", lines[5]);
        assert_eq!(lines[6], "4 sweeps: 1 free, 3 not; free means proven free at every weight");
    }
}
