//! `sscc view`: serves the page of a model or writes it to a file, or serves the report in a folder.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use sscc::MetricKind;
use sscc_io::{LoadedModel, write_whole};
use sscc_view::{
    Checks, Live, MAX_REPORT_BYTES, Plot, Report, Scene, Server, WasmPackage, metric_comparison,
};

use crate::args::{Model, Options, View};
use crate::interrupt;
use crate::load;
use crate::model_scene::model_scene;
use crate::outcome::Outcome;
use crate::output::{Output, file_name, note};
use crate::progress::Bar;

/// The file name of the report that `simulate` and `demo` write.
const REPORT: &str = "report.html";

pub fn run(args: &View) -> Result<Outcome> {
    let path = &args.model.path;
    if path.is_dir() {
        return show_report(args, &path.join(REPORT));
    }
    if let Some(report) = &args.report {
        load::check_output(report, ".html", &[path])?;
    }
    let package = args.wasm.as_deref().map(WasmPackage::read).transpose()?;
    let loaded = load::model(&args.model)?;
    let model = &loaded.model;
    let certificates = match &args.certificates {
        Some(path) => load::request(&loaded, &args.model, &args.options)?.read(path, model)?,
        None => load::certificates_now(&loaded, &args.model, &args.options)?,
    };
    let comparison = if args.compare_metrics { Some(compare_metrics(&loaded, path)?) } else { None };
    let name = file_name(path);
    let in_model = || path.display().to_string();
    let (described, mut arrays) = model_scene(&loaded, &certificates, &name, None).with_context(in_model)?;
    let mut scene = Scene::new(&name);
    scene.models.push(described);
    scene.plots.extend(comparison);
    if let Some(report) = &args.report {
        let checks = package.map(|package| Checks::new(&package, model, &certificates, &mut arrays));
        let checks = checks.transpose().with_context(in_model)?;
        return write_report(report, &Report { scene, arrays, checks });
    }
    let server = bind(args)?;
    let live = Live::new(model, &certificates, scene, arrays, Some(interrupt::token().clone()))
        .with_context(in_model)?;
    announce(args, &server)?;
    server.serve(&live, &interrupt::is_interrupted)?;
    Ok(Outcome::Done)
}

/// Writes the page to a file.
fn write_report(path: &Path, report: &Report) -> Result<Outcome> {
    let html = report.html().with_context(|| path.display().to_string())?;
    ensure!(
        html.len() as u64 <= MAX_REPORT_BYTES,
        "{}: the page would have more than {} MiB: choose a model with fewer vertices or modes, or leave out --report",
        path.display(),
        MAX_REPORT_BYTES >> 20
    );
    write_whole(path, html.as_bytes())?;
    note(format_args!("{}: {:.1} MB", path.display(), html.len() as f64 / 1e6));
    Ok(Outcome::Done)
}

/// Computes the plot of `--compare-metrics`.
fn compare_metrics(loaded: &LoadedModel, path: &Path) -> Result<Plot> {
    let metric = loaded.model.metric();
    let form = if metric.dense_factor().is_some() { "dense" } else { "diagonal" };
    if (metric.kind(), form) != (MetricKind::Energy, "diagonal") {
        bail!(
            "--compare-metrics: {}: the model's own metric is {} ({form}), not a diagonal energy metric; make a model \
             with its stiffness by sscc modes --kind linear or nonlinear",
            path.display(),
            metric.kind()
        );
    }
    let plot = metric_comparison(&loaded.model, &loaded.info.units, &Bar::new("certifying"));
    plot.with_context(|| path.display().to_string())
}

/// Serves the report of a folder: its data, in the page of this program.
fn show_report(args: &View, report: &Path) -> Result<Outcome> {
    if let Some(option) = first_model_option(args) {
        bail!("{option} is for models, but {} is a folder: leave {option} out", args.model.path.display());
    }
    ensure!(
        fs::metadata(report).map_or(0, |file| file.len()) <= MAX_REPORT_BYTES,
        "{}: file is larger than {} MiB, the maximum for a report",
        report.display(),
        MAX_REPORT_BYTES >> 20
    );
    let bytes = sscc_io::read_whole(report)
        .context("sscc view shows the report in a folder, as written by sscc simulate or sscc demo --out")?;
    let html = Report::rebuild(&String::from_utf8_lossy(&bytes));
    let html = html.with_context(|| report.display().to_string())?;
    let server = bind(args)?;
    announce(args, &server)?;
    server.serve_report(&html, &interrupt::is_interrupted)?;
    Ok(Outcome::Done)
}

/// Returns the first typed option that applies to models only.
fn first_model_option(args: &View) -> Option<&'static str> {
    let View { model, certificates, port: _, no_open: _, compare_metrics, report, wasm: _, options } = args;
    let Model { path: _, modes, mesh_name } = model;
    let Options {
        epsilon,
        metric,
        center,
        neighbours,
        ignore_rest,
        groups,
        weld,
        max_exceptions,
        scheme,
        budget,
        local_budget,
        reach,
        threads,
    } = options;
    let typed = [
        (modes.is_some(), "--modes"),
        (mesh_name.is_some(), "--mesh-name"),
        (certificates.is_some(), "--certificates"),
        (*compare_metrics, "--compare-metrics"),
        (report.is_some(), "--report"),
        (epsilon.is_some(), "--epsilon"),
        (metric.is_some(), "--metric"),
        (center.is_some(), "--center"),
        (neighbours.is_some(), "--neighbours"),
        (ignore_rest.is_some(), "--ignore-rest"),
        (!groups.ignore_groups.is_empty(), "--ignore-groups"),
        (!groups.only_groups.is_empty(), "--only-groups"),
        (groups.group_by.is_some(), "--group-by"),
        (weld.is_some(), "--weld"),
        (max_exceptions.is_some(), "--max-exceptions"),
        (scheme.is_some(), "--scheme"),
        (budget.is_some(), "--budget"),
        (local_budget.is_some(), "--local-budget"),
        (reach.is_some(), "--reach"),
        (threads.threads.is_some(), "--threads"),
    ];
    typed.into_iter().find_map(|(is_typed, option)| is_typed.then_some(option))
}

/// Listens on the port of `--port`, else on a free one.
fn bind(args: &View) -> Result<Server> {
    Ok(match args.port {
        Some(port) => Server::bind(port).with_context(|| format!("--port {port}"))?,
        None => Server::bind(0)?,
    })
}

/// Prints the address of the page, and opens it in the browser unless `--no-open` is given.
fn announce(args: &View, server: &Server) -> Result<()> {
    let address = server.address();
    let mut out = Output::new();
    out.line(&address)?;
    out.finish()?;
    if args.no_open {
        return Ok(());
    }
    if let Err(error) = open::that_detached(&address) {
        note(format_args!("the browser could not be opened: {error}; open the address above in a browser"));
    }
    Ok(())
}
