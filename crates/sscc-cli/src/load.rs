//! Loads models, and computes certificates, as the arguments state. Errors name the file or the flag.

use std::fs;
use std::path::Path;

use anyhow::{Context, Error, Result, bail, ensure};
use sscc::parts::check_models;
use sscc::{Certificates, CertifyOptions, ReducedModel};
use sscc_io::{
    IoError, LoadOptions, LoadedModel, Setting, check_replaceable, has_file, is_folder_of_mesh, linked_file,
};
use sscc_tasks::{CertificateRequest, GroupRules, Scheme, TaskError, available_threads, read_configuration};

use crate::output::{note, warn};
use crate::progress::Bar;
use crate::{args, interrupt};

/// Loads a model, and prints warnings about its file.
pub fn model(files: &args::Model) -> Result<LoadedModel> {
    let options = LoadOptions::new(files.modes.as_deref(), files.mesh_name.as_deref());
    let loaded = sscc_io::load_model_with(&files.path, &options)?;
    loaded.warnings.iter().for_each(|warning| warn(&files.path, warning));
    Ok(loaded)
}

/// Returns the number of threads: that of `--threads`, else all cores.
pub fn threads(typed: &args::Threads) -> usize {
    typed.threads.map_or_else(available_threads, |threads| threads as usize)
}

/// Returns the options of certificates.
pub fn request(
    loaded: &LoadedModel,
    files: &args::Model,
    typed: &args::Options,
) -> Result<CertificateRequest> {
    if let Some(typed) = typed.neighbours {
        check_models(typed)?;
    }
    let center = typed
        .center
        .as_deref()
        .map(|typed| read_configuration(Setting::Center, typed, loaded))
        .transpose()?;
    Ok(CertificateRequest {
        model: files.path.clone(),
        mesh_name: files.mesh_name.clone(),
        epsilon: typed.epsilon,
        metric: typed.metric.clone(),
        center,
        neighbours: typed.neighbours,
        weld: typed.weld.map(|weld| weld == args::Switch::On),
        ignore_rest: typed.ignore_rest,
        groups: groups(&typed.groups),
        max_exceptions: typed.max_exceptions,
        clearance: None,
        any_clearance: false,
        scheme: typed.scheme.map(|scheme| match scheme {
            args::Scheme::Paper => Scheme::Paper,
            args::Scheme::Full => Scheme::Full,
        }),
        budget: typed.budget.map(|bytes| bytes as usize),
        local_budget: typed.local_budget.map(|bytes| bytes as usize),
        reach: typed.reach,
        threads: Some(threads(&typed.threads)),
    })
}

/// Returns the pairs of groups of `--ignore-groups`, `--only-groups` and `--group-by`.
pub fn groups(typed: &args::Groups) -> GroupRules {
    let args::Groups { ignore_groups, only_groups, group_by } = typed;
    GroupRules { ignored: ignore_groups.clone(), only: only_groups.clone(), by: group_by.clone() }
}

/// Computes certificates; errors name the model's file.
pub fn certify(model: &ReducedModel, path: &Path, options: &CertifyOptions) -> Result<Certificates> {
    let computed = Certificates::compute(model, options, &Bar::new("certifying"));
    interrupt::check()?;
    computed.with_context(|| path.display().to_string())
}

/// Computes certificates for a command without `--certificates`, and prints a note. If none of `--scheme`, `--budget`,
/// `--local-budget` and `--reach` is given, they have no pair tree and no local certificates: a few queries do not save
/// the time that these take to compute.
pub fn certificates_now(
    loaded: &LoadedModel,
    files: &args::Model,
    typed: &args::Options,
) -> Result<Certificates> {
    let mut options = request(loaded, files, typed)?.options(&loaded.model)?;
    if (typed.scheme, typed.budget, typed.local_budget, typed.reach) == (None, None, None, None) {
        options = options.budget(0).local_budget(0);
    }
    note("no --certificates given: computing them first (sscc certify keeps them in a file)");
    certify(&loaded.model, &files.path, &options)
}

/// Adds the file's name to an error. Errors of readers and writers contain it already.
pub fn in_file(error: Error, path: &Path) -> Error {
    let is_named = error.is::<IoError>() || error.downcast_ref().and_then(TaskError::file).is_some();
    if is_named { error } else { error.context(path.display().to_string()) }
}

/// Refuses an unusable output before any long work: one with another ending, one that is an input, a file of an input or no file,
/// one that is read-only or in a folder that cannot be written to, and a new mesh in the folder of an input, which would be read in the next run.
pub fn check_output(output: &Path, ending: &str, inputs: &[&Path]) -> Result<()> {
    let shown = output.display();
    let file_name = output.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    ensure!(
        file_name.ends_with(ending) && file_name.len() > ending.len(),
        "{shown}: the name of the output must end in {ending}"
    );
    if let Ok(real) = fs::canonicalize(output) {
        let is_input = inputs.iter().any(|input| has_file(input, &real));
        ensure!(!is_input, "{shown}: the output is an input; choose another name");
        ensure!(real.is_file(), "{shown}: cannot be written: it is not a file; choose another name");
    }
    let target = linked_file(output)?;
    if let Some(input) = inputs.iter().find(|input| is_folder_of_mesh(input, &target)) {
        bail!(
            "{shown}: the output would be a mesh of the input folder {}; choose another folder",
            input.display()
        );
    }
    check_replaceable(output)?;
    Ok(())
}
