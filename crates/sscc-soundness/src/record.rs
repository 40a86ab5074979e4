//! The counters of a campaign on disk, one line for each path, so that a campaign can resume. A file is replaced as a whole,
//! so that it is never half written.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path as File;

use crate::paths::PATHS;
use crate::tally::Tally;

/// The first line.
const HEADER: &str = "path,wanted,done,false negatives,wrong,configurations,seconds,seed,reached";

/// The counters of all paths.
#[derive(Clone, Debug)]
pub struct Record {
    /// The seed from which the seeds of all configurations follow.
    pub seed: u64,
    /// The counters of each path, in the order of [`PATHS`].
    pub paths: Vec<PathRecord>,
}

/// The counters of a path.
#[derive(Clone, Debug, Default)]
pub struct PathRecord {
    /// The counters.
    pub tally: Tally,
    /// Number of configurations that were run. It is the number of the next configuration.
    pub configurations: u64,
    /// Processor time of these configurations (s).
    pub seconds: f64,
}

impl Record {
    /// Creates a record without counts.
    pub fn new(seed: u64) -> Self {
        Self { seed, paths: PATHS.iter().map(|_| PathRecord::default()).collect() }
    }

    /// Reads a record. Returns a new one if the file does not exist.
    ///
    /// # Errors
    /// A message of one line if the file cannot be read, is not a record, or has another seed than the given one.
    pub fn read(file: &File, seed: Option<u64>) -> Result<Self, String> {
        let name = file.display();
        let text = match fs::read_to_string(file) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Self::new(seed.unwrap_or(1)));
            }
            Err(error) => return Err(format!("{name}: {error}")),
        };
        let record = Self::parse(&text)
            .map_err(|error| format!("{name}: {error}; remove the file to begin a new record"))?;
        match seed {
            Some(seed) if seed != record.seed => Err(format!(
                "{name}: its seed is {}, not {seed}; choose another file with --record",
                record.seed
            )),
            _ => Ok(record),
        }
    }

    fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text.lines();
        if lines.next() != Some(HEADER) {
            return Err("the first line is not the header of a record".to_owned());
        }
        let mut record = Self::new(0);
        for (number, line) in lines.enumerate() {
            let place = || format!("line {}", number + 2);
            let (seed, name, path) = parse_line(line).ok_or_else(place)?;
            let index = PATHS.iter().position(|path| path.name == name);
            record.paths[index.ok_or_else(|| format!("{}: no path has the name '{name}'", place()))?] = path;
            record.seed = seed;
        }
        Ok(record)
    }

    /// Writes the record beside the file, and renames it.
    ///
    /// # Errors
    /// A message of one line with the file and the cause.
    pub fn write(&self, file: &File) -> Result<(), String> {
        let part = file.with_extension("part");
        let write = || -> std::io::Result<()> {
            if let Some(folder) = file.parent() {
                fs::create_dir_all(folder)?;
            }
            let mut out = fs::File::create(&part)?;
            out.write_all(self.text().as_bytes())?;
            out.sync_all()?;
            fs::rename(&part, file)
        };
        write().map_err(|error| format!("{}: {error}", file.display()))
    }

    fn text(&self) -> String {
        let mut text = format!("{HEADER}\n");
        for (path, PathRecord { tally, configurations, seconds }) in PATHS.iter().zip(&self.paths) {
            let reached: Vec<String> =
                tally.reached.iter().map(|(name, count)| format!("{name}: {count}")).collect();
            text += &format!(
                "{},{},{},{},{},{configurations},{seconds:.0},{},{}\n",
                path.name,
                path.wanted,
                tally.done,
                tally.false_negatives,
                tally.wrong,
                self.seed,
                reached.join("; ")
            );
        }
        text
    }

    /// Returns a table for people.
    pub fn table(&self) -> String {
        let mut table = format!(
            "{:<15} {:>10} {:>10} {:>6} {:>6} {:>8}\n",
            "path", "wanted", "done", "missed", "wrong", "seconds"
        );
        for (path, PathRecord { tally, seconds, .. }) in PATHS.iter().zip(&self.paths) {
            let Tally { done, false_negatives, wrong, reached, .. } = tally;
            let (name, wanted) = (path.name, path.wanted);
            table += &format!(
                "{name:<15} {wanted:>10} {done:>10} {false_negatives:>6} {wrong:>6} {seconds:>8.0}\n"
            );
            reached.iter().for_each(|(name, count)| table += &format!("{:17}{name}: {count}\n", ""));
            let missing = path.inner.iter().filter(|name| !reached.contains_key(**name));
            missing.for_each(|name| table += &format!("{:17}NOT REACHED: {name}\n", ""));
        }
        table
    }
}

fn parse_line(line: &str) -> Option<(u64, &str, PathRecord)> {
    let fields: Vec<&str> = line.splitn(9, ',').collect();
    let [name, _, done, false_negatives, wrong, configurations, seconds, seed, reached] = fields[..] else {
        return None;
    };
    let count = |text: &str| text.parse::<u64>().ok();
    let pair = |text: &str| -> Option<(String, u64)> {
        let (name, number) = text.rsplit_once(": ")?;
        Some((name.to_owned(), count(number)?))
    };
    let reached: Option<BTreeMap<String, u64>> =
        reached.split("; ").filter(|text| !text.is_empty()).map(pair).collect();
    let tally = Tally {
        done: count(done)?,
        false_negatives: count(false_negatives)?,
        wrong: count(wrong)?,
        reached: reached?,
        messages: Vec::new(),
    };
    let path = PathRecord { tally, configurations: count(configurations)?, seconds: seconds.parse().ok()? };
    Some((count(seed)?, name, path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_record_is_read_back_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new/record.csv");
        let mut record = Record::read(&file, Some(7)).unwrap();
        record.paths[3].tally.answer();
        record.paths[3].tally.reach("active pairs");
        record.paths[3].configurations = 5;
        record.write(&file).unwrap();
        let again = Record::read(&file, None).unwrap();
        assert_eq!((again.seed, again.text()), (7, record.text()));
        assert!(!file.with_extension("part").exists());
        assert!(Record::read(&file, Some(8)).unwrap_err().contains("its seed is 7"));
        fs::write(&file, "other\n").unwrap();
        assert!(Record::read(&file, None).unwrap_err().ends_with("remove the file to begin a new record"));
        fs::write(&file, format!("{HEADER}\ndiscrete,1\n")).unwrap();
        assert!(Record::read(&file, None).unwrap_err().contains("line 2"));
    }

    #[test]
    fn the_table_lists_inner_paths_that_were_not_reached() {
        let table = Record::new(1).table();
        assert!(table.contains("NOT REACHED: active pairs"), "{table}");
    }
}
