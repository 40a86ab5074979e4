//! `sscc simulate`: a scene moves, and its motion, costs and sound are written.

mod traditional;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::args::Simulate;
use crate::case::{Cache, models_folder};
use crate::nearest::nearest;
use crate::output::Output;
use crate::scene::{SHIPPED, Scene};
use crate::simulation::{Meter, Page, Prepared, Ran, Summary, run, write};
use crate::{Outcome, interrupt, load};

/// A simulation that has come to its end, or was stopped on its way.
pub struct Simulated {
    pub summary: Summary,
    /// The folder, and what was written to it.
    pub folder: PathBuf,
    pub files: Vec<PathBuf>,
    /// Why it ended early, if it did.
    failure: Option<String>,
    /// What could not be written.
    unwritten: Option<anyhow::Error>,
    steps: usize,
}

pub fn run_command(args: &Simulate) -> Result<Outcome> {
    let simulated = simulated(args)?;
    let mut out = Output::new();
    if args.json.json {
        out.json(&simulated.summary)?;
    } else {
        simulated.summary.lines().into_iter().try_for_each(|line| out.line(line))?;
        simulated.files.iter().try_for_each(|file| out.line(format_args!("written: {}", file.display())))?;
    }
    out.finish()?;
    simulated.whole().map(|_| Outcome::Done)
}

/// Simulates a scene and writes what comes out; nothing is printed.
pub fn simulated(args: &Simulate) -> Result<Simulated> {
    let scene = read(&args.scene)?;
    let models = models_folder(args.models.as_deref())?;
    let cache = Cache::open(args.cache.as_deref())?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => own_folder(&args.scene, &scene.name)?,
    };
    let in_folder = || format!("{}: no folder that can be written to", folder.display());
    fs::create_dir_all(&folder).with_context(in_folder)?;
    tempfile::tempfile_in(&folder).with_context(in_folder)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(load::threads(&args.threads)).build()?;
    pool.install(|| simulate(args, &scene, models.as_deref(), &cache, &folder))
}

fn simulate(
    args: &Simulate,
    scene: &Scene,
    models: Option<&Path>,
    cache: &Cache,
    folder: &Path,
) -> Result<Simulated> {
    let in_scene = || scene.name.clone();
    let prepared = Prepared::get(scene, models, cache).with_context(in_scene)?;
    let steps = args.steps.map_or(scene.steps, |steps| steps as usize);
    let Ran { history, processor_seconds, failure } =
        run(scene, &prepared, folder, steps, args.restart, &Meter::new()).with_context(in_scene)?;
    if history.len() == 0 {
        return Err(failure.unwrap_or_else(|| anyhow::anyhow!("no step was made")).context(in_scene()));
    }
    let summary = Summary::new(scene, &prepared, &history, processor_seconds);
    // Who presses Ctrl-C wants to wait no longer, and what diverged may be out of range.
    let traditional = match &failure {
        None => traditional::costs(scene, &prepared, &history),
        Some(_) => Ok(Vec::new()),
    };
    let (traditional, unmeasured) = match traditional {
        Ok(costs) => (costs, None),
        Err(error) => (Vec::new(), Some(error)),
    };
    let failure = failure.or(unmeasured).map(|error| interrupt::message(&error));
    let page =
        Page { scene, prepared: &prepared, history: &history, summary: &summary, traditional, failure };
    let (files, unwritten) = write(folder, &page);
    let Page { failure, .. } = page;
    Ok(Simulated { summary, folder: folder.to_owned(), files, failure, unwritten, steps: history.len() })
}

impl Simulated {
    /// The same, if nothing went wrong.
    pub fn whole(self) -> Result<Self> {
        match (&self.failure, self.unwritten) {
            (None, None) => Ok(Self { unwritten: None, ..self }),
            (None, Some(unwritten)) => Err(unwritten),
            (Some(failure), _) if interrupt::happened() => {
                bail!("{failure} after {} steps; the same command goes on from there", self.steps)
            }
            (Some(failure), unwritten) => {
                let unwritten = unwritten.map(|error| format!(" ({error:#})")).unwrap_or_default();
                let folder = self.folder.display();
                bail!("{failure}; what was simulated until then is in {folder}{unwritten}")
            }
        }
    }
}

/// The folder that is named after the scene.
fn own_folder(path: &Path, name: &str) -> Result<PathBuf> {
    let folder = PathBuf::from(name);
    if name.is_empty() || name.starts_with('.') || folder.is_file() {
        bail!("{}: no folder can have the scene's name; choose one by --out", path.display());
    }
    Ok(folder)
}

/// A file, or a scene that comes with the program.
fn read(path: &Path) -> Result<Scene> {
    let shipped = path.to_str().and_then(|name| SHIPPED.iter().find(|(known, _)| *known == name));
    match shipped {
        Some((name, text)) if !path.is_file() => Scene::parse(Path::new(&format!("{name}.toml")), text),
        // A name alone may be meant for a scene that comes with the program.
        None if path.extension().is_none() && !path.exists() => {
            let meant = nearest(&path.display().to_string(), SHIPPED.iter().map(|(name, _)| *name));
            bail!("{}: not found; did you mean '{}'?", path.display(), meant.unwrap_or_default())
        }
        _ => Scene::read(path),
    }
}
