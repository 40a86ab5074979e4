//! The intervals of a mode's weight over which the shape collides, with the name of the mode: a JSON line, and lines of a table.

use serde::Serialize;
use sscc::{WeightInterval, WeightIntervals, WeightSample};

use super::sweep_row::{MAX_NAME, weight};
use crate::text::{counted, length, one_line};

/// The intervals of one mode. The fields are the keys of its JSON line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IntervalRow {
    /// The name of the mode, or its number.
    pub name: String,
    /// The smallest weight.
    pub from: f64,
    /// The largest weight.
    pub to: f64,
    /// The intervals. Outside of them, up to `free_until` and from `free_from` on, the shape is proven free.
    pub intervals: Vec<Interval>,
    /// Weight, number of colliding pairs, and largest penetration depth of each sample.
    pub samples: Vec<(f64, usize, f64)>,
}

/// One interval, see [`WeightInterval`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The first weight of the interval.
    pub from: f64,
    /// The last weight of the interval.
    pub to: f64,
    /// The shape is proven free up to this weight; null if the interval begins at the low end of the range.
    pub free_until: Option<f64>,
    /// The shape is proven free from this weight on; null if the interval ends at the high end of the range.
    pub free_from: Option<f64>,
    /// Whether the shape collides at `from` and at `to`, within 1e-9 of the range from the free weights beside them.
    pub exact: bool,
    /// The largest number of pairs that collide at a tested weight: a sample inside, an end, or a collision found beyond an end
    /// that is not exact.
    pub pairs: usize,
    /// The largest penetration depth of a pair at one of these weights (model unit).
    pub depth: f64,
    /// The weight of the largest depth.
    pub deepest: f64,
}

impl From<WeightInterval> for Interval {
    fn from(interval: WeightInterval) -> Self {
        let WeightInterval { free_until, from, to, free_from, is_exact, deepest, pairs } = interval;
        let WeightSample { weight, depth, .. } = deepest;
        Self { from, to, free_until, free_from, exact: is_exact, pairs, depth, deepest: weight }
    }
}

impl IntervalRow {
    /// Creates the row. `mode_names` has all names, or is empty.
    pub fn new(found: WeightIntervals, mode_names: &[String]) -> Self {
        let mode = found.range.mode;
        let sample = |sample: &WeightSample| (sample.weight, sample.pairs, sample.depth);
        Self {
            name: mode_names.get(mode).cloned().unwrap_or_else(|| mode.to_string()),
            from: found.range.low,
            to: found.range.high,
            intervals: found.intervals.into_iter().map(Interval::from).collect(),
            samples: found.samples.iter().map(sample).collect(),
        }
    }
}

impl Interval {
    fn result(&self) -> String {
        let Self { from, to, pairs, depth, deepest, .. } = self;
        match (self.exact, pairs) {
            (_, 0) => format!("{} to {}: nothing is proven, no sample collides", weight(*from), weight(*to)),
            (exact, _) => format!(
                "{} to {}: up to {}, depth {} at {}{}",
                weight(*from),
                weight(*to),
                counted(*pairs as u64, "pair"),
                length(*depth),
                weight(*deepest),
                if exact { "" } else { "; near an end it may be free" }
            ),
        }
    }
}

/// Returns the rows as the lines of a table, one for each interval, and a summary.
pub fn interval_table(rows: &[IntervalRow]) -> Vec<String> {
    let cells: Vec<[String; 3]> =
        rows.iter().map(|row| [one_line(&row.name), weight(row.from), weight(row.to)]).collect();
    let width = |column: usize| {
        let widths = cells.iter().map(|row| row[column].chars().count());
        widths.fold(4, usize::max).min(MAX_NAME)
    };
    let [name, from, to] = [0, 1, 2].map(width);
    let line = |[n, f, t]: [&str; 3], result: &str| format!("{n:<name$}  {f:>from$}  {t:>to$}  {result}");
    let mut table = vec![line(["mode", "from", "to"], "collides from")];
    for (row, [n, f, t]) in rows.iter().zip(&cells) {
        let mut results: Vec<String> = row.intervals.iter().map(Interval::result).collect();
        if results.is_empty() {
            results.push("free".into());
        }
        for (i, result) in results.iter().enumerate() {
            table.push(line(if i == 0 { [n, f, t] } else { [""; 3] }, result));
        }
    }
    let free = rows.iter().filter(|row| row.intervals.is_empty()).count();
    let samples = rows.first().map_or(0, |row| row.samples.len());
    table.push(format!(
        "{}: {free} free, {} not; every weight outside of the intervals is proven free, up to 1e-9 of the range; pairs and depths of {} of each weight",
        counted(rows.len() as u64, "mode"),
        rows.len() - free,
        counted(samples as u64, "sample"),
    ));
    table
}

#[cfg(test)]
mod tests {
    use sscc::ModeRange;

    use super::*;

    #[test]
    fn rows_have_the_keys_of_the_contract_and_a_line_for_each_interval() {
        let sample = |weight: f64, pairs: usize, depth: f64| WeightSample { weight, pairs, depth };
        let range = ModeRange { mode: 1, low: 0.0, high: 1.0 };
        let interval = |from: f64, to: f64, pairs: usize, is_exact: bool| WeightInterval {
            free_until: Some(from),
            from,
            to,
            free_from: None,
            is_exact,
            deepest: sample(to, pairs, 0.125),
            pairs,
        };
        let found = WeightIntervals {
            range,
            samples: vec![sample(0.0, 0, 0.0), sample(1.0, 3, 0.125)],
            intervals: vec![
                interval(0.25, 0.5, 2, true),
                interval(0.6, 0.7, 1, false),
                interval(0.8, 0.8, 0, false),
            ],
        };
        let free =
            WeightIntervals { intervals: vec![], range: ModeRange { mode: 0, ..range }, ..found.clone() };
        let names = ["smile".to_owned(), "jaw\nOpen".to_owned()];
        let rows = [free, found].map(|found| IntervalRow::new(found, &names));
        let json =
            r#"{"name":"smile","from":0.0,"to":1.0,"intervals":[],"samples":[[0.0,0,0.0],[1.0,3,0.125]]}"#;
        assert_eq!(serde_json::to_string(&rows[0]).unwrap(), json);
        let json = r#"{"from":0.25,"to":0.5,"free_until":0.25,"free_from":null,"exact":true,"pairs":2,"depth":0.125,"deepest":0.5}"#;
        assert_eq!(serde_json::to_string(&rows[1].intervals[0]).unwrap(), json);
        assert_eq!(
            interval_table(&rows),
            [
                "mode       from    to  collides from",
                "smile         0     1  free",
                "jaw\\nOpen     0     1  0.25 to 0.5: up to 2 pairs, depth 0.1250 at 0.5",
                "                       0.6 to 0.7: up to 1 pair, depth 0.1250 at 0.7; near an end it may be free",
                "                       0.8 to 0.8: nothing is proven, no sample collides",
                "2 modes: 1 free, 1 not; every weight outside of the intervals is proven free, up to 1e-9 of the range; pairs and depths of 2 samples of each weight",
            ]
        );
    }
}
