//! Measures each scenario model by model, and prints each record.

use anyhow::{Context, Result, ensure};
use sscc_bench::{
    AmplitudesModel, GROWTH_SIZES, GrowthRecord, GrowthSize, KineticBench, PaperTable, SCENE_STEPS, Scenario,
    Setup, amplitudes_models, measure_scene,
};
use sscc_io::write_whole;

use super::printer::Printer;
use super::{growth, kinetic};
use crate::args::Bench;

/// Measures a scenario and prints its records.
pub fn run(scenario: Scenario, args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    match scenario {
        Scenario::Amplitudes => amplitudes(args, setup, printer),
        Scenario::Growth => growth(args, setup, printer),
        Scenario::Kinetic => kinetic(args, setup, printer),
        Scenario::Scenes { scenes, table } => scenes_with_table(scenes, table, args, setup, printer),
    }
}

fn amplitudes(args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    let models = amplitudes_models();
    check_only(args, &models.each_ref().map(|model| model.name))?;
    for model in models.into_iter().filter(|model| is_selected(args, model.name)) {
        printer.print(&model.measure(setup, samples(args, AmplitudesModel::SAMPLES))?)?;
        if printer.is_over() {
            break;
        }
    }
    Ok(())
}

fn growth(args: &Bench, setup: &Setup<'_>, printer: &mut Printer) -> Result<()> {
    check_only(args, &GROWTH_SIZES.map(|size| size.name))?;
    let mut records = Vec::new();
    for size in GROWTH_SIZES.iter().filter(|size| is_selected(args, size.name)) {
        records.push(size.measure(setup, samples(args, GrowthSize::SAMPLES))?);
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

/// Measures scenes; then prints the rows of the paper's table beside ours.
fn scenes_with_table(
    scenes: &[(&str, &str)],
    table: Option<PaperTable>,
    args: &Bench,
    setup: &Setup<'_>,
    printer: &mut Printer,
) -> Result<()> {
    let steps = args.steps.map_or(SCENE_STEPS, |steps| steps as usize);
    let mut records = Vec::new();
    for (name, text) in scenes {
        let measured = measure_scene(setup, name, text, steps).with_context(|| (*name).to_owned())?;
        printer.page.add_costs(measured.costs);
        printer.print(std::slice::from_ref(&measured.record))?;
        records.push(measured.record);
        if printer.is_over() {
            return Ok(());
        }
    }
    match table {
        Some(table) if !printer.is_json => printer.lines(table.lines(&records)),
        _ => Ok(()),
    }
}

/// Whether `--only` selects this model. Without that flag, all are selected.
fn is_selected(args: &Bench, name: &str) -> bool {
    args.only.as_deref().is_none_or(|only| only == name)
}

/// Refuses an unknown model in `--only`.
fn check_only(args: &Bench, names: &[&str]) -> Result<()> {
    let Some(only) = args.only.as_deref() else { return Ok(()) };
    ensure!(names.contains(&only), "--only {only}: there is no such model; there are {}", names.join(", "));
    Ok(())
}

fn samples(args: &Bench, default: usize) -> usize {
    args.samples.map_or(default, |samples| samples as usize)
}
