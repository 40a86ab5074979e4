//! `sscc-checker [--sample] MODEL [MODES] CERTIFICATES PROOF`: exit code 0 if the proof holds for all entries (with
//! `--sample`: for those that it has, if these state something), 1 if not, 2 on other errors, also if the answer cannot be
//! written.

use std::env;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use sscc_checker::{Confirmed, Model, Refusal, Result, check, read};

const USAGE: &str = "usage: sscc-checker [--sample] MODEL.model.safetensors CERTIFICATES PROOF
       sscc-checker [--sample] MESH.obj MODES.npy CERTIFICATES PROOF

--sample: a proof of some of the entries suffices, at least one with a positive radius. Whoever writes the proof chooses
them, so a sample says nothing about the other entries. `sscc audit --exact` draws a sample of its own.
Exit codes: 0 confirmed, 1 not confirmed (also a damaged or empty proof, or a wrong hierarchy, radius, pair tree or
exception in the certificates), 2 a file cannot be read, is of another kind, or of another model or other certificates,
a seal does not match, the metric is out of range, or the answer cannot be written";

/// The exit code of errors.
const ERROR: u8 = 2;

fn run(paths: &[PathBuf], takes_sample: bool) -> Result<Confirmed> {
    let (mesh, modes, certificates, proof): (&Path, Option<&Path>, _, _) = match paths {
        [mesh, certificates, proof] => (mesh, None, certificates, proof),
        [mesh, modes, certificates, proof] => (mesh, Some(modes), certificates, proof),
        _ => return Err(Refusal::Input("three or four files are needed: see sscc-checker --help".into())),
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let confirmed = check(&Model::read(mesh, modes)?, &read(certificates)?, &read(proof)?, threads)?;
    if takes_sample { confirmed.of_sample() } else { confirmed.of_all_entries() }
}

/// Writes a line. Returns the exit code of the answer if that succeeds or the reader has closed the pipe, else that of
/// errors.
fn write(mut stream: impl Write, line: &str, code: u8) -> u8 {
    match writeln!(stream, "{line}").and_then(|()| stream.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => ERROR,
        _ => code,
    }
}

fn main() -> ExitCode {
    let words: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    if words == [Path::new("--help")] {
        return write(io::stdout(), USAGE, 0).into();
    }
    let takes_sample = words.first().is_some_and(|word| word == Path::new("--sample"));
    let code = match run(&words[usize::from(takes_sample)..], takes_sample) {
        Ok(confirmed) => write(io::stdout(), &confirmed.to_string(), 0),
        Err(refusal) => {
            let code = if matches!(refusal, Refusal::Proof(_)) { 1 } else { ERROR };
            write(io::stderr(), &format!("error: {refusal}"), code)
        }
    };
    code.into()
}
