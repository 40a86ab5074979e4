//! The output that docs/command.md shows for the Stanford bunny is that of the command, apart from times.

use std::fs;
use std::path::Path;

use sscc_io::write_npy;
use sscc_testing::models;

use crate::common::sscc;

/// Returns the commands in the first block of text of a section of the guide: for each the words after `$ sscc`, and
/// the lines below.
fn samples(section: &str) -> Vec<(Vec<&str>, Vec<&str>)> {
    let text = section.split_once("```text\n").unwrap().1.split_once("```").unwrap().0;
    let blocks = text.split("$ sscc ").skip(1).map(|block| block.split_once('\n').unwrap());
    blocks.map(|(words, lines)| (words.split(' ').collect(), lines.trim_end().lines().collect())).collect()
}

/// Replaces times and the number of threads, each with its unit, by `T T`.
fn without_times(line: &str) -> String {
    let mut words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
    for at in 1..words.len() {
        let is_number = words[at - 1].parse::<f64>().is_ok();
        let is_unit = ["ns", "us", "ms", "s"].contains(&words[at].trim_end_matches([';', ',']));
        if is_number && (is_unit || words[at] == "threads") {
            words[at - 1] = "T".into();
            words[at] = "T".into();
        }
    }
    words.join(" ")
}

/// Whether a JSON line is that of the sample, apart from its time. The sample has `...` in place of the pairs after the
/// first ones.
fn is_json_line(sample: &str, line: &str) -> bool {
    let (start, end) = sample.split_once("...").unwrap();
    let parts = |text: &str| {
        let (before, rest) = text.split_once("\"microseconds\":").unwrap();
        [before.to_owned(), rest.split_once(',').unwrap().1.to_owned()]
    };
    let ([pairs, cost], [_, expected]) = (parts(line), parts(end));
    pairs.starts_with(start) && cost == expected
}

#[test]
fn the_guide_shows_the_output_for_the_bunny() {
    let Some(folder) = models("the_guide_shows_the_output_for_the_bunny") else { return };
    let guide =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/command.md")).unwrap();
    let (_, section) = guide.split_once("## On the Stanford bunny").unwrap();
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    fs::copy(folder.join("bunny_14964_closed.obj"), here.join("bunny.obj")).unwrap();
    // The array of the guide: np.linspace for mode 6, and minus half of it for mode 13.
    let mut q = vec![0.0; 100 * 24];
    for row in 0..100 {
        let weight = if row == 99 { 0.006 } else { row as f64 * (0.006 / 99.0) };
        (q[24 * row + 6], q[24 * row + 13]) = (weight, -weight / 2.0);
    }
    write_npy(&here.join("q.npy"), &[100, 24], &q).unwrap();
    let samples = samples(section);
    assert_eq!(
        samples.iter().map(|(words, _)| words[0]).collect::<Vec<_>>(),
        ["modes", "certify", "check", "check", "audit", "info"]
    );
    for (words, expected) in samples {
        let (args, is_last_line) = match words.iter().position(|word| *word == "|") {
            Some(at) => (&words[..at], true),
            None => (&words[..], false),
        };
        let run = sscc(here, args);
        assert_eq!((run.code, run.stderr.as_str()), (Some(i32::from(args[0] == "check")), ""), "{args:?}");
        let mut lines = run.stdout.lines();
        if is_last_line {
            let last = lines.next_back().unwrap();
            assert!(is_json_line(expected[0], last) && expected.len() == 1, "{args:?}: {last}");
            continue;
        }
        // Rows of a trajectory before the first one of the sample, and those at `...`, are left out.
        let mut is_left_out = args[0] == "check";
        for sample in expected {
            if sample == "..." {
                is_left_out = true;
                continue;
            }
            let wanted = without_times(sample);
            let found = if is_left_out {
                lines.find(|line| without_times(line) == wanted)
            } else {
                lines.next().filter(|line| without_times(line) == wanted)
            };
            assert!(found.is_some(), "{args:?} does not print there: {sample}");
            is_left_out = false;
        }
        assert_eq!(lines.next(), None, "{args:?}");
    }
}
