//! Simulations, as `sscc simulate` makes them: for programs that are not the command.

use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::args::{Json, Simulate, Threads};
use crate::commands::simulate::{Simulated, simulated};
use crate::interrupt;

/// What to simulate; as the arguments of the command.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// A scene file, or the name of a scene that comes with the program.
    pub scene: PathBuf,
    /// The folder to write to; none: the scene's name.
    pub out: Option<PathBuf>,
    /// How many steps to make from the beginning; none: those of the scene.
    pub steps: Option<u32>,
    /// Begin again, whatever the folder holds.
    pub restart: bool,
    /// The folder of the real models.
    pub models: Option<PathBuf>,
    /// Where models and certificates are kept from one run to the next.
    pub cache: Option<PathBuf>,
    /// Number of threads; none: all cores.
    pub threads: Option<u32>,
}

/// What a simulation came to.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Written {
    /// The object that the command prints with `--json`.
    pub summary: String,
    /// The folder, and what was written to it.
    pub folder: PathBuf,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Simulates a scene. Nothing is printed but a progress bar, where standard error is a terminal. One at a time in each
/// process, since [`stop`] stops all.
///
/// # Errors
/// When the scene or a model cannot be read, the folder cannot be written to, the motion diverges, or it was stopped.
pub fn simulate(request: Request) -> Result<Written> {
    let Request { scene, out, steps, restart, models, cache, threads } = request;
    let threads = Threads { threads };
    let arguments =
        Simulate { scene, out, steps, restart, models, cache, threads, json: Json { json: true } };
    let Simulated { summary, folder, files, .. } = simulated(&arguments)?.whole()?;
    let summary = serde_json::to_string(&summary).context("the summary is no JSON")?;
    Ok(Written { summary, folder, files })
}

/// Asks what is being simulated to stop, as Ctrl-C does; false: lets what begins from now on go on.
pub fn stop(is_to_stop: bool) {
    interrupt::set(is_to_stop);
}
