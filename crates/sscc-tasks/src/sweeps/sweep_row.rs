//! The result of one sweep, with the name of its mode: a JSON line, and a line of a table.

use serde::Serialize;
use sscc::{Pair, Sweep, SweepOutcome};

use crate::text::{counted, length, one_line};

/// The result of one sweep. The fields are the keys of its JSON line.
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
    /// The shape is proven free from the start up to this weight; null if it collides at the start.
    pub first_free: Option<f64>,
    /// The weight at which a collision was found, or a contact within the tolerance: see [`SweepOutcome`]. Null if none
    /// was found.
    pub first_hit: Option<f64>,
    /// The pairs that collide at `first_hit`.
    pub pairs: Vec<Pair>,
    /// The outcome in words, if it is unusual.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The outcome of the sweep.
    #[serde(skip)]
    pub outcome: SweepOutcome,
}

impl SweepRow {
    /// Creates the row. `mode_names` has all names, or is empty.
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

    /// Returns the name of the file for the pose at the hit: number, name and direction of the mode.
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

/// Maximum length of the name in a line (characters).
pub(super) const MAX_NAME: usize = 40;

/// Returns the rows as the lines of a table, and a summary. Sweeps whose start collides with the same pairs share one line;
/// `remedy` names the flags that avoid these collisions.
pub fn sweep_table(rows: &[SweepRow], remedy: &str) -> Vec<String> {
    let lines = listed(rows);
    let cells: Vec<[String; 3]> = lines.iter().map(|same| cells(same, rows.len())).collect();
    let width = |column: usize| {
        let widths = cells.iter().map(|row| row[column].chars().count());
        widths.fold(4, usize::max).min(MAX_NAME)
    };
    let [name, from, to] = [0, 1, 2].map(width);
    let mut table = vec![format!("{:<name$}  {:>from$}  {:>to$}  result", "mode", "from", "to")];
    for (same, [n, f, t]) in lines.iter().zip(&cells) {
        table.push(format!("{n:<name$}  {f:>from$}  {t:>to$}  {}", same[0].result()));
    }
    if let Some(row) = rows.iter().find(|row| row.outcome == SweepOutcome::CollidingAtStart) {
        table.push(format!("{} ({remedy})", row.outcome));
    }
    let free = rows.iter().filter(|row| row.outcome == SweepOutcome::Free).count();
    let proven = "free means proven free at every weight";
    table.push(format!(
        "{}: {free} free, {} not; {proven}",
        counted(rows.len() as u64, "sweep"),
        rows.len() - free
    ));
    table
}

/// Returns the rows of each line, in the order of their first rows. Rows that collide at the start with the same pairs share
/// a line; each other row has its own line.
fn listed(rows: &[SweepRow]) -> Vec<Vec<&SweepRow>> {
    let mut lines: Vec<Vec<&SweepRow>> = Vec::new();
    for row in rows {
        let is_same = |line: &&mut Vec<&SweepRow>| {
            row.outcome == SweepOutcome::CollidingAtStart
                && line[0].outcome == row.outcome
                && line[0].pairs == row.pairs
        };
        match lines.iter_mut().find(is_same) {
            Some(line) => line.push(row),
            None => lines.push(vec![row]),
        }
    }
    lines
}

/// Returns the name and the ends of a line of the table. `all` is the number of all rows.
fn cells(same: &[&SweepRow], all: usize) -> [String; 3] {
    match same {
        [row] => [one_line(&row.name), weight(row.from), weight(row.to)],
        _ if same.len() == all => ["all".into(), String::new(), String::new()],
        _ => {
            let mut names: Vec<&str> = same.iter().map(|row| row.name.as_str()).collect();
            names.dedup();
            let mut name = one_line(&names.join(", "));
            if name.chars().count() > MAX_NAME {
                name = name.chars().take(MAX_NAME - 3).collect::<String>() + "...";
            }
            [name, String::new(), String::new()]
        }
    }
}

/// Returns a weight in the format of lengths, without zeros at the end of the decimals.
pub(super) fn weight(w: f64) -> String {
    let text = length(w);
    match text.split_once('e') {
        None if text.contains('.') => trimmed(&text).to_owned(),
        None => text,
        Some((digits, exponent)) => format!("{}e{exponent}", trimmed(digits)),
    }
}

fn trimmed(digits: &str) -> &str {
    digits.trim_end_matches('0').trim_end_matches('.')
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
        let lines = sweep_table(&[hit, free, start, close], "q");
        assert_eq!(lines[0], "mode            from    to  result");
        assert_eq!(lines[1], "smile\\u{7} L/R     0  -1.5  touches at -0.25  2 pairs, first 3 9");
        assert_eq!(lines[2], "smile\\u{7} L/R     0  -1.5  free");
        assert_eq!(lines[3], "smile\\u{7} L/R     0  -1.5  COLLIDING at the start  1 pair, first 0 7");
        assert!(lines[4].contains("free up to -1e-9; beyond it triangles 1 and 2"), "{}", lines[4]);
        assert!(lines[5].starts_with("the shape collides at the start: start elsewhere"), "{}", lines[5]);
        assert_eq!(lines[6], "4 sweeps: 1 free, 3 not; free means proven free at every weight");
    }

    #[test]
    fn weights_have_four_digits_or_all_digits_before_the_point() {
        let weights = [0.0, 1.0, -0.25, 5.658_984_5, 0.012_308_7, 1200.0, 123_456.7, 1e-9, -1.234_56e12];
        let texts = ["0", "1", "-0.25", "5.659", "0.01231", "1200", "123457", "1e-9", "-1.235e12"];
        assert_eq!(weights.map(weight), texts);
    }

    #[test]
    fn a_start_that_collides_is_one_line() {
        let at_start = |mode: usize, pairs: &[Pair]| SweepRow {
            mode,
            name: format!("target {mode}"),
            ..row(SweepOutcome::CollidingAtStart, None, Some(0.0), pairs)
        };
        let rows: Vec<SweepRow> = (0..67).map(|k| at_start(k / 2, &[(0, 7), (1, 9)])).collect();
        let lines = sweep_table(&rows, "q");
        assert_eq!(lines.len(), 4, "{lines:?}");
        assert_eq!(lines[1], "all               COLLIDING at the start  2 pairs, first 0 7");
        assert_eq!(lines[3], "67 sweeps: 0 free, 67 not; free means proven free at every weight");
        // Sweeps from other starts have separate lines.
        let mut mixed = rows.clone();
        mixed[5] = row(SweepOutcome::Free, Some(-1.5), None, &[]);
        mixed[6] = at_start(3, &[(5, 6)]);
        let lines = sweep_table(&mixed, "q");
        assert_eq!(lines.len(), 6, "{lines:?}");
        assert!(lines[1].starts_with("target 0, target 1, target 2, target ...  "), "{}", lines[1]);
        assert!(lines[2].ends_with("  free") && lines[3].ends_with("1 pair, first 5 6"), "{lines:?}");
    }
}
