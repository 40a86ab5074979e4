//! `sscc bench`: what queries cost, by every method and beside parry3d.
//!
//! One process, one thread, the same questions in the same order, the methods by turns; each with its own cost of
//! moving vertices and refitting; all must list the same pairs.

mod amplitudes;
mod clock;
mod columns;
mod follow;
mod growth;
mod kinetic;
mod measure;
mod page;
mod paper;
mod peer;
mod plot;
mod random;
mod report;
mod sample;
mod scenario;
mod scene;
mod strata;
mod table;
mod verdict;
mod vibration;

use std::path::PathBuf;

use anyhow::{Context, ensure};

use crate::args::Bench;
use crate::output::Output;
use crate::stages::Stages;
use crate::{Outcome, load};
use page::Rows;
use report::Report;
use scenario::Scenario;
use sscc_sim::{
    Cache, CertifiedModel, LoadedRecipe, ModesSpec, Recipe, Shape, machine_description, models_folder,
};
use table::Table;

pub fn run(args: &Bench) -> anyhow::Result<Outcome> {
    let mut out = Output::new();
    let scenario = match &args.scenario {
        Some(name) if !args.list => Scenario::named(name)?,
        _ => {
            scenario::lines()?.into_iter().try_for_each(|line| out.line(line))?;
            out.finish()?;
            return Ok(Outcome::Done);
        }
    };
    check_options(args, scenario)?;
    let models = models_folder(args.models.as_deref())?;
    if let Some(report) = &args.report {
        load::check_output(report, ".html", &[])?;
    }
    let session = Session { args, models, cache: Cache::open(args.cache.as_deref())?, rows: Rows::default() };
    let mismatches = match scenario {
        Scenario::Amplitudes => amplitudes::run(&session, &mut out),
        Scenario::Growth => growth::run(&session, &mut out),
        Scenario::Kinetic => kinetic::run(&session, &mut out),
        Scenario::Scenes(scenes, table) => scene::run_all(&session, scenes, table, &mut out),
    }
    .with_context(|| format!("bench {}", args.scenario.as_deref().unwrap_or_default()))?;
    if !args.json.json {
        out.line(format_args!("measured on: {}", machine_description()))?;
    }
    out.finish()?;
    if let Some(report) = &args.report {
        session.rows.write(report, args.scenario.as_deref().unwrap_or_default())?;
    }
    ensure!(mismatches == 0, "exact methods differ in {mismatches} of the steps: this is a defect");
    Ok(Outcome::Done)
}

/// Refuses what would have no meaning.
fn check_options(args: &Bench, scenario: Scenario) -> anyhow::Result<()> {
    let moves = matches!(scenario, Scenario::Scenes(..) | Scenario::Kinetic);
    ensure!(moves || args.steps.is_none(), "--steps is for what moves; amplitudes and growth have --samples");
    ensure!(
        !moves || args.samples.is_none(),
        "--samples is for amplitudes and growth; what moves has --steps"
    );
    ensure!(!moves || args.only.is_none(), "--only is for amplitudes and growth: a scene is one model");
    let grows = matches!(scenario, Scenario::Growth);
    ensure!(grows || args.plot.is_none(), "--plot is for growth");
    let is_told = !matches!(scenario, Scenario::Kinetic);
    ensure!(is_told || args.report.is_none(), "--report is not for kinetic");
    ensure!(!grows || !args.quick, "--quick: growth needs its sizes; choose one by --only");
    Ok(())
}

/// What every scenario needs.
struct Session<'a> {
    args: &'a Bench,
    models: Option<PathBuf>,
    cache: Cache,
    /// For `--report`.
    rows: Rows,
}

impl Session<'_> {
    /// A model with its certificates; where a quick look is wanted, the small spring in place of any.
    fn case(&self, recipe: &Recipe) -> anyhow::Result<CertifiedModel> {
        let stages = Stages::default();
        if !self.args.quick {
            let begun = LoadedRecipe::load(recipe, self.models.as_deref(), &stages)?;
            return Ok(CertifiedModel::get(&begun, &self.cache, &stages)?.with_paper(&self.cache, &stages)?);
        }
        let spring = small_spring();
        let begun = LoadedRecipe::load(&spring, None, &stages)?;
        let mut case = CertifiedModel::get(&begun, &self.cache, &stages)?.with_paper(&self.cache, &stages)?;
        case.note = Some("--quick: a spring of 4,000 triangles stands in for any model".into());
        Ok(case)
    }

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
        reports.iter().for_each(|report| self.rows.add(report));
        if self.args.json.json {
            reports.iter().try_for_each(|report| out.json(report))?;
        } else {
            Table::of(reports).lines().into_iter().try_for_each(|line| out.line(line))?;
        }
        // What comes next takes long.
        out.flush()
    }

    /// Whether nobody waits for more: the reader of standard output has left, and no page is to be written.
    fn is_over(&self, out: &Output) -> bool {
        out.is_closed() && self.args.report.is_none()
    }
}

/// The first spring of `growth`.
fn small_spring() -> Recipe {
    Recipe::new("spring-4k", Shape::SMALL_SPRING, ModesSpec::Linear(20))
}
