//! `cargo xtask lemmas`: proves the rounding lemmas in docs/proofs with Gappa, and checks that Gappa refuses a wrong variant
//! of each.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

use crate::debian;
use crate::program::root;
use crate::tally::{SkipLog, Tally};

/// The program, and its Debian package.
const GAPPA: &str = "gappa";
/// Binary digits of Gappa's own numbers: lemmas compare numbers that differ by a few times 2^-53.
const PRECISION: &str = "-Eprecision=150";

/// Lemmas, and a change of each that makes it wrong.
const LEMMAS: [(&str, &str, &str); 2] =
    [("norm.g", "2 * t + 20b-53", "2 * t - 8b-53"), ("quotient.g", "1 - 8b-52", "1 - 1b-53")];

/// Proves all lemmas.
pub fn run(_: &[String]) -> ExitCode {
    let log = SkipLog::new();
    let tally = test(log.path(), true);
    log.conclude(tally)
}

/// Proves all lemmas, as a part of all tests. With `install`, installs Gappa if it is missing.
pub fn test(log: &Path, install: bool) -> Tally {
    println!("== Lemmas");
    if install && !debian::has(GAPPA) {
        debian::install(&[GAPPA]);
    }
    if !debian::has(GAPPA) {
        return SkipLog::skip(log, "the lemmas of docs/proofs", "gappa is not installed (Debian's gappa)");
    }
    let mut tally = Tally::default();
    for (name, right, wrong) in LEMMAS {
        let text = fs::read_to_string(root().join("docs/proofs").join(name)).unwrap_or_default();
        let changed = text.replace(right, wrong);
        let outcome = [text.as_str(), changed.as_str()].map(is_proven);
        let is_fine = outcome == [Some(true), Some(false)] && changed != text;
        println!("{name}: {}", if is_fine { "proven" } else { "NOT PROVEN, or proven where it is wrong" });
        tally += Tally { passed: u64::from(is_fine), failed: u64::from(!is_fine) };
    }
    tally
}

/// Whether Gappa proves a text; None if Gappa cannot be run.
fn is_proven(text: &str) -> Option<bool> {
    let mut gappa = Command::new(GAPPA);
    gappa.arg(PRECISION).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = gappa.spawn().ok()?;
    child.stdin.take()?.write_all(text.as_bytes()).ok()?;
    Some(child.wait().ok()?.success())
}
