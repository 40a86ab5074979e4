//! `sscc-checker MODEL [MODES] CERTIFICATES PROOF`: exit code 0 if the proof holds, 1 if it does not, 2 on other errors.

use std::env;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use sscc_checker::{Confirmed, Model, Refusal, check, read};

const USAGE: &str = "usage: sscc-checker MODEL.model.safetensors CERTIFICATES PROOF
       sscc-checker MESH.obj MODES.npy CERTIFICATES PROOF";

fn run(paths: &[PathBuf]) -> Result<Confirmed, Refusal> {
    let (mesh, modes, certificates, proof): (&Path, Option<&Path>, _, _) = match paths {
        [mesh, certificates, proof] => (mesh, None, certificates, proof),
        [mesh, modes, certificates, proof] => (mesh, Some(modes), certificates, proof),
        _ => return Err(Refusal::Input(USAGE.into())),
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    check(&Model::read(mesh, modes)?, &read(certificates)?, &read(proof)?, threads)
}

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is the program")]
fn main() -> ExitCode {
    let paths: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let refusal = match run(&paths) {
        Ok(Confirmed { entries, proven }) => {
            println!("confirmed: {proven} of {entries} entries");
            return ExitCode::SUCCESS;
        }
        Err(refusal) => refusal,
    };
    eprintln!("error: {refusal}");
    ExitCode::from(if matches!(refusal, Refusal::Proof(_)) { 1 } else { 2 })
}
