//! Models, metrics and certificates by what was typed, with errors that name the file.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, Result, bail, ensure};
use sscc::{Certificates, CertifyOptions, Metric, ReducedModel};
use sscc_io::ModelInfo;

use crate::progress::Bar;
use crate::{args, interrupt};

/// Loads a model.
pub fn model(files: &args::Model) -> Result<(ReducedModel, ModelInfo)> {
    // Without welding, triangles that meet at a split vertex would all count as touching.
    ensure!(
        !sscc_io::splits_vertices(&files.path),
        "{}: STL and glTF files split vertices, and this version cannot weld them yet; convert the mesh to OBJ or PLY \
         with shared vertices",
        files.path.display()
    );
    Ok(sscc_io::load_model(&files.path, files.modes.as_deref())?)
}

/// The metric that was asked for, if any.
pub fn metric(model: &ReducedModel, wanted: Option<&Path>) -> Result<Option<Metric>> {
    let Some(wanted) = wanted else { return Ok(None) };
    let metric = match wanted.to_str() {
        Some("displacement") => Metric::displacement(model.mesh(), model.modes()),
        Some("mass") => Metric::mass(model.mesh(), model.modes()),
        Some("identity") => Metric::identity(model.rank()),
        Some("energy") => bail!(
            "--metric energy: the model carries no stiffness; use displacement, mass, identity or a file"
        ),
        _ => {
            let weights = sscc_io::read_vector(wanted).with_context(
                || "--metric is neither displacement, mass nor identity, so a file was looked for",
            )?;
            ensure!(
                weights.len() == model.rank(),
                "{}: the metric has {} weights, the model has {} modes",
                wanted.display(),
                weights.len(),
                model.rank()
            );
            Metric::from_weights(&weights).with_context(|| wanted.display().to_string())?
        }
    };
    // Refused here rather than later, where the flag is no longer known.
    let (mesh, modes) = (model.mesh().clone(), model.modes().clone());
    let fits = ReducedModel::with_metric(mesh, modes, metric.clone());
    fits.with_context(|| format!("--metric {}", wanted.display()))?;
    Ok(Some(metric))
}

/// Number of threads for what was typed.
pub fn threads(typed: &args::Threads) -> usize {
    match typed.threads {
        Some(threads) => threads as usize,
        None => thread::available_parallelism().map_or(1, usize::from),
    }
}

/// What was typed about computing certificates.
pub fn options(model: &ReducedModel, typed: &args::Options) -> Result<CertifyOptions> {
    Ok(CertifyOptions {
        epsilon: typed.epsilon.unwrap_or(CertifyOptions::default().epsilon),
        metric: metric(model, typed.metric.as_deref())?,
        threads: Some(threads(&typed.threads)),
    })
}

/// Computes certificates; errors name the model's file.
pub fn certify(model: &ReducedModel, path: &Path, options: &CertifyOptions) -> Result<Certificates> {
    let computed = Certificates::compute(model, options, &Bar::new("certifying"));
    interrupt::check()?;
    computed.with_context(|| path.display().to_string())
}

/// Reads certificates, and refuses those of another model, or other than the options typed say.
pub fn certificates(path: &Path, model: &ReducedModel, options: &args::Options) -> Result<Certificates> {
    let certificates = sscc_io::read_certificates(path)?;
    let name = || path.display().to_string();
    certificates.check_model(model).with_context(name)?;
    if let Some(epsilon) = options.epsilon {
        let found = certificates.parts().epsilon;
        ensure!(
            epsilon == found,
            "{}: certified with --epsilon {found}, not {epsilon}; leave the flag out",
            name()
        );
    }
    if let Some(metric) = metric(model, options.metric.as_deref())? {
        ensure!(
            metric.scales() == certificates.metric().scales(),
            "{}: certified with another metric ({}) than --metric says; leave the flag out, or certify anew",
            name(),
            certificates.metric().kind().name()
        );
    }
    Ok(certificates)
}

/// Refuses an output that would not do, before any long work: another ending, an input, a folder that cannot
/// be written to.
pub fn check_output(output: &Path, ending: &str, inputs: &[&Path]) -> Result<()> {
    let shown = output.display();
    let file_name = output.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    ensure!(
        file_name.ends_with(ending) && file_name.len() > ending.len(),
        "{shown}: the name of the output must end in {ending}"
    );
    if let Ok(real) = fs::canonicalize(output) {
        let is_input = |input: &&Path| fs::canonicalize(input).is_ok_and(|input| input == real);
        ensure!(!inputs.iter().any(is_input), "{shown}: the output is an input; choose another name");
        ensure!(real.is_file(), "{shown}: cannot be written: it is no file; choose another name");
    }
    // Nameless, so that nothing is left of it.
    tempfile::tempfile_in(folder(output)).with_context(|| format!("{shown}: cannot be written"))?;
    Ok(())
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}
