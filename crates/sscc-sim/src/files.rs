//! The files of a simulation beside its states.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use crate::error::{InSystem, Result};

/// The files that a simulation writes into its folder, in this order.
pub const OUTPUT_FILES: [&str; 7] = [
    "summary.json",
    "report.html",
    "trajectories.npz",
    "costs.npz",
    "animation.glb",
    "sound.wav",
    "sound_float.wav",
];

/// Removes the files of an earlier simulation, so that none of them is taken for one of the new simulation.
pub fn remove_outputs(folder: &Path) -> Result<()> {
    OUTPUT_FILES.iter().try_for_each(|name| remove_file(&folder.join(name)))
}

/// Removes a file, if it is there.
pub fn remove_file(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error).system(path),
        _ => Ok(()),
    }
}
