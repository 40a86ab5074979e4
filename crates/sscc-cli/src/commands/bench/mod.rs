//! `sscc bench`: runs the scenarios of `sscc-bench`, and prints their records.

mod figure;
mod growth;
mod kinetic;
mod printer;
mod scenarios;
mod table;

use anyhow::{Context, ensure};
use serde::Serialize;
use sscc_bench::{ListedScenario, ModelsScenario, Scenario, Setup};
use sscc_io::write_whole;
use sscc_tasks::{Cache, machine_description, models_folder};

use crate::args::Bench;
use crate::load;
use crate::outcome::Outcome;
use crate::output::Output;
use crate::stages::Stages;
use printer::Printer;

pub fn run(args: &Bench) -> anyhow::Result<Outcome> {
    let (name, scenario) = match &args.scenario {
        Some(name) if !args.list => (name, Scenario::from_name(name)?),
        _ => return list(args.json.json),
    };
    check_options(args, scenario)?;
    let models = models_folder(args.models.as_deref())?;
    if let Some(report) = &args.report {
        load::check_output(report, ".html", &[])?;
    }
    let (cache, stages) = (Cache::open(args.cache.as_deref())?, Stages::default());
    let setup = Setup { models: models.as_deref(), cache: &cache, is_quick: args.quick, watch: &stages };
    let mut printer = Printer::new(args);
    scenarios::run(scenario, args, &setup, &mut printer).with_context(|| format!("bench {name}"))?;
    let Printer { mut out, page, mismatches, .. } = printer;
    if !args.json.json {
        out.line(format_args!("measured on: {}", machine_description()))?;
    }
    out.finish()?;
    if let Some(report) = &args.report {
        write_whole(report, page.html(name)?.as_bytes())?;
    }
    ensure!(
        mismatches == 0,
        "exact methods differ in {mismatches} steps: this is a defect of sscc; please report it with this command and its output"
    );
    Ok(Outcome::Done)
}

/// The JSON line of a scenario in the list.
#[derive(Serialize)]
struct Listed {
    name: &'static str,
    about: String,
}

/// Prints the name and a description of each scenario.
fn list(is_json: bool) -> anyhow::Result<Outcome> {
    let mut out = Output::new();
    for ListedScenario { name, about } in Scenario::list()? {
        match is_json {
            true => out.json(&Listed { name, about })?,
            false => out.line(format_args!("{name:<20}{about}"))?,
        }
    }
    out.finish()?;
    Ok(Outcome::Done)
}

/// Refuses flags that have no meaning for the scenario, and a plot that cannot be written.
fn check_options(args: &Bench, scenario: Scenario) -> anyhow::Result<()> {
    let is_figure = matches!(scenario, Scenario::Figure(_));
    let has_steps = matches!(scenario, Scenario::Scenes { .. } | Scenario::Kinetic);
    let has_samples = !has_steps && !is_figure;
    ensure!(has_steps || args.steps.is_none(), "--steps is for scenes and kinetic");
    ensure!(
        has_samples || args.samples.is_none(),
        "--samples is for amplitudes, mixed, norms and growth; scenes and kinetic have --steps"
    );
    ensure!(
        has_samples || args.only.is_none(),
        "--only is for amplitudes, mixed, norms and growth: a scene is one model"
    );
    let is_growth = matches!(scenario, Scenario::Growth);
    let is_norms = matches!(scenario, Scenario::Models(ModelsScenario::Norms));
    let has_plot = is_figure || is_growth || is_norms || matches!(scenario, Scenario::Scenes { .. });
    ensure!(has_plot || args.plot.is_none(), "--plot is for figures, scenes, growth and norms");
    if let Some(plot) = &args.plot {
        load::check_output(plot, ".svg", &[])?;
    }
    let has_page = !is_figure && !matches!(scenario, Scenario::Kinetic);
    ensure!(has_page || args.report.is_none(), "--report is for scenes, amplitudes, mixed, norms and growth");
    ensure!(
        !is_growth || !args.quick,
        "--quick is not for growth: leave it out, and choose one size by --only"
    );
    Ok(())
}
