//! The record of fuzzing: inputs and seconds of each target, which runs add to.

use std::fs;
use std::path::PathBuf;

use crate::program::root;

/// The record that documents show, relative to the root.
const RECORD: &str = "docs/records/fuzzing.csv";

const HEADER: &str = "target,inputs,seconds,failures";

/// A run of a target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ran {
    pub inputs: u64,
    pub seconds: u64,
}

/// Returns the number of inputs from a line `stat::number_of_executed_units: 12` of libFuzzer.
pub fn inputs_of(line: &str) -> Option<u64> {
    line.strip_prefix("stat::number_of_executed_units:")?.trim().parse().ok()
}

/// Adds a run of a target to the record.
pub fn add(target: &str, ran: Ran, failed: bool) -> Result<(), String> {
    let path: PathBuf = root().join(RECORD);
    let text = fs::read_to_string(&path).map_err(|error| format!("{RECORD}: {error}"))?;
    fs::write(&path, added(&text, target, ran, failed)?).map_err(|error| format!("{RECORD}: {error}"))
}

fn added(text: &str, target: &str, ran: Ran, failed: bool) -> Result<String, String> {
    let mut rows: Vec<(String, [u64; 3])> = Vec::new();
    for line in text.lines().skip(1) {
        let mut cells = line.split(',');
        let name = cells.next().unwrap_or_default().to_owned();
        let numbers: Result<Vec<u64>, _> = cells.map(str::parse).collect();
        let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
        rows.push((
            name,
            numbers.ok_or_else(|| format!("{RECORD}: not a target and three numbers: {line}"))?,
        ));
    }
    let at = rows.iter().position(|(name, _)| name == target).unwrap_or_else(|| {
        rows.push((target.to_owned(), [0; 3]));
        rows.len() - 1
    });
    let counts = &mut rows[at].1;
    for (count, more) in counts.iter_mut().zip([ran.inputs, ran.seconds, u64::from(failed)]) {
        *count += more;
    }
    rows.sort();
    let lines = rows
        .iter()
        .map(|(name, [inputs, seconds, failures])| format!("{name},{inputs},{seconds},{failures}\n"));
    Ok(format!("{HEADER}\n{}", lines.collect::<String>()))
}

#[cfg(test)]
mod tests {
    use super::{Ran, added, inputs_of};

    #[test]
    fn runs_are_added_to_the_record() {
        assert_eq!(inputs_of("stat::number_of_executed_units: 12"), Some(12));
        assert_eq!(inputs_of("stat::new_units_added: 12"), None);
        let ran = Ran { inputs: 12, seconds: 5 };
        let text = "target,inputs,seconds,failures\nb,1,2,0\n";
        assert_eq!(added(text, "b", ran, true).unwrap(), "target,inputs,seconds,failures\nb,13,7,1\n");
        assert_eq!(
            added(text, "a", ran, false).unwrap(),
            "target,inputs,seconds,failures\na,12,5,0\nb,1,2,0\n"
        );
        assert!(added("target\nb,1,2\n", "b", ran, false).unwrap_err().contains("b,1,2"));
    }
}
