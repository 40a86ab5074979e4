//! Runs configurations. The path with the least processor time so far is next, among the paths with fewer answers than wanted.

use std::fs::OpenOptions;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path as File, PathBuf};
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

use crate::exact::work;
use crate::paths::{self, PATHS, Path};
use crate::random::Random;
use crate::record::Record;
use crate::tally::Tally;

/// Time between two writes of the record.
const WRITE_EVERY: Duration = Duration::from_secs(10);

/// Processor time after which a configuration of a campaign makes no more queries.
const MAX_TIME: Duration = Duration::from_secs(2);

/// The size of a configuration in a quick run, as a share of its full size.
const QUICK: f64 = 0.03;

/// Options of a campaign.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The time that this run takes. If None, it ends when all paths have as many answers as wanted.
    pub time: Option<Duration>,
    /// The seed. If None, it is the seed of the record, or 1.
    pub seed: Option<u64>,
    /// The record.
    pub record: PathBuf,
    /// The only path to run. If None, all paths are run.
    pub path: Option<String>,
}

/// Runs one configuration. A panic counts as a wrong answer.
fn configuration(path: &Path, seed: u64, number: u64, share: f64, limit: Option<Duration>) -> Tally {
    let mut random = Random::new(path.name, seed.wrapping_mul(1 << 32).wrapping_add(number));
    let mut tally = Tally::default();
    work::begin(limit);
    if catch_unwind(AssertUnwindSafe(|| (path.run)(&mut random, &mut tally, share))).is_err() {
        tally.wrong(|| "the core or an oracle panicked (see standard error)".to_owned());
    }
    tally
}

/// Returns the command that runs a configuration again.
fn command(path: &Path, seed: u64, number: u64) -> String {
    format!("cargo xtask soundness --path {} --seed {seed} --configuration {number}", path.name)
}

/// Runs a campaign, from its record on. Returns the record at the end.
///
/// # Errors
/// A message of one line if the record cannot be read or written, or if no path has the given name.
pub fn run(campaign: &Campaign, mut report: impl FnMut(&str)) -> Result<Record, String> {
    let mut record = Record::read(&campaign.record, campaign.seed)?;
    let chosen = campaign.path.as_deref().map(index_of).transpose()?;
    let (start, mut written) = (Instant::now(), Instant::now());
    loop {
        let next = next_path(&record, chosen, campaign.time.is_some());
        let Some(i) = next.filter(|_| campaign.time.is_none_or(|time| start.elapsed() < time)) else { break };
        let (path, counters) = (&PATHS[i], &mut record.paths[i]);
        let (number, begin) = (counters.configurations, ThreadTime::now());
        let tally = configuration(path, record.seed, number, 1.0, Some(MAX_TIME));
        counters.configurations += 1;
        counters.seconds += begin.elapsed().as_secs_f64();
        if !tally.is_clean() {
            let lines = failure(path, record.seed, number, &tally);
            report(&lines);
            append(&campaign.record.with_extension("failures"), &lines)?;
        }
        counters.tally.add(tally);
        if written.elapsed() >= WRITE_EVERY {
            record.write(&campaign.record)?;
            written = Instant::now();
        }
    }
    record.write(&campaign.record)?;
    Ok(record)
}

/// Returns the path that runs next. None if all paths have the wanted number of answers, unless `beyond` allows more.
fn next_path(record: &Record, chosen: Option<usize>, beyond: bool) -> Option<usize> {
    let all = || (0..PATHS.len()).filter(|i| chosen.is_none_or(|chosen| chosen == *i));
    let is_open = |i: &usize| record.paths[*i].tally.done < PATHS[*i].wanted;
    let seconds = |i: &usize| record.paths[*i].seconds;
    let least = |i: &usize, j: &usize| seconds(i).total_cmp(&seconds(j));
    all().filter(is_open).min_by(least).or_else(|| all().filter(|_| beyond).min_by(least))
}

fn index_of(name: &str) -> Result<usize, String> {
    let names: Vec<&str> = PATHS.iter().map(|path| path.name).collect();
    PATHS
        .iter()
        .position(|path| path.name == name)
        .ok_or_else(|| format!("no path has the name '{name}'; the paths are: {}", names.join(", ")))
}

fn failure(path: &Path, seed: u64, number: u64, tally: &Tally) -> String {
    let Tally { false_negatives, wrong, messages, .. } = tally;
    let mut lines =
        format!("{}: {false_negatives} false negatives, {wrong} wrong\n", command(path, seed, number));
    messages.iter().for_each(|message| lines += &format!("  {message}\n"));
    lines
}

fn append(file: &File, lines: &str) -> Result<(), String> {
    let mut options = OpenOptions::new();
    let out =
        options.create(true).append(true).open(file).and_then(|mut out| out.write_all(lines.as_bytes()));
    out.map_err(|error| format!("{}: {error}", file.display()))
}

/// Runs one configuration again.
///
/// # Errors
/// A message of one line if no path has this name.
pub fn replay(name: &str, seed: u64, number: u64) -> Result<Tally, String> {
    index_of(name)?;
    let path = paths::find(name).ok_or("no path has this name")?;
    Ok(configuration(path, seed, number, 1.0, None))
}

/// Runs the first configurations of each path, or of a single one, in short form.
///
/// # Errors
/// A message of one line if no path has this name.
pub fn run_quick(
    seed: u64,
    name: Option<&str>,
    configurations: u64,
    mut report: impl FnMut(&str),
) -> Result<Record, String> {
    let chosen = name.map(index_of).transpose()?;
    let mut record = Record::new(seed);
    for (i, (path, counters)) in PATHS.iter().zip(&mut record.paths).enumerate() {
        let count = if chosen.is_none_or(|chosen| chosen == i) { configurations } else { 0 };
        for number in 0..count {
            let begin = ThreadTime::now();
            let tally = configuration(path, seed, number, QUICK, None);
            if !tally.is_clean() {
                report(&failure(path, seed, number, &tally));
            }
            counters.configurations += 1;
            counters.seconds += begin.elapsed().as_secs_f64();
            counters.tally.add(tally);
        }
    }
    Ok(record)
}
