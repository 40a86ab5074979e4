//! Measures each scenario, and prints its records as soon as they are complete; those of growth at the end.

use anyhow::{Context, Result, ensure};
use sscc_bench::{
    Figure, GROWTH_SIZES, GrowthRecord, GrowthSize, KineticBench, ModelsScenario, PaperTable, SCENE_STEPS,
    Scenario, Setup, measure_scene, plot_norms, plot_scenes,
};
use sscc_io::write_whole;

use super::figure::figure_lines;
use super::printer::Printer;
use super::{growth, kinetic};
use crate::args::Bench;

/// Measures a scenario and prints its records.
pub fn run(scenario: Scenario, args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    match scenario {
        Scenario::Models(scenario) => models(scenario, args, setup, printer),
        Scenario::Growth => growth(args, setup, printer),
        Scenario::Kinetic => kinetic(args, setup, printer),
        Scenario::Figure(figure) => figure_of_paper(figure, args, setup, printer),
        Scenario::Scenes { scenes, table } => scenes_with_table(scenes, table, args, setup, printer),
    }
}

fn models(scenario: ModelsScenario, args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    let samples = args.samples.map_or(scenario.default_samples(), |samples| samples as usize);
    let mut all = Vec::new();
    for model in selected(args, scenario.models(), |model| model.name)? {
        let records = scenario.measure(model, setup, samples)?;
        printer.print(&records)?;
        all.extend(records);
        if printer.is_over() && args.plot.is_none() {
            break;
        }
    }
    if let Some(path) = &args.plot {
        write_whole(path, plot_norms(&all).as_bytes())?;
    }
    Ok(())
}

fn growth(args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    let samples = args.samples.map_or(GrowthSize::SAMPLES, |samples| samples as usize);
    let mut records = Vec::new();
    for size in selected(args, &GROWTH_SIZES, |size| size.name)? {
        records.push(size.measure(setup, samples)?);
    }
    let growth = GrowthRecord::new(records);
    if let Some(path) = &args.plot {
        write_whole(path, growth.svg().as_bytes())?;
    }
    if printer.is_json {
        printer.keep(&growth.sizes);
        return printer.out.json(&growth);
    }
    growth.sizes.iter().try_for_each(|record| printer.print(std::slice::from_ref(record)))?;
    printer.lines(growth::exponent_lines(&growth.exponents))
}

fn figure_of_paper(figure: Figure, args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    let record = figure.make(setup)?;
    if let Some(path) = &args.plot {
        write_whole(path, record.svg.as_bytes())?;
    }
    if printer.is_json {
        return printer.out.json(&record);
    }
    printer.lines(figure_lines(&record))
}

fn kinetic(args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    let bench = KineticBench::new(*setup)?;
    let steps = args.steps.map_or(KineticBench::STEPS, |steps| steps as usize);
    if !printer.is_json {
        printer.lines(kinetic::head(bench.model()))?;
    }
    for frequency in bench.frequencies() {
        let record = bench.measure(frequency, steps)?;
        printer.mismatches += record.mismatches;
        if printer.is_json {
            printer.out.json(&record)?;
        } else {
            printer.lines(kinetic::lines(&record))?;
        }
        printer.out.flush()?;
        if printer.is_over() {
            break;
        }
    }
    Ok(())
}

/// Measures scenes, and prints their records. As text, the rows of the paper's table (if there is one) follow beside
/// ours.
fn scenes_with_table(
    scenes: &[(&str, &str)],
    table: Option<PaperTable>,
    args: &Bench,
    setup: &Setup<'_>,
    printer: &mut Printer,
) -> Result<()> {
    let steps = args.steps.map_or(SCENE_STEPS, |steps| steps as usize);
    let (mut records, mut costs) = (Vec::new(), Vec::new());
    for (name, text) in scenes {
        let measured = measure_scene(setup, name, text, steps).with_context(|| (*name).to_owned())?;
        costs.push(measured.costs.clone());
        printer.page.add_costs(measured.costs);
        printer.print(std::slice::from_ref(&measured.record))?;
        records.push(measured.record);
        if printer.is_over() && args.plot.is_none() {
            return Ok(());
        }
    }
    if let Some(path) = &args.plot {
        write_whole(path, plot_scenes(&costs).as_bytes())?;
    }
    match table {
        Some(table) if !printer.is_json => printer.lines(table.lines(&records)),
        _ => Ok(()),
    }
}

/// Returns the models that `--only` selects; all without that flag. No such model is an error.
fn selected<'m, M>(args: &Bench, models: &'m [M], name: impl Fn(&M) -> &str) -> Result<Vec<&'m M>> {
    let only = args.only.as_deref();
    let selected: Vec<&M> =
        models.iter().filter(|model| only.is_none_or(|only| only == name(model))).collect();
    let names = || models.iter().map(&name).collect::<Vec<_>>().join(", ");
    let only = only.unwrap_or_default();
    ensure!(!selected.is_empty(), "--only {only}: there is no such model; there are {}", names());
    Ok(selected)
}
