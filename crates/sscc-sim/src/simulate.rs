//! Runs a simulation, from the name of its scene to its states.

use std::path::{Path, PathBuf};

use rayon::{ThreadPool, ThreadPoolBuilder};
use sscc_io::Setting;
use sscc_tasks::{Cache, Shape, Watch, available_threads, make_folder, models_folder};

use crate::error::{At, Result, SimError};
use crate::files::{check_inputs, check_others, check_outputs};
use crate::run::{
    FinishedRun, PreparedScene, RunOutcome, Summary, announcement, check_log_size, run, traditional_costs,
};
use crate::scenes::{Scene, read_scene};

/// The files of bunny and dragon in the folder of the real models.
const REAL_MODELS: [&str; 2] = ["bunny_14964_closed.obj", "dragon_77202_closed.ply"];

/// Request for a simulation.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// A scene file, or the name of a scene that comes with the program.
    pub scene: PathBuf,
    /// The folder to write to. None means the scene's name.
    pub out: Option<PathBuf>,
    /// Number of steps from the beginning. None means the number of the scene.
    pub steps: Option<usize>,
    /// Whether to begin again, even if the folder has a checkpoint.
    pub restart: bool,
    /// The folder of the real models. None means the folder in the environment variable `SSCC_MODELS`, if it is set.
    pub models: Option<PathBuf>,
    /// The folder that keeps models and certificates between runs. None means the system's cache folder.
    pub cache: Option<PathBuf>,
    /// Number of threads. None means all cores.
    pub threads: Option<usize>,
}

/// Simulates a scene, or continues a stopped simulation of it. [`Outputs::write`](crate::Outputs::write) writes the
/// files of the result. Divergence and cancellation are not errors: [`FinishedRun::failure`] holds them, and the states
/// are kept. [`FinishedRun::unmeasured`] holds an error after the last step.
///
/// # Errors
/// When the scene or a model cannot be read or computed; when the simulation cannot begin or continue ([`run`]), for
/// example because bodies penetrate at the start or the folder belongs to another simulation; when a file that the simulation
/// would replace or remove is an input of the scene, is read-only, or is not of a simulation; when `watch` cancels the preparation; when no step
/// was made.
pub fn simulate(request: &Request, watch: &dyn Watch) -> Result<FinishedRun, SimError> {
    let scene = read_scene(&request.scene)?;
    let models = models_folder(request.models.as_deref())?;
    let cache = Cache::open(request.cache.as_deref())?;
    let folder = match &request.out {
        Some(folder) => folder.clone(),
        None => own_folder(&request.scene, &scene.name)?,
    };
    check_inputs(&folder, &inputs(&request.scene, &scene, models.as_deref()))?;
    check_others(&folder)?;
    make_folder(&folder)?;
    check_outputs(&folder)?;
    let threads = request.threads.unwrap_or_else(available_threads);
    let pool = start_threads(ThreadPoolBuilder::new(), threads)?;
    let steps = request.steps.unwrap_or(scene.steps);
    pool.install(|| finish(scene, models.as_deref(), &cache, folder, steps, request.restart, watch))
}

/// Prepares and simulates a scene, then sums up its states.
fn finish(
    scene: Scene,
    models: Option<&Path>,
    cache: &Cache,
    folder: PathBuf,
    steps: usize,
    again: bool,
    watch: &dyn Watch,
) -> Result<FinishedRun> {
    let in_scene = || scene.name.clone();
    let prepared = PreparedScene::get(&scene, models, cache, watch).at(in_scene)?;
    check_log_size(&scene, &prepared, steps).at(in_scene)?;
    let lines = announcement(&scene, &prepared, watch).at(in_scene)?;
    let RunOutcome { history, processor_seconds, failure } =
        run(&scene, &prepared, &folder, steps, again, &lines, watch).at(in_scene)?;
    if history.is_empty() {
        let failure = failure.unwrap_or_else(|| SimError::refused("steps", "no step was made"));
        return Err(failure).at(in_scene);
    }
    let summary = Summary::new(&scene, &prepared, &history, processor_seconds);
    // A cancellation skips the comparison. So does a failure: states that diverged may be out of range.
    let traditional = match &failure {
        None => traditional_costs(&scene, &prepared, &history, watch),
        Some(_) => Ok(Vec::new()),
    };
    let (traditional, unmeasured) = match traditional {
        Ok(costs) => (costs, None),
        Err(error) => (Vec::new(), Some(error)),
    };
    Ok(FinishedRun { scene, prepared, folder, history, summary, traditional, failure, unmeasured })
}

/// Returns the files that a scene reads: its own, if it is a file, and those of its models. `models` is the folder of the real
/// models. Files of fixed vertices are not among them, because the scene has only their numbers.
fn inputs(path: &Path, scene: &Scene, models: Option<&Path>) -> Vec<PathBuf> {
    let mut inputs = Vec::new();
    if path.is_file() {
        inputs.push(path.to_owned());
    }
    for model in &scene.models {
        match &model.recipe.shape {
            Shape::Spring { .. } => {}
            Shape::Bunny | Shape::Dragon => {
                inputs.extend(models.iter().flat_map(|folder| REAL_MODELS.map(|name| folder.join(name))));
            }
            Shape::File(file) => inputs.push(file.clone()),
            Shape::Embedded { surface, solid } => inputs.extend([surface.clone(), solid.clone()]),
            Shape::Model(files) => {
                inputs.push(files.path.clone());
                inputs.extend(files.modes.iter().chain(&files.forces).cloned());
            }
        }
    }
    inputs
}

/// Starts this number of threads.
fn start_threads(builder: ThreadPoolBuilder, count: usize) -> Result<ThreadPool> {
    builder.num_threads(count).build().map_err(|error| {
        let place = Setting::Threads + format!(" {count}");
        SimError::refused(place, format!("the system refuses so many threads: {error}; choose fewer"))
    })
}

/// Returns the folder that is named after the scene.
fn own_folder(path: &Path, name: &str) -> Result<PathBuf> {
    let folder = PathBuf::from(name);
    if name.is_empty() || name.starts_with('.') || folder.is_file() {
        let cause = "the scene's name cannot be the name of a folder; choose a folder with " + Setting::Out;
        return Err(SimError::refused(path.display(), cause));
    }
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_threads_are_an_error_with_their_number() {
        // No address space has room for such a stack (bytes).
        let builder = || ThreadPoolBuilder::new().stack_size((isize::MAX as usize >> 16) << 16);
        let message = start_threads(builder(), 2).err().unwrap().to_string();
        let start = "threads 2: the system refuses so many threads: ";
        assert!(message.starts_with(start) && message.ends_with("; choose fewer"), "{message}");
        assert_eq!(start_threads(ThreadPoolBuilder::new(), 2).unwrap().current_num_threads(), 2);
    }
}
