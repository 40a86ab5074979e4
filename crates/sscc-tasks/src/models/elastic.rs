//! Modes of elastic solids, as modes of their surface.

use sscc::{Modes, Progress, ReducedModel};
use sscc_io::{ModelInfo, Setting};
use sscc_modes::{PolynomialModes, SolidModes, linear_modes, nonlinear_modes, polynomial_solid_modes};
use sscc_solid::{MassData, Solid};

use super::new_model::{NewModel, SolidFacts};
use super::source::SolidSource;
use crate::TaskError;

/// Default number of linear modes.
const LINEAR_RANK: usize = 20;

/// Default number of nonlinear modes.
const NONLINEAR_RANK: usize = 30;

/// Maximum number of tetrahedra whose stiffness is compared with that of the same tetrahedra in second order, which have
/// about seven times as many vertices.
const MAX_COMPARED: usize = 5000;

/// Cause of the error if polynomial modes are requested with a rank or with fixed vertices.
pub const POLYNOMIAL_MODES_ERROR: &str =
    "there are at most 24 polynomial modes, without fixed vertices: leave these flags out";

/// Kinds of modes of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModesKind {
    /// The lowest natural vibrations.
    Linear,
    /// A basis for large deformations, with its forces.
    Nonlinear,
    /// The 24 quadratic polynomials of the rest position, fewer for small solids, with the forces of the solid.
    Polynomial,
}

impl ModesKind {
    /// Returns its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Nonlinear => "nonlinear",
            Self::Polynomial => "polynomial",
        }
    }
}

/// Modes of a solid, the same modes on its surface, and its mass.
pub(crate) struct ElasticModes {
    pub solid: SolidModes,
    pub on_surface: Modes,
    pub mass: MassData,
}

impl ElasticModes {
    /// Computes the modes. This takes up to some minutes.
    pub fn new(
        source: &SolidSource,
        kind: ModesKind,
        rank: Option<usize>,
        fixed: &[u32],
        progress: &dyn Progress,
    ) -> Result<Self, TaskError> {
        let solid = source.solid();
        let (found, on_surface) = match kind {
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
            ModesKind::Polynomial => {
                let PolynomialModes { solid: found, surface } =
                    polynomial_solid_modes(solid, source.mesh(), progress)?;
                (found, surface)
            }
        };
        let moments = solid.mode_moments(&found.modes)?;
        let mass = MassData { properties: solid.mass_properties(), moments, is_held: !fixed.is_empty() };
        Ok(Self { solid: found, on_surface, mass })
    }
}

/// Computes a model of a solid with fixed vertices (numbers of the solid, ascending). Without a rank it has 20 linear or 30
/// nonlinear modes. `name` is the name of the source, for the provenance.
///
/// # Errors
/// When polynomial modes are requested with a rank or fixed vertices, a fixed vertex does not exist, all vertices are
/// fixed, the solid has fewer modes, its parts share only edges or vertices, its stiffness is out of range, memory is
/// short, or `progress` cancels.
pub fn elastic_model(
    kind: ModesKind,
    rank: Option<usize>,
    source: SolidSource,
    fixed: &[u32],
    name: &str,
    progress: &dyn Progress,
) -> Result<NewModel, TaskError> {
    if kind == ModesKind::Polynomial && (rank.is_some() || !fixed.is_empty()) {
        return Err(TaskError::refused(Setting::Rank + " and " + Setting::Fix, POLYNOMIAL_MODES_ERROR));
    }
    let ElasticModes { solid: found, on_surface, mass } =
        ElasticModes::new(&source, kind, rank, fixed, progress)?;
    let solid = source.solid();
    let (elements, freedom) = (solid.element_count(), 3 * (solid.vertices().len() - fixed.len()));
    let of_source = if source.is_embedded() { "mesh" } else { "solid" };
    let made_of = &source.material().provenance;
    let provenance = format!(
        "{of_source} {name}, {} modes, {elements} elements, {freedom} degrees of freedom, {made_of}",
        kind.name(),
    );
    let (frequencies, kilograms) = (found.frequencies(), mass.properties.mass);
    let second_order = match kind {
        ModesKind::Linear | ModesKind::Nonlinear if !source.is_embedded() => {
            first_of_second_order(solid, fixed, progress)?
        }
        _ => None,
    };
    let metric = found.energy_metric()?;
    Ok(NewModel {
        model: ReducedModel::with_metric(source.into_mesh(), on_surface, metric)?,
        info: ModelInfo::new("", provenance).with_elasticity(found.elasticity).with_mass(mass),
        solid: Some(SolidFacts {
            elements,
            degrees_of_freedom: freedom,
            mass: kilograms,
            frequencies,
            second_order,
        }),
        components: None,
    })
}

/// Returns the first frequency (Hz) of a solid of linear tetrahedra with its tetrahedra in second order; None for other or
/// large solids, or if the computation fails.
fn first_of_second_order(
    solid: &Solid,
    fixed: &[u32],
    progress: &dyn Progress,
) -> Result<Option<f64>, TaskError> {
    if !solid.cubes().is_empty() || !solid.tets10().is_empty() || solid.tets().len() > MAX_COMPARED {
        return Ok(None);
    }
    // Nearly flat tetrahedra cannot be elevated to second order.
    let Ok((elevated, edges)) = solid.elevated() else { return Ok(None) };
    let is_fixed = |v: &u32| fixed.binary_search(v).is_ok();
    let corners = solid.vertices().len();
    let middles = edges.iter().zip(corners as u32..).filter(|(edge, _)| edge.iter().all(is_fixed));
    let fixed: Vec<u32> = fixed.iter().copied().chain(middles.map(|(_, v)| v)).collect();
    // The result is only for a note, so only a cancellation ends the run.
    match linear_modes(&elevated, &fixed, 1, progress) {
        Ok(modes) => Ok(modes.frequencies().first().copied()),
        Err(error) if progress.is_cancelled() => Err(error.into()),
        Err(_) => Ok(None),
    }
}
