//! Models of elastic solids, as `sscc modes` makes them: for programs that bring their own mesh and progress.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use sscc::{Progress, ReducedModel, TriMesh};
use sscc_io::ModelInfo;
use sscc_modes::polynomial_modes;

use crate::args::ModesKind;
pub use crate::commands::modes::AskedMaterial;
use crate::commands::modes::{Made, Source, is_solid, of_solid};

/// Kinds of modes of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The lowest natural vibrations.
    Linear,
    /// A basis for large deformations, with its forces.
    Nonlinear,
    /// The 24 quadratic polynomials of the rest position, with the forces of the solid.
    Polynomial,
}

/// Where the body comes from.
#[derive(Clone, Debug)]
pub enum Body<'a> {
    /// A mesh or a solid in a file.
    File(&'a Path),
    /// A surface.
    Surface(TriMesh),
}

/// What is asked for beside the kind.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Wanted {
    /// Number of modes; none: 20 linear, 30 nonlinear ones. Polynomial modes are always 24.
    pub rank: Option<usize>,
    /// What the body is made of; numbers left out are those of the file, else 1e6, 0.4 and 1000.
    pub material: AskedMaterial,
    /// Vertices that do not move.
    pub fixed: Vec<u32>,
    /// All vertices in this box (two corners) do not move either.
    pub fixed_box: Option<[DVec3; 2]>,
    /// Cubes along the longest side of a lattice around a surface; none: for about 20,000 in all.
    pub resolution: Option<u32>,
}

/// A model that was made.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Model {
    /// Its metric is the strain energy.
    pub model: ReducedModel,
    /// With the stiffness and the forces.
    pub info: ModelInfo,
    /// Whether its vertices are split along seams, so that certificates are to weld them.
    pub is_split: bool,
}

/// A model of an elastic body.
///
/// # Errors
/// When the file cannot be read, the surface is open or meets itself, a fixed vertex does not exist, the material is
/// out of range, or `progress` cancels.
pub fn elastic(body: Body<'_>, kind: Kind, wanted: Wanted, progress: &dyn Progress) -> Result<Model> {
    let Wanted { rank, material, fixed, fixed_box, resolution } = wanted;
    let (source, name) = match body {
        Body::File(path) => (Source::read(path, resolution, &material, progress)?, name(path)),
        Body::Surface(mesh) => {
            let cells = resolution.map(|cells| cells as usize);
            (Source::around(mesh, cells, &material, progress)?, "in memory".into())
        }
    };
    let mut held = Vec::new();
    for number in fixed {
        held.extend(source.holding(number).context("fix")?);
    }
    if let Some([a, b]) = fixed_box {
        let within = source.within(a.min(b), a.max(b));
        ensure!(!within.is_empty(), "fix_box: no vertex is there");
        held.extend(within);
    }
    held.sort_unstable();
    held.dedup();
    let kind = match kind {
        Kind::Linear => ModesKind::Linear,
        Kind::Nonlinear => ModesKind::Nonlinear,
        Kind::Polynomial => ModesKind::Polynomial,
    };
    let made = of_solid(kind, rank, source, &held, name, progress)?;
    let is_split = made.is_split;
    let (model, info) = made.into_model()?;
    Ok(Model { model, info, is_split })
}

/// Polynomial modes of a surface alone, which needs no volume and gets no stiffness.
///
/// # Errors
/// When the file cannot be read or is a solid, or the surface has no area.
pub fn polynomial(body: Body<'_>) -> Result<Model> {
    let (mesh, name) = match body {
        Body::File(path) => (sscc_io::read_mesh(path)?, name(path)),
        Body::Surface(mesh) => (mesh, "in memory".into()),
    };
    let modes = polynomial_modes(&mesh)?;
    let (model, info) = Made::polynomial(mesh, modes, &name).into_model()?;
    Ok(Model { model, info, is_split: false })
}

/// Whether a file holds a volumetric mesh, by its ending.
pub fn is_volumetric(path: &Path) -> bool {
    is_solid(path)
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
