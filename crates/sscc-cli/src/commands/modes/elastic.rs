//! Modes of elastic solids.

use anyhow::{Result, bail};
use sscc::{Modes, Progress};
use sscc_io::{Cubic, Elasticity};
use sscc_modes::{
    DEFAULT_ELL, ReducedForces, SolidModes, energy_metric, filter_eigenvalues, linear_modes, nonlinear_modes,
    polynomial_solid_modes,
};

use super::fix::Fix;
use super::source::Source;
use super::{AskedMaterial, Made, POLYNOMIALS_ARE_FREE, name};
use crate::args::{self, ModesKind};
use crate::output::note;
use crate::progress::Bar;

/// Modes, if no number is given.
const LINEAR_RANK: usize = 20;
const NONLINEAR_RANK: usize = 30;

pub fn make(args: &args::Modes) -> Result<Made> {
    if args.kind == ModesKind::Polynomial && (args.rank.is_some() || args.fix.is_some()) {
        bail!(POLYNOMIALS_ARE_FREE);
    }
    let asked = args.material.as_deref().map(AskedMaterial::parse).transpose()?.unwrap_or_default();
    let fix = args.fix.as_deref().map(Fix::parse).transpose()?;
    let bar = Bar::new("modes");
    let source = Source::read(&args.source, args.resolution, &asked, &bar)?;
    if let Some(replaced) = &source.material().replaced {
        note(format!("--material overrides what the file states: {replaced}"));
    }
    let fixed = fix.map_or_else(|| Ok(Vec::new()), |fix| fix.vertices(&source))?;
    of_solid(args.kind, args.rank.map(|rank| rank as usize), source, &fixed, name(args), &bar)
}

/// Modes of a solid with fixed vertices; without a rank as many as usual. `name` is that of the source.
pub fn of_solid(
    kind: ModesKind,
    rank: Option<usize>,
    source: Source,
    fixed: &[u32],
    name: String,
    progress: &dyn Progress,
) -> Result<Made> {
    if kind == ModesKind::Polynomial && (rank.is_some() || !fixed.is_empty()) {
        bail!(POLYNOMIALS_ARE_FREE);
    }
    let solid = source.solid();
    let (found, of_surface): (SolidModes, Modes) = match kind {
        ModesKind::Linear => {
            let found = linear_modes(solid, fixed, rank.unwrap_or(LINEAR_RANK), progress)?;
            let modes = source.on_surface(&found.modes)?;
            (found, modes)
        }
        ModesKind::Nonlinear => {
            let found = nonlinear_modes(solid, fixed, rank.unwrap_or(NONLINEAR_RANK), progress)?;
            let modes = source.on_surface(&found.modes)?;
            (found, modes)
        }
        ModesKind::Polynomial => polynomial_solid_modes(solid, source.mesh(), progress)?,
        ModesKind::Pca => unreachable!("principal components are made without a solid"),
    };
    // Natural frequencies are as they are; those of other modes may be very high, and are filtered (paper, section 6).
    let weights = match kind {
        ModesKind::Linear => found.eigenvalues.clone(),
        _ => filter_eigenvalues(&found.eigenvalues, DEFAULT_ELL)?,
    };
    let (elements, freedom) =
        (solid.tets().len() + solid.cubes().len(), 3 * (solid.vertices().len() - fixed.len()));
    let of_source = if source.is_embedded() { "mesh" } else { "solid" };
    let made_of = &source.material().provenance;
    let provenance = format!(
        "{of_source} {name}, {} modes, {elements} elements, {freedom} degrees of freedom, {made_of}",
        kind.name(),
    );
    let frequencies = found.frequencies();
    Ok(Made {
        is_split: source.is_split(),
        metric: Some(energy_metric(&weights)?),
        elasticity: Some(elasticity(found.eigenvalues, found.forces)),
        mesh: source.into_mesh(),
        modes: of_surface,
        elements: Some(elements),
        degrees_of_freedom: Some(freedom),
        frequencies: Some(frequencies),
        components: None,
        provenance,
    })
}

/// The forces as a model file holds them.
pub fn elasticity(eigenvalues: Vec<f64>, forces: Option<ReducedForces>) -> Elasticity {
    let rank = eigenvalues.len();
    let mut stiffness = vec![0.0; rank * rank];
    eigenvalues.iter().enumerate().for_each(|(k, x)| stiffness[k * (rank + 1)] = *x);
    match forces {
        None => Elasticity::Linear(stiffness),
        // The linear part is that diagonal, but for rounding.
        Some(ReducedForces { quadratic, cubic, .. }) => {
            Elasticity::Nonlinear(Cubic { rank, linear: stiffness, quadratic, cubic })
        }
    }
}
