//! Names of the files that a simulation writes to its folder, their removal, and checks that files of others are not lost.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use serde_json::Value;
use sscc_io::{Message, Setting, check_replaceable, has_file, is_folder_of_mesh, linked_file, read_whole};

use crate::error::{InSystem, Result, SimError};

/// Files that a simulation writes into its folder, in the order in which they are listed and their errors are reported.
pub const OUTPUT_FILES: [&str; 7] = [
    "summary.json",
    "report.html",
    "trajectories.npz",
    "costs.npz",
    "animation.glb",
    "sound.wav",
    "sound_float.wav",
];

/// The states of a simulation.
pub const LOG: &str = "states.log";

/// The data from which a simulation continues.
pub const CHECKPOINT: &str = "checkpoint.bin";

/// Size of the hash of all bytes before it, with which a checkpoint ends (bytes).
const SEAL: usize = 32;

/// Keys of every summary. Together they are in no file of another program.
const SUMMARY_KEYS: [&str; 4] = ["scene_steps", "body_steps", "colliding_body_steps", "self_collision_share"];

/// Removes the files of an earlier simulation, so that a user cannot mistake them for files of the new one.
pub fn remove_outputs(folder: &Path) -> Result<()> {
    OUTPUT_FILES.iter().try_for_each(|name| remove_file(&folder.join(name)))
}

/// Removes a file if it exists. A link stays, and the file to which it leads is removed.
pub fn remove_file(path: &Path) -> Result<()> {
    match fs::remove_file(linked_file(path)?) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error).system(path),
        _ => Ok(()),
    }
}

/// Returns an error if a file of a simulation cannot be written or removed later: it is read-only or no file, or the folder is
/// read-only.
pub fn check_outputs(folder: &Path) -> Result<()> {
    let names = OUTPUT_FILES.iter().chain(&[LOG, CHECKPOINT]);
    Ok(names.map(|name| folder.join(name)).try_for_each(|path| check_replaceable(&path))?)
}

/// Returns an error if a simulation in this folder would replace or remove one of these inputs, each a file, `FILE#NAME` or a
/// folder of meshes, or would add a mesh to such a folder. Links are followed.
pub fn check_inputs(folder: &Path, inputs: &[PathBuf]) -> Result<()> {
    for name in OUTPUT_FILES.iter().chain(&[LOG, CHECKPOINT]) {
        let path = folder.join(name);
        let target = linked_file(&path)?;
        if inputs.iter().any(|input| is_folder_of_mesh(input, &path) || is_folder_of_mesh(input, &target)) {
            let cause = "would be a mesh of a folder that the scene reads: choose another folder with ";
            return Err(SimError::refused(path.display(), Message::from(cause) + Setting::Out));
        }
        let Ok(real) = fs::canonicalize(&path) else { continue }; // there is no such file
        if inputs.iter().any(|input| has_file(input, &real)) {
            let cause = "is an input of the scene: choose another folder with " + Setting::Out;
            return Err(SimError::refused(path.display(), cause));
        }
    }
    Ok(())
}

/// Returns an error if the folder is not that of an earlier simulation, and has a file that a simulation would replace or
/// remove. [`StateLog`](crate::StateLog) itself checks a log that is not empty.
pub fn check_others(folder: &Path) -> Result<()> {
    let log = folder.join(LOG);
    if fs::metadata(log).is_ok_and(|log| log.len() > 0) {
        return Ok(());
    }
    let checkpoint = folder.join(CHECKPOINT);
    if fs::symlink_metadata(&checkpoint).is_ok() {
        return if is_checkpoint(&checkpoint) { Ok(()) } else { Err(of_others(&checkpoint)) };
    }
    match output_of_others(folder) {
        Some(path) => Err(of_others(&path)),
        None => Ok(()),
    }
}

/// Returns a file with the name of an output, if the folder has one and not the results of a simulation.
pub fn output_of_others(folder: &Path) -> Option<PathBuf> {
    let exists = |path: &PathBuf| fs::symlink_metadata(path).is_ok();
    let output = OUTPUT_FILES.iter().map(|name| folder.join(name)).find(exists);
    output.filter(|_| !has_results(folder))
}

/// Returns the error for a file that no simulation wrote.
pub fn of_others(path: &Path) -> SimError {
    let cause = "exists and is not of a simulation: choose another folder with " + Setting::Out;
    SimError::refused(path.display(), cause + ", or move it away")
}

/// Returns the content of a checkpoint before its seal; None if the bytes are not those of a whole checkpoint.
pub fn unsealed(bytes: &[u8]) -> Option<&[u8]> {
    let (content, seal) = bytes.split_at_checked(bytes.len().checked_sub(SEAL)?)?;
    (blake3::hash(content).as_bytes() == seal).then_some(content)
}

/// Whether a file is a whole checkpoint of any simulation.
pub fn is_checkpoint(path: &Path) -> bool {
    // A file of others can be large: it is not kept in memory. A pipe is not opened.
    let is_sealed = || -> std::io::Result<bool> {
        let found = fs::metadata(path)?;
        let Some(content) = found.len().checked_sub(SEAL as u64).filter(|_| found.is_file()) else {
            return Ok(false);
        };
        let (mut file, mut hasher, mut seal) = (File::open(path)?, blake3::Hasher::new(), [0; SEAL]);
        hasher.update_reader(Read::by_ref(&mut file).take(content))?;
        file.read_exact(&mut seal)?;
        Ok(*hasher.finalize().as_bytes() == seal)
    };
    is_sealed().unwrap_or(false)
}

/// Whether the folder has summary and costs of a simulation. They stay when a user removes its log, which is large.
fn has_results(folder: &Path) -> bool {
    let has_costs = folder.join("costs.npz").is_file();
    has_costs && read_whole(&folder.join("summary.json")).is_ok_and(|json| is_summary(&json))
}

fn is_summary(json: &[u8]) -> bool {
    serde_json::from_slice::<Value>(json)
        .is_ok_and(|summary| SUMMARY_KEYS.iter().all(|key| summary.get(key).is_some()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the files of a folder with their content.
    fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
        let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut found: Vec<_> = paths.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
        found.sort();
        found
    }

    #[test]
    fn files_of_others_are_refused_and_stay() {
        for name in OUTPUT_FILES.iter().chain(&[CHECKPOINT]) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            fs::write(&path, b"{\"scene_steps\": 1}").unwrap();
            let before = contents(folder.path());
            let message = check_others(folder.path()).unwrap_err().to_string();
            let cause = "exists and is not of a simulation: choose another folder with out, or move it away";
            assert_eq!(message, format!("{}: {cause}", path.display()));
            // An empty log proves nothing.
            fs::write(folder.path().join(LOG), b"").unwrap();
            assert!(check_others(folder.path()).is_err(), "{name}");
            fs::remove_file(folder.path().join(LOG)).unwrap();
            assert_eq!(contents(folder.path()), before);
        }
    }

    #[test]
    fn folders_of_simulations_are_accepted() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
        let accepted = || check_others(folder.path()).is_ok();
        assert!(accepted() && check_others(&folder.path().join("none")).is_ok());
        write("notes.txt", b"x");
        write(LOG, b"");
        assert!(accepted());
        // The summary and the costs, in place of the log.
        write("report.html", b"x");
        let summary = SUMMARY_KEYS.map(|key| format!("\"{key}\": 0")).join(", ");
        write("summary.json", format!("{{{summary}}}").as_bytes());
        assert!(!accepted());
        write("costs.npz", b"PK");
        assert!(accepted());
        write("summary.json", b"[1, 2]");
        assert!(!accepted());
        // A checkpoint with its seal.
        let sealed = [b"content", &blake3::hash(b"content").as_bytes()[..]].concat();
        write(CHECKPOINT, &sealed);
        assert!(accepted());
        write(CHECKPOINT, &sealed[1..]);
        assert!(!accepted());
        assert_eq!((unsealed(&sealed), unsealed(&sealed[..31])), (Some(&b"content"[..]), None));
    }

    #[test]
    fn inputs_are_refused_wherever_they_lead() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("out")).unwrap();
        for name in ["model.glb", "out/animation.glb", "out/states.log"] {
            fs::write(at(name), b"x").unwrap();
        }
        let check = |input: &str| check_inputs(&at("out"), &[at("none"), at(input)]);
        for (input, name) in [
            ("out/animation.glb", "animation.glb"),
            ("out/../out/animation.glb#Body", "animation.glb"),
            ("out/states.log", "states.log"),
        ] {
            let message = check(input).unwrap_err().to_string();
            let path = at("out").join(name);
            let expected = "is an input of the scene: choose another folder with out";
            assert_eq!(message, format!("{}: {expected}", path.display()));
        }
        assert!(check("model.glb").is_ok() && check("out/sound.wav").is_ok());
        // A folder that the scene reads would get another mesh.
        fs::remove_file(at("out/animation.glb")).unwrap();
        let message = check_inputs(&at("out"), &[at("out")]).unwrap_err().to_string();
        let cause = "would be a mesh of a folder that the scene reads: choose another folder with out";
        assert_eq!(message, format!("{}: {cause}", at("out/animation.glb").display()));
        assert!(check_inputs(&at("other"), &[at("out")]).is_ok());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("model.glb"), at("out/sound.wav")).unwrap();
            assert!(check("model.glb").unwrap_err().to_string().contains("sound.wav: is an input"), "a link");
            fs::create_dir(at("targets")).unwrap();
            std::os::unix::fs::symlink(at("targets/new.glb"), at("out/animation.glb")).unwrap();
            assert!(check("targets").unwrap_err().to_string().contains("animation.glb: would be a mesh"));
        }
    }
}
