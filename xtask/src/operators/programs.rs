//! Runs single tests of the test programs, some at a time, and finds which variants each reaches.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use crate::program::{output, root};

/// How often a running test is looked at.
const INTERVAL: Duration = Duration::from_millis(5);

/// A test, which passes without a variant.
#[derive(Clone, Debug)]
pub struct Test {
    pub program: PathBuf,
    /// The name with its modules.
    pub name: String,
    pub time: Duration,
    /// The numbers of the variants that it reaches.
    pub reached: BTreeSet<u32>,
}

/// What a test did in its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Passed,
    Failed,
    /// It did not end.
    Endless,
}

/// Runs all tests of the programs without a variant. Returns those that end within a time.
pub fn tests(programs: &[PathBuf], time: Duration) -> Result<Vec<Test>, String> {
    let mut names: Vec<(PathBuf, String)> = Vec::new();
    for program in programs {
        let mut list = Command::new(program);
        let text = output(list.arg("--list").stdin(Stdio::null()), "the tests cannot be listed")?;
        let tests = text.lines().filter_map(|line| line.strip_suffix(": test"));
        names.extend(tests.map(|name| (program.clone(), name.to_owned())));
    }
    let tests = in_parallel(&names, |i, (program, name)| reach(i, program, name, time))?;
    let quick: Vec<Test> = tests.into_iter().flatten().collect();
    println!("{} of {} tests end within {} s", quick.len(), names.len(), time.as_secs());
    Ok(quick)
}

/// Calls a function for all items and their places, on all processors. Returns the results in the order of the items.
pub fn in_parallel<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(usize, &T) -> Result<R, String> + Sync,
) -> Result<Vec<R>, String> {
    let (next, results) = (Mutex::new(items.iter().enumerate()), Mutex::new(Vec::new()));
    let worker = || -> Result<(), String> {
        loop {
            let item = next.lock().map_err(|error| error.to_string())?.next();
            let Some((i, item)) = item else { return Ok(()) };
            let result = work(i, item)?;
            results.lock().map_err(|error| error.to_string())?.push((i, result));
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().map_err(|_| "a worker panicked".to_owned())?)
    })?;
    let mut results = results.into_inner().map_err(|error| error.to_string())?;
    results.sort_by_key(|(i, _)| *i);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

/// Runs a test, and records the variants that it reaches. Returns none if the test needs more than a time.
fn reach(i: usize, program: &Path, name: &str, time: Duration) -> Result<Option<Test>, String> {
    let record = root().join(format!("target/operators/reached-{i}"));
    fs::write(&record, "").map_err(|error| format!("{}: {error}", record.display()))?;
    let start = Instant::now();
    let outcome = run(program, name, "SSCC_REACHED", &record.to_string_lossy(), time)?;
    let time = start.elapsed();
    let numbers = fs::read_to_string(&record).map_err(|error| format!("{}: {error}", record.display()))?;
    match outcome {
        Outcome::Failed => Err(format!("{name} fails without a variant")),
        Outcome::Endless => Ok(None),
        Outcome::Passed => {
            let reached = numbers.lines().filter_map(|number| number.parse().ok()).collect();
            Ok(Some(Test { program: program.into(), name: name.into(), time, reached }))
        }
    }
}

/// Runs a test with a variable of the environment, and ends it after a time.
pub fn run(
    program: &Path,
    test: &str,
    variable: &str,
    value: &str,
    time: Duration,
) -> Result<Outcome, String> {
    let mut command = Command::new(program);
    command.args(["--exact", test]).env(variable, value).env("RUST_TEST_THREADS", "1");
    command.env("CARGO_MANIFEST_DIR", root().join("target/operators/workspace/crates/sscc"));
    command.current_dir(root().join("target/operators/workspace/crates/sscc"));
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().map_err(|error| format!("{}: {error}", program.display()))?;
    wait(&mut child, time).map_err(|error| format!("{test}: {error}"))
}

fn wait(child: &mut Child, time: Duration) -> std::io::Result<Outcome> {
    let start = Instant::now();
    while start.elapsed() < time {
        if let Some(status) = child.try_wait()? {
            return Ok(if status.success() { Outcome::Passed } else { Outcome::Failed });
        }
        thread::sleep(INTERVAL);
    }
    child.kill()?;
    child.wait()?;
    Ok(Outcome::Endless)
}

#[cfg(test)]
mod tests {
    use super::in_parallel;

    #[test]
    fn results_have_the_order_of_the_items() {
        let items: Vec<usize> = (10..60).collect();
        assert_eq!(in_parallel(&items, |i, item| Ok(item - i)).unwrap(), [10; 50]);
        assert_eq!(in_parallel(&items, |_, _| Err::<(), _>("no".to_owned())).unwrap_err(), "no");
    }
}
