//! The campaign in short form: every path is clean and reaches its most important inner paths. A configuration can be run
//! again by its number.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::time::Duration;

use sscc_soundness::{Campaign, PATHS, replay, run, run_quick};

/// Number of configurations of each path.
const CONFIGURATIONS: u64 = 4;

/// Inner paths that this number of configurations reaches.
const REACHED: [(&str, &str); 9] = [
    ("triangle-pairs", "touching"),
    ("triangle-pairs", "shared vertex"),
    ("moving-pairs", "impact checked"),
    ("moving-pairs", "proven free"),
    ("discrete", "proof by search"),
    ("kinetic", "searches"),
    ("continuous", "pairs attacked"),
    ("posed", "two meshes"),
    ("frames", "swept"),
];

#[test]
fn every_path_is_clean() {
    let mut failures = String::new();
    let record = run_quick(1, None, CONFIGURATIONS, |lines| failures += lines).unwrap();
    assert!(failures.is_empty(), "{failures}");
    for (path, counters) in PATHS.iter().zip(&record.paths) {
        assert!(counters.tally.done > 0 && counters.tally.is_clean(), "{}\n{}", path.name, record.table());
    }
    for (name, inner) in REACHED {
        let index = PATHS.iter().position(|path| path.name == name).unwrap();
        assert!(record.paths[index].tally.reached.contains_key(inner), "{name}: {inner}\n{}", record.table());
    }
}

#[test]
fn a_campaign_resumes_and_a_configuration_can_be_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("record.csv");
    let path = Some("triangle-pairs".to_owned());
    let campaign = Campaign { time: Some(Duration::from_millis(1)), seed: Some(3), record: file, path };
    let done = |campaign: &Campaign| {
        let record = run(campaign, |_| ()).unwrap();
        (record.paths[0].configurations, record.paths[0].tally.done)
    };
    let first = done(&campaign);
    let second = done(&Campaign { seed: None, ..campaign.clone() });
    assert!(first.0 > 0 && second.0 > first.0 && second.1 > first.1);
    let again = replay("triangle-pairs", 3, 0).unwrap();
    assert!(again.is_clean() && again.done <= second.1);
    assert!(run(&Campaign { seed: Some(4), ..campaign }, |_| ()).unwrap_err().contains("its seed is 3"));
    assert!(replay("no path", 1, 0).unwrap_err().contains("the paths are: triangle-pairs, "));
}
