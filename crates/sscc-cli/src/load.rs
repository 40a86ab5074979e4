//! Loads models, metrics and certificates as the arguments state. Errors name the file.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Error, Result, bail, ensure};
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Metric, MetricKind, Neighbours, ReducedModel, Scope,
};
use sscc_io::{IoError, LoadOptions, LoadedModel, check_writable, folder};
use sscc_sim::{SimError, available_threads};

use crate::groups::groups;
use crate::output::note;
use crate::progress::Bar;
use crate::{args, interrupt};

/// Loads a model.
pub fn model(files: &args::Model) -> Result<LoadedModel> {
    let options = LoadOptions::new(files.modes.as_deref(), files.mesh_name.as_deref());
    Ok(sscc_io::load_model_with(&files.path, &options)?)
}

/// Returns the metric of `--metric`; none without that flag.
pub fn metric(model: &ReducedModel, typed: Option<&Path>) -> Result<Option<Metric>> {
    let Some(typed) = typed else { return Ok(None) };
    let metric = match typed.to_str() {
        Some("displacement") => Metric::displacement(model.mesh(), model.modes()),
        Some("mass") => Metric::mass(model.mesh(), model.modes()),
        Some("identity") => Metric::identity(model.rank()),
        Some("energy") if model.metric().kind() == MetricKind::Energy => model.metric().clone(),
        Some("energy") => bail!(
            "--metric energy: the model's own metric is {}, not energy; make a model with its stiffness by sscc modes \
             --kind linear or nonlinear, or give a file",
            model.metric().kind().name()
        ),
        _ => {
            let numbers = sscc_io::read_matrix(typed).with_context(
                || "--metric is none of energy, displacement, mass and identity, so it must be a file",
            )?;
            let rank = model.rank();
            let made = match (numbers.rows, numbers.columns) {
                (1, n) | (n, 1) if n == rank => Metric::from_weights(MetricKind::Given, &numbers.data),
                (n, m) if (n, m) == (rank, rank) => {
                    Metric::from_matrix(MetricKind::Given, rank, &numbers.data)
                }
                (1, n) | (n, 1) => {
                    let shown = typed.display();
                    let matrix = if n == rank * rank { " (a dense matrix must be a .npy)" } else { "" };
                    bail!("{shown}: the metric has {n} weights, the model has {rank} modes{matrix}")
                }
                (n, m) => {
                    bail!("{}: the metric is {n} x {m}, the model has {rank} modes", typed.display())
                }
            };
            made.with_context(|| typed.display().to_string())?
        }
    };
    // Checked here, because later errors cannot name the flag.
    metric.check(model.mesh(), model.modes()).with_context(|| format!("--metric {}", typed.display()))?;
    Ok(Some(metric))
}

/// Returns the centre of `--center`, numbers or a file; none without that flag.
fn center(model: &ReducedModel, typed: Option<&str>) -> Result<Option<Vec<f64>>> {
    let Some(typed) = typed else { return Ok(None) };
    let numbers: Result<Vec<f64>, _> = typed.split(',').map(|number| number.trim().parse()).collect();
    let center = match numbers {
        Ok(numbers) => numbers,
        Err(_) => sscc_io::read_vector(Path::new(typed))
            .with_context(|| "--center is not a list of numbers, so it must be a file")?,
    };
    model.check_coordinates(&center).with_context(|| format!("--center {typed}"))?;
    Ok(Some(center))
}

/// Whether to weld without `--weld`.
fn welds_by_default(files: &args::Model) -> bool {
    sscc_io::splits_vertices(&files.path)
}

/// Returns the number of threads: that of `--threads`, else all cores.
pub fn threads(typed: &args::Threads) -> usize {
    typed.threads.map_or_else(available_threads, |threads| threads as usize)
}

/// Returns the budget of the pair tree in bytes for each triangle; none without `--scheme` and `--budget`.
fn budget(typed: &args::Options) -> Result<Option<usize>> {
    let budget = typed.budget.map(|bytes| bytes as usize);
    Ok(match typed.scheme {
        Some(args::Scheme::Paper) => {
            ensure!(budget.is_none(), "--scheme paper stores no pair tree: leave --budget out");
            Some(0)
        }
        Some(args::Scheme::Full) => budget.or(Some(CertifyOptions::DEFAULT_BUDGET)),
        None => budget,
    })
}

/// Returns the options for computing certificates, with defaults for absent flags.
pub fn options(model: &ReducedModel, files: &args::Model, typed: &args::Options) -> Result<CertifyOptions> {
    Ok(CertifyOptions {
        epsilon: typed.epsilon.unwrap_or(CertifyOptions::default().epsilon),
        metric: metric(model, typed.metric.as_deref())?,
        center: center(model, typed.center.as_deref())?,
        filter: filter(files, model.mesh().faces().len(), typed)?,
        ignore_rest: typed.ignore_rest,
        max_exceptions: typed.max_exceptions,
        budget: budget(typed)?.unwrap_or(CertifyOptions::DEFAULT_BUDGET),
        threads: Some(threads(&typed.threads)),
    })
}

/// Returns the contact filter of the flags, with defaults for absent ones; but `--ignore-rest` needs the model.
fn filter(files: &args::Model, triangles: usize, typed: &args::Options) -> Result<ContactFilter> {
    let filter = ContactFilter::new(
        typed.neighbours.map_or(Neighbours::default(), neighbours),
        typed.weld.map_or(welds_by_default(files), |weld| weld == args::Switch::On),
    );
    Ok(match groups(files, triangles, &typed.groups)? {
        Some(groups) => filter.with_groups(groups),
        None => filter,
    })
}

/// Returns the value of `--neighbours`.
pub fn neighbours(typed: args::Neighbours) -> Neighbours {
    match typed {
        args::Neighbours::Exclude => Neighbours::Exclude,
        args::Neighbours::IncludeOneVertex => Neighbours::IncludeOneVertex,
    }
}

/// Returns the scope of a query without certificates.
pub fn scope(model: &ReducedModel, files: &args::Model, typed: &args::Options) -> Result<Scope> {
    let options = options(model, files, typed)?;
    let mut filter = options.filter;
    if options.ignore_rest {
        filter = filter.ignoring_rest(model).with_context(|| files.path.display().to_string())?;
    }
    let default = Scope::of(model);
    Ok(Scope {
        metric: options.metric.unwrap_or(default.metric),
        center: options.center.unwrap_or(default.center),
        filter,
        exceptions: Vec::new(),
    })
}

/// Computes certificates; errors name the model's file.
pub fn certify(model: &ReducedModel, path: &Path, options: &CertifyOptions) -> Result<Certificates> {
    let computed = Certificates::compute(model, options, &Bar::new("certifying"));
    interrupt::check()?;
    computed.with_context(|| path.display().to_string())
}

/// Computes certificates for a command without `--certificates`, and prints a note. They have no pair tree unless
/// `--scheme` or `--budget` requests one: a few queries do not save the time that it takes to compute.
pub fn certificates_now(
    model: &ReducedModel,
    files: &args::Model,
    typed: &args::Options,
) -> Result<Certificates> {
    let mut options = options(model, files, typed)?;
    if (typed.scheme, typed.budget) == (None, None) {
        options.budget = 0;
    }
    note("no --certificates given: computing them first (sscc certify keeps them in a file)");
    certify(model, &files.path, &options)
}

/// Adds the file's name to an error. Errors of readers and writers contain it already.
pub fn in_file(error: Error, path: &Path) -> Error {
    let is_named = error.is::<IoError>() || error.downcast_ref().and_then(SimError::file).is_some();
    if is_named { error } else { error.context(path.display().to_string()) }
}

/// Reads certificates. Refuses those of another model, and flags that contradict them.
pub fn certificates(
    path: &Path,
    files: &args::Model,
    model: &ReducedModel,
    options: &args::Options,
) -> Result<Certificates> {
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
        let known = certificates.metric();
        ensure!(
            (metric.scales(), metric.dense_factor()) == (known.scales(), known.dense_factor()),
            "{}: certified with another metric ({}) than --metric; leave the flag out, or certify anew",
            name(),
            known.kind().name()
        );
    }
    if let Some(center) = center(model, options.center.as_deref())? {
        ensure!(
            center == certificates.center(),
            "{}: certified about another centre than --center; leave the flag out, or certify anew",
            name()
        );
    }
    let known = certificates.filter();
    let typed = ContactFilter::new(
        options.neighbours.map_or(known.neighbours, neighbours),
        options.weld.map_or(known.weld, |weld| weld == args::Switch::On),
    );
    let typed = typed.ignoring(known.ignored().iter().copied());
    let groups = groups(files, model.mesh().faces().len(), &options.groups)?.map(Arc::new);
    let typed = match groups.as_ref().or(known.groups()) {
        Some(groups) => typed.with_groups(Arc::clone(groups)),
        None => typed,
    };
    certificates.check_filter(&typed).with_context(name)?;
    let tree = &certificates.parts().pair_tree;
    let (triangles, has_tree) = (certificates.hierarchy().order().len(), tree.limit() > 0.0);
    budget(options)?;
    let of_scheme = options.scheme.is_none_or(|scheme| has_tree == (scheme == args::Scheme::Full));
    let in_budget = |bytes: u32| has_tree && tree.bytes() <= (bytes as usize).saturating_mul(triangles);
    ensure!(
        of_scheme && options.budget.is_none_or(in_budget),
        "{}: its pair tree of {} bytes for {triangles} triangles contradicts --scheme or --budget; leave the flag out, or \
         certify anew",
        name(),
        tree.bytes()
    );
    ensure!(
        !options.ignore_rest || known.ignored().len() as u64 == certificates.rest_collisions(),
        "{}: certified without --ignore-rest; leave the flag out, or certify anew",
        name()
    );
    let exceptions = certificates.exceptions().len();
    ensure!(
        options.max_exceptions.is_none_or(|max| exceptions <= max),
        "{}: certified with {exceptions} exceptions, more than --max-exceptions allows; leave the flag out, or \
         certify anew",
        name()
    );
    Ok(certificates)
}

/// Refuses an unusable output before any long work: one with another ending, one that is an input, one in a folder
/// that cannot be written to.
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
        ensure!(real.is_file(), "{shown}: cannot be written: it is not a file; choose another name");
    }
    check_writable(folder(output)).with_context(|| format!("{shown}: cannot be written"))?;
    Ok(())
}
