//! `sscc-checker [--sample] MODEL [MODES] CERTIFICATES PROOF`: exit code 0 if the proof holds for all entries (with
//! `--sample`: for those that it has), 1 if not, 2 on other errors.

use std::env;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use sscc_checker::{Confirmed, Model, Refusal, check, read};

const USAGE: &str = "usage: sscc-checker [--sample] MODEL.model.safetensors CERTIFICATES PROOF
       sscc-checker [--sample] MESH.obj MODES.npy CERTIFICATES PROOF

--sample: a proof of some of the entries suffices.
Exit codes: 0 confirmed, 1 not confirmed (also a damaged proof), 2 a file cannot be read or is of another model, or the
model or the certificates are damaged";

fn run(paths: &[PathBuf], takes_sample: bool) -> Result<Confirmed, Refusal> {
    let (mesh, modes, certificates, proof): (&Path, Option<&Path>, _, _) = match paths {
        [mesh, certificates, proof] => (mesh, None, certificates, proof),
        [mesh, modes, certificates, proof] => (mesh, Some(modes), certificates, proof),
        _ => return Err(Refusal::Input("three or four files are needed: see sscc-checker --help".into())),
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let confirmed = check(&Model::read(mesh, modes)?, &read(certificates)?, &read(proof)?, threads)?;
    if takes_sample { Ok(confirmed) } else { confirmed.of_all_entries() }
}

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is the program")]
fn main() -> ExitCode {
    let words: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    if words == [Path::new("--help")] {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let takes_sample = words.first().is_some_and(|word| word == Path::new("--sample"));
    let refusal = match run(&words[usize::from(takes_sample)..], takes_sample) {
        Ok(confirmed) => {
            let Confirmed { entries, proven, left_out } = confirmed;
            println!("confirmed: {proven} of {entries} entries; left out: {left_out}");
            return ExitCode::SUCCESS;
        }
        Err(refusal) => refusal,
    };
    eprintln!("error: {refusal}");
    ExitCode::from(if matches!(refusal, Refusal::Proof(_)) { 1 } else { 2 })
}
