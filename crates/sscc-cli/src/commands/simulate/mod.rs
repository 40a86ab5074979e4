//! `sscc simulate`: a scene moves, and its motion, costs and sound are written.

mod traditional;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::args::Simulate;
use crate::case::{Cache, models_folder};
use crate::output::Output;
use crate::scene::{SHIPPED, Scene};
use crate::simulation::{Log, Meter, Page, Prepared, Ran, Summary, run, write};
use crate::{Outcome, interrupt, load};

pub fn run_command(args: &Simulate) -> Result<Outcome> {
    let scene = read(&args.scene)?;
    let models = models_folder(args.models.as_deref())?;
    let cache = Cache::open(args.cache.as_deref())?;
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from(&scene.name));
    let in_folder = || format!("{}: no folder that can be written to", folder.display());
    fs::create_dir_all(&folder).with_context(in_folder)?;
    tempfile::tempfile_in(&folder).with_context(in_folder)?;
    if args.restart {
        Log::restart(&folder)?;
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(load::threads(&args.threads)).build()?;
    pool.install(|| simulate(args, &scene, models.as_deref(), &cache, &folder))
}

fn simulate(
    args: &Simulate,
    scene: &Scene,
    models: Option<&Path>,
    cache: &Cache,
    folder: &Path,
) -> Result<Outcome> {
    let in_scene = || scene.name.clone();
    let prepared = Prepared::get(scene, models, cache).with_context(in_scene)?;
    let steps = args.steps.map_or(scene.steps, |steps| steps as usize);
    let Ran { history, processor_seconds, failure } =
        run(scene, &prepared, folder, steps, &Meter::new()).with_context(in_scene)?;
    if history.len() == 0 {
        return Err(failure.unwrap_or_else(|| anyhow::anyhow!("no step was made")).context(in_scene()));
    }
    let summary = Summary::new(scene, &prepared, &history, processor_seconds);
    // Who presses Ctrl-C wants to wait no longer.
    let traditional =
        if interrupt::happened() { Vec::new() } else { traditional::costs(scene, &prepared, &history)? };
    let failure = failure.map(|error| format!("{error:#}"));
    let page =
        Page { scene, prepared: &prepared, history: &history, summary: &summary, traditional, failure };
    let files = write(folder, &page)?;
    let mut out = Output::new();
    if args.json.json {
        out.json(&summary)?;
    } else {
        summary.lines().into_iter().try_for_each(|line| out.line(line))?;
        files.iter().try_for_each(|file| out.line(format_args!("written: {}", file.display())))?;
    }
    out.finish()?;
    match page.failure {
        None => Ok(Outcome::Done),
        Some(failure) if interrupt::happened() => {
            bail!("{failure} after {} steps; the same command goes on from there", history.len())
        }
        Some(failure) => bail!("{failure}; what was simulated until then is in {}", folder.display()),
    }
}

/// A file, or a scene that comes with the program.
fn read(path: &Path) -> Result<Scene> {
    let shipped = path.to_str().and_then(|name| SHIPPED.iter().find(|(known, _)| *known == name));
    match shipped {
        Some((name, text)) if !path.exists() => Scene::parse(Path::new(&format!("{name}.toml")), text),
        _ => Scene::read(path),
    }
}
