//! Combinations of two modes in which pairs of triangles collide that are free with each of the two weights alone.

use serde::Serialize;
use sscc::parts::largest_depth;
use sscc::{Answer, Certificates, ModeRange, Pair, Progress, Query};
use sscc_io::LoadedModel;

use super::sweep_model::SweepRequest;
use super::sweep_row::weight;
use crate::error::Result;
use crate::text::{counted, length, one_line};
use crate::watch::CancelledBy;

/// Two modes, both at the upper end of their ranges. The fields are the keys of a JSON line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CombinationRow {
    /// The names of both modes, or their numbers.
    pub names: [String; 2],
    /// Their weights.
    pub to: [f64; 2],
    /// Number of colliding pairs.
    pub count: usize,
    /// Number of these pairs that collide neither with one of these weights alone nor at the start.
    pub new: usize,
    /// The largest penetration depth of a new pair (model unit).
    pub depth: f64,
}

/// The combinations of a model that collide in new pairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Combinations {
    /// The combinations with new pairs, in the order of their modes.
    pub rows: Vec<CombinationRow>,
    /// Number of all combinations.
    pub all: usize,
}

/// Number of combinations that are answered together. It bounds the memory of their answers.
const BLOCK: usize = 256;

/// Finds the combinations of two modes in which pairs collide that collide neither with one of the weights alone nor at
/// the start. Both modes are at the upper end of their ranges, and all others keep their weight at the start.
///
/// # Errors
/// The errors of [`SweepRequest::prepare`]; also when the certificates are of another model, or `progress` cancels.
pub fn sweep_model_combinations(
    loaded: &LoadedModel,
    certificates: &Certificates,
    request: &SweepRequest,
    progress: &dyn Progress,
) -> Result<Combinations> {
    let (q, ranges) = request.ways(loaded, certificates)?;
    let query = Query::new(&loaded.model, certificates)?;
    let at = |modes: &[&ModeRange]| {
        let mut q = q.clone();
        modes.iter().for_each(|range| q[range.mode] = range.high);
        q
    };
    let silent = CancelledBy(progress);
    let alone: Vec<Vec<f64>> = ranges.iter().map(|range| at(&[range])).collect();
    let alone = query.batch(&alone, request.threads, &silent)?;
    let start = query.batch(&[&q], request.threads, &silent)?;
    let both: Vec<[usize; 2]> =
        (0..ranges.len()).flat_map(|a| (a + 1..ranges.len()).map(move |b| [a, b])).collect();
    let mut rows = Vec::new();
    for (i, block) in both.chunks(BLOCK).enumerate() {
        let q: Vec<Vec<f64>> = block.iter().map(|modes| at(&modes.map(|mode| &ranges[mode]))).collect();
        let answers = query.batch(&q, request.threads, &silent)?;
        for ((modes, q), answer) in block.iter().zip(&q).zip(&answers) {
            let known = [&start[0], &alone[modes[0]], &alone[modes[1]]];
            let new: Vec<Pair> = new_pairs(answer, known).collect();
            if new.is_empty() {
                continue;
            }
            rows.push(CombinationRow {
                names: modes
                    .map(|mode| loaded.mode_names.get(mode).cloned().unwrap_or_else(|| mode.to_string())),
                to: modes.map(|mode| ranges[mode].high),
                count: answer.pairs.len(),
                new: new.len(),
                depth: largest_depth(&loaded.model, q, &new),
            });
        }
        progress.report((i * BLOCK + block.len()).min(both.len()), both.len());
    }
    Ok(Combinations { rows, all: both.len() })
}

fn new_pairs<'a>(answer: &'a Answer, known: [&'a Answer; 3]) -> impl Iterator<Item = Pair> + 'a {
    let is_known = move |pair: &Pair| known.iter().any(|answer| answer.pairs.binary_search(pair).is_ok());
    answer.pairs.iter().copied().filter(move |pair| !is_known(pair))
}

/// Returns the combinations as the lines of a table, and a summary.
pub fn combination_table(Combinations { rows, all }: &Combinations) -> Vec<String> {
    let line = |row: &CombinationRow| {
        let [a, b] = &row.names;
        let [x, y] = row.to.map(weight);
        let new = counted(row.new as u64, "pair");
        format!("{} = {x}, {} = {y}: {new}, depth {}", one_line(a), one_line(b), length(row.depth))
    };
    let mut table: Vec<String> = rows.iter().map(line).collect();
    table.push(format!(
        "{} of two modes: {} collide in pairs that collide with neither alone",
        counted(*all as u64, "combination"),
        rows.len()
    ));
    table
}
