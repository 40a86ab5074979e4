//! Names and removal of the files that a simulation writes beside its states.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use crate::error::{InSystem, Result};

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

/// Removes the files of an earlier simulation, so that a user cannot mistake them for files of the new one.
pub fn remove_outputs(folder: &Path) -> Result<()> {
    OUTPUT_FILES.iter().try_for_each(|name| remove_file(&folder.join(name)))
}

/// Removes a file if it exists.
pub fn remove_file(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error).system(path),
        _ => Ok(()),
    }
}
