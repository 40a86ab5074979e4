//! `sscc view`: the page, live.

mod metrics;

use std::path::Path;

use anyhow::{Context, Result};
use sscc_view::{Arrays, Live, ModelDetails, ModelScene, Scene, Server};

use crate::args::View;
use crate::interrupt::{self, Interrupt};
use crate::output::{Output, file_name};
use crate::{Outcome, frequencies, load};

/// The report in a folder of `simulate` or `demo`.
const REPORT: &str = "report.html";

pub fn run(args: &View) -> Result<Outcome> {
    let path = &args.model.path;
    if path.is_dir() {
        return show_report(args, &path.join(REPORT));
    }
    let loaded = load::model(&args.model)?;
    let model = &loaded.model;
    let certificates = match &args.certificates {
        Some(path) => load::certificates(path, model, &args.options)?,
        None => load::certificates_now(model, &args.model, &args.options)?,
    };
    let comparison = if args.compare_metrics { Some(metrics::compare(&loaded, path)?) } else { None };
    let server = bind(args)?;
    let details = ModelDetails {
        frequencies: loaded.info.elasticity.as_ref().and_then(frequencies::of_modes),
        mode_names: loaded.mode_names.clone(),
        default_q: loaded.default_q.clone(),
    };
    let name = file_name(path);
    let in_model = || path.display().to_string();
    let mut arrays = Arrays::default();
    let mut scene = Scene::new(&name);
    scene
        .models
        .push(ModelScene::new(0, &name, model, &certificates, details, &mut arrays).with_context(in_model)?);
    scene.plots.extend(comparison);
    let live = Live::new(model, &certificates, scene, arrays, &Interrupt).with_context(in_model)?;
    announce(args, &server)?;
    server.serve(&live, &interrupt::happened)?;
    Ok(Outcome::Done)
}

/// A report through the same door.
fn show_report(args: &View, report: &Path) -> Result<Outcome> {
    let bytes = sscc_io::read_whole(report)
        .context("a folder is shown by the report in it, as sscc simulate writes it")?;
    let html = String::from_utf8(bytes).ok().filter(|html| html.contains("id=\"sscc-report\""));
    let html = html.with_context(|| format!("{}: it is no report of sscc", report.display()))?;
    let server = bind(args)?;
    announce(args, &server)?;
    server.serve_report(&html, &interrupt::happened)?;
    Ok(Outcome::Done)
}

/// Listens at the port that is wanted.
fn bind(args: &View) -> Result<Server> {
    Ok(match args.port {
        Some(port) => Server::bind(port).with_context(|| format!("--port {port}"))?,
        None => Server::bind(0)?,
    })
}

/// Tells where the page is, and opens it.
fn announce(args: &View, server: &Server) -> Result<()> {
    let address = server.address();
    let mut out = Output::new();
    out.line(&address)?;
    out.finish()?;
    if args.no_open {
        return Ok(());
    }
    if open::that_detached(&address).is_err() {
        eprintln!("note: no browser was found: open the address above in one");
    }
    Ok(())
}
