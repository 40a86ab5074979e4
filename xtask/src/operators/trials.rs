//! Draws variants at random, runs the tests that reach them, and counts those that a test catches.
//!
//! Variants that were caught before, with the same number in the same line of the same file, are not run again: a run with more
//! seconds tries the others. Without `target/operators/caught.tsv` all are run.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Write;
use std::sync::Mutex;
use std::time::Duration;

use super::compile::Variant;
use super::programs::{Outcome, Test, in_parallel, run as run_test};
use crate::program::root;

/// The record that documents show, relative to the root.
const RECORD: &str = "docs/records/operators.csv";

/// The variants that a test has caught, relative to the root.
const CAUGHT: &str = "target/operators/caught.tsv";

const HEADER: &str = "folder,variants,tried,caught,passed,unreached";

/// Which variants to run, and how long.
#[derive(Clone, Debug, Default)]
pub struct Draw {
    pub count: u64,
    pub seed: u64,
    /// Seconds that the tests of a variant may take together, by their times without a variant. The quickest test always runs.
    pub seconds: u64,
    /// Beginnings of file names; none stands for all files.
    pub paths: Vec<String>,
}

/// What became of a variant.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Verdict {
    /// A test failed, or did not end.
    Caught(String),
    /// All tests passed.
    Passed,
    /// No test that is quick enough reaches it.
    Unreached,
}

/// Runs variants, and prints those that no test catches. `writes` states whether the record is replaced.
pub fn run(variants: &[Variant], tests: &[Test], draw: &Draw, writes: bool) -> Result<(), String> {
    let before = caught_before(variants);
    let mut file = File::options().append(true).create(true).open(root().join(CAUGHT));
    let file = Mutex::new(file.as_mut().map_err(|error| format!("{CAUGHT}: {error}"))?);
    let verdicts = in_parallel(&drawn(variants, draw), |_, variant| {
        if let Some(test) = before.get(&variant.number) {
            return Ok((folder(&variant.file), Verdict::Caught(test.clone())));
        }
        let verdict = verdict(variant, tests, draw.seconds)?;
        let Variant { file: name, line, function, change, .. } = variant;
        let text = match &verdict {
            Verdict::Caught(test) => {
                let mut file = file.lock().map_err(|error| error.to_string())?;
                let written = writeln!(file, "{}\t{test}", line_of(variant));
                written.map_err(|error| format!("{CAUGHT}: {error}"))?;
                format!("caught by {test}")
            }
            Verdict::Passed => "ALL TESTS PASSED".to_owned(),
            Verdict::Unreached => "NO TEST REACHES IT".to_owned(),
        };
        println!("{name}:{line}  {function}  {change}  {text}");
        Ok((folder(name), verdict))
    })?;
    let record = counted(variants, &verdicts);
    print!("{record}");
    if writes {
        let path = root().join(RECORD);
        let before = fs::read_to_string(&path).unwrap_or_default();
        fs::write(path, merged(&before, &record)).map_err(|error| format!("{RECORD}: {error}"))?;
    }
    Ok(())
}

/// Returns the tests that have caught variants, by the numbers of these.
fn caught_before(variants: &[Variant]) -> BTreeMap<u32, String> {
    let all: BTreeMap<String, u32> =
        variants.iter().map(|variant| (line_of(variant), variant.number)).collect();
    let text = fs::read_to_string(root().join(CAUGHT)).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.rsplit_once('\t'));
    lines.filter_map(|(variant, test)| Some((*all.get(variant)?, test.to_owned()))).collect()
}

fn line_of(Variant { number, file, line, function, change }: &Variant) -> String {
    format!("{number}\t{file}\t{line}\t{function}\t{change}")
}

/// Returns the variants in the order of random numbers, as many as are wanted.
fn drawn<'v>(variants: &'v [Variant], draw: &Draw) -> Vec<&'v Variant> {
    let is_chosen =
        |file: &str| draw.paths.is_empty() || draw.paths.iter().any(|path| file.starts_with(path));
    let mut all: Vec<&Variant> = variants.iter().filter(|variant| is_chosen(&variant.file)).collect();
    all.sort_by_key(|variant| mixed(mixed(draw.seed) ^ u64::from(variant.number)));
    all.truncate(draw.count as usize);
    all
}

/// SplitMix64.
fn mixed(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Runs the tests that reach a variant until one fails.
fn verdict(variant: &Variant, tests: &[Test], seconds: u64) -> Result<Verdict, String> {
    let module = module(&variant.file);
    let mut reaching: Vec<&Test> =
        tests.iter().filter(|test| test.reached.contains(&variant.number)).collect();
    if reaching.is_empty() {
        return Ok(Verdict::Unreached);
    }
    reaching.sort_by_key(|test| (!test.name.starts_with(&module), test.time));
    let mut spent = Duration::ZERO;
    for test in reaching {
        if spent > Duration::ZERO && spent + test.time > Duration::from_secs(seconds) {
            continue;
        }
        spent += test.time;
        let limit = Duration::from_secs(20).max(10 * test.time);
        let number = variant.number.to_string();
        if run_test(&test.program, &test.name, "SSCC_VARIANT", &number, limit)? != Outcome::Passed {
            return Ok(Verdict::Caught(test.name.clone()));
        }
    }
    Ok(Verdict::Passed)
}

/// Returns the module of a file, as names of tests begin.
fn module(file: &str) -> String {
    file.trim_end_matches(".rs").replace('/', "::")
}

/// Returns the folder of a file; the file itself if it is in none.
fn folder(file: &str) -> String {
    file.rsplit_once('/').map_or(file, |(folder, _)| folder).to_owned()
}

/// Counts variants, and what became of them, by folder.
fn counted(variants: &[Variant], verdicts: &[(String, Verdict)]) -> String {
    let mut rows: BTreeMap<String, [usize; 5]> = BTreeMap::new();
    for variant in variants {
        rows.entry(folder(&variant.file)).or_default()[0] += 1;
    }
    for (folder, verdict) in verdicts {
        let row = rows.entry(folder.clone()).or_default();
        row[1] += 1;
        let column = match verdict {
            Verdict::Caught(_) => 2,
            Verdict::Passed => 3,
            Verdict::Unreached => 4,
        };
        row[column] += 1;
    }
    let lines = rows.iter().map(|(folder, counts)| {
        let cells: Vec<String> = counts.iter().map(usize::to_string).collect();
        format!("{folder},{}\n", cells.join(","))
    });
    format!("{HEADER}\n{}", lines.collect::<String>())
}

/// Returns the rows of two records by folder: those of the later one, apart from folders of which it tried nothing.
fn merged(before: &str, later: &str) -> String {
    let rows = |record: &str| -> BTreeMap<String, String> {
        let rows = record
            .lines()
            .skip(1)
            .filter_map(|row| Some((row.split_once(',')?.0.to_owned(), row.to_owned())));
        rows.collect()
    };
    let mut all = rows(later);
    for (folder, row) in rows(before) {
        if all.get(&folder).is_none_or(|later| later.split(',').nth(2) == Some("0")) {
            all.insert(folder, row);
        }
    }
    let lines = all.into_values().map(|row| row + "\n").collect::<String>();
    format!("{HEADER}\n{lines}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variant(number: u32, file: &str) -> Variant {
        let (function, change) = ("f".to_owned(), "+ -> -".to_owned());
        Variant { number, file: file.to_owned(), line: 1, function, change }
    }

    #[test]
    fn a_seed_draws_the_same_variants() {
        let all: Vec<Variant> = (1..=50).map(|number| variant(number, "bounds/a.rs")).collect();
        let numbers = |seed, count| {
            let draw = Draw { count, seed, seconds: 1, paths: Vec::new() };
            drawn(&all, &draw).iter().map(|variant| variant.number).collect::<Vec<_>>()
        };
        assert_eq!(numbers(1, 10), numbers(1, 20)[..10]);
        assert_ne!(numbers(1, 10), numbers(2, 10));
        assert_eq!(numbers(1, 100).len(), 50);
        let only =
            |path: &str| Draw { count: 9, seconds: 1, paths: vec![path.to_owned()], ..Draw::default() };
        assert_eq!([only("bounds/"), only("filter/")].map(|draw| drawn(&all, &draw).len()), [9, 0]);
    }

    /// A run of some folders keeps the rows of the others.
    #[test]
    fn records_of_several_runs_are_one() {
        let before = format!("{HEADER}\na,9,9,8,1,0\nb,5,5,5,0,0\nd,1,1,1,0,0\n");
        let later = format!("{HEADER}\na,9,9,9,0,0\nb,5,0,0,0,0\nc,2,2,1,1,0\n");
        let expected = format!("{HEADER}\na,9,9,9,0,0\nb,5,5,5,0,0\nc,2,2,1,1,0\nd,1,1,1,0,0\n");
        assert_eq!(merged(&before, &later), expected);
        assert_eq!(merged("", &later), later);
    }

    #[test]
    fn verdicts_are_counted_by_folder() {
        let all = [variant(1, "bounds/a.rs"), variant(2, "bounds/b.rs"), variant(3, "query/hulls/c.rs")];
        let verdicts = [
            ("bounds".to_owned(), Verdict::Passed),
            ("bounds".to_owned(), Verdict::Caught("t".into())),
            ("query/hulls".to_owned(), Verdict::Unreached),
        ];
        assert_eq!(counted(&all, &verdicts), format!("{HEADER}\nbounds,2,2,1,1,0\nquery/hulls,1,1,0,0,1\n"));
        assert_eq!(
            (module("query/hulls/c.rs").as_str(), folder("a.rs").as_str()),
            ("query::hulls::c", "a.rs")
        );
    }
}
