//! `sscc bench`: what queries cost, by every method and beside parry3d.
//!
//! One process, one thread, the same questions in the same order, the methods by turns; each with its own cost of moving
//! vertices and refitting; all must list the same pairs.

mod amplitudes;
mod cache;
mod case;
mod clock;
mod columns;
mod growth;
mod kinetic;
mod machine;
mod measure;
mod peer;
mod random;
mod recipe;
mod report;
mod sample;
mod scenario;
mod scene;
mod table;
mod verdict;
mod vibration;

use std::path::PathBuf;

use anyhow::{Context, ensure};

use crate::Outcome;
use crate::args::Bench;
use crate::output::Output;
use cache::Cache;
use report::Report;
use scenario::Scenario;
use table::Table;

pub fn run(args: &Bench) -> anyhow::Result<Outcome> {
    let mut out = Output::new();
    let scenario = match &args.scenario {
        Some(name) if !args.list => Scenario::named(name)?,
        _ => {
            scenario::lines().into_iter().try_for_each(|line| out.line(line))?;
            out.finish()?;
            return Ok(Outcome::Done);
        }
    };
    check_options(args, scenario)?;
    let named = std::env::var_os("SSCC_MODELS").filter(|folder| !folder.is_empty());
    let models = args.models.clone().or(named.map(PathBuf::from));
    if let Some(folder) = &models {
        ensure!(
            folder.is_dir(),
            "{}: no folder of models; leave out --models or SSCC_MODELS",
            folder.display()
        );
    }
    let session = Session { args, models, cache: Cache::open(args.cache.as_deref())? };
    let mismatches = match scenario {
        Scenario::Amplitudes => amplitudes::run(&session, &mut out),
        Scenario::Growth => growth::run(&session, &mut out),
        Scenario::Kinetic => kinetic::run(&session, &mut out),
        Scenario::Scenes(scenes) => scene::run(&session, scenes, &mut out),
    }
    .with_context(|| format!("bench {}", args.scenario.as_deref().unwrap_or_default()))?;
    if !args.json.json {
        out.line(format_args!("measured on: {}", machine::description()))?;
    }
    out.finish()?;
    ensure!(mismatches == 0, "exact methods differ in {mismatches} of the steps: this is a defect");
    Ok(Outcome::Done)
}

/// Refuses what would have no meaning.
fn check_options(args: &Bench, scenario: Scenario) -> anyhow::Result<()> {
    let moves = matches!(scenario, Scenario::Scenes(_) | Scenario::Kinetic);
    ensure!(moves || args.steps.is_none(), "--steps is for what moves; amplitudes and growth have --samples");
    ensure!(
        !moves || args.samples.is_none(),
        "--samples is for amplitudes and growth; what moves has --steps"
    );
    ensure!(!moves || args.only.is_none(), "--only is for amplitudes and growth: a scene is one model");
    let grows = matches!(scenario, Scenario::Growth);
    ensure!(!grows || !args.quick, "--quick: growth needs its sizes; choose one by --only");
    Ok(())
}

/// What every scenario needs.
struct Session<'a> {
    args: &'a Bench,
    models: Option<PathBuf>,
    cache: Cache,
}

impl Session<'_> {
    /// Whether a model is wanted.
    fn wants(&self, name: &str) -> bool {
        self.args.only.as_deref().is_none_or(|only| only == name)
    }

    /// Refuses a model that no one knows.
    fn check_only(&self, names: &[&str]) -> anyhow::Result<()> {
        let Some(only) = self.args.only.as_deref() else { return Ok(()) };
        ensure!(
            names.contains(&only),
            "--only {only}: there is no such model; there are {}",
            names.join(", ")
        );
        Ok(())
    }

    fn samples(&self, default: usize) -> usize {
        self.args.samples.map_or(default, |samples| samples as usize)
    }

    /// Prints reports of one model: each as JSON on a line of its own, or a table of all.
    fn print(&self, reports: &[Report], out: &mut Output) -> anyhow::Result<()> {
        if self.args.json.json {
            return reports.iter().try_for_each(|report| out.json(report));
        }
        Table::of(reports).lines().into_iter().try_for_each(|line| out.line(line))
    }
}
