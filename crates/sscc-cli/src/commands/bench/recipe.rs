//! The models of the benches, and how they are made.

use std::path::Path;

use anyhow::{Context, Result};
use sscc::{ReducedModel, TriMesh};
use sscc_io::{ModelInfo, read_mesh};
use sscc_modes::shapes::{hare, serpent, spring_of};
use sscc_modes::{
    DEFAULT_ELL, Embedded, Material, energy_metric, filter_eigenvalues, linear_modes, nonlinear_modes,
    polynomial_solid_modes,
};

use crate::commands::modes::elasticity;
use crate::progress::Bar;

/// A shape with its modes.
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    pub name: &'static str,
    pub shape: Shape,
    pub kind: Kind,
}

/// A shape to begin with.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// The embedded spring, finer or coarser.
    Spring { rings: usize, around: usize },
    /// The bunny; without files the embedded hare.
    Bunny,
    /// The dragon; without files the embedded serpent.
    Dragon,
}

/// Modes of a free elastic body.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Linear(usize),
    Nonlinear(usize),
    Polynomial,
}

/// Rings of the embedded spring, and vertices of each.
pub const SPRING_RINGS: [usize; 2] = [500, 16];

/// Cubes along the spring, as in the library's `elastic_spring`.
const SPRING_CELLS: usize = 30;

const fn recipe(name: &'static str, shape: Shape, kind: Kind) -> Recipe {
    Recipe { name, shape, kind }
}

const EMBEDDED_SPRING: Shape = Shape::Spring { rings: SPRING_RINGS[0], around: SPRING_RINGS[1] };
pub const SPRING: Recipe = recipe("spring", EMBEDDED_SPRING, Kind::Linear(20));
/// In place of any other, where a quick look is wanted: a quarter of the triangles, the first spring of `growth`.
pub const QUICK: Recipe = recipe(
    "spring-4k",
    Shape::Spring { rings: SPRING_RINGS[0] / 2, around: SPRING_RINGS[1] / 2 },
    Kind::Linear(20),
);
pub const BUNNY: Recipe = recipe("bunny", Shape::Bunny, Kind::Linear(30));
pub const DRAGON: Recipe = recipe("dragon", Shape::Dragon, Kind::Linear(30));
pub const BUNNY_NONLINEAR: Recipe = recipe("bunny", Shape::Bunny, Kind::Nonlinear(30));
pub const DRAGON_NONLINEAR: Recipe = recipe("dragon", Shape::Dragon, Kind::Nonlinear(30));
pub const DRAGON_POLYNOMIAL: Recipe = recipe("dragon", Shape::Dragon, Kind::Polynomial);

/// A mesh, and where it is from.
pub struct Surface {
    pub mesh: TriMesh,
    pub source: String,
    /// What an embedded shape stands in for.
    pub note: Option<String>,
}

impl Shape {
    /// The mesh: from a file of the folder, or embedded.
    pub fn surface(self, models: Option<&Path>) -> Result<Surface> {
        let (file, name, embedded): (_, _, fn() -> TriMesh) = match self {
            Self::Spring { rings, around } => {
                let mesh = spring_of(rings, around);
                return Ok(Surface { mesh, source: "embedded spring".into(), note: None });
            }
            Self::Bunny => ("bunny_14964_closed.obj", "hare", hare),
            Self::Dragon => ("dragon_77202_closed.ply", "serpent", serpent),
        };
        Ok(match models {
            Some(folder) => Surface { mesh: read_mesh(&folder.join(file))?, source: file.into(), note: None },
            None => Surface {
                mesh: embedded(),
                source: format!("embedded {name}"),
                note: Some(format!("the embedded {name} stands in for {file}: no --models given")),
            },
        })
    }

    fn cells(self) -> Option<usize> {
        matches!(self, Self::Spring { .. }).then_some(SPRING_CELLS)
    }
}

impl Recipe {
    /// Makes the modes; takes up to some minutes.
    pub fn make(&self, surface: Surface) -> Result<(ReducedModel, ModelInfo)> {
        let Surface { mesh, source, .. } = surface;
        let bar = Bar::new("modes");
        let in_source = || source.clone();
        let body =
            Embedded::new(&mesh, self.shape.cells(), Material::default(), &bar).with_context(in_source)?;
        let (solid, modes) = match self.kind {
            Kind::Linear(rank) => (linear_modes(body.solid(), &[], rank, &bar)?, None),
            Kind::Nonlinear(rank) => (nonlinear_modes(body.solid(), &[], rank, &bar)?, None),
            Kind::Polynomial => {
                let (solid, modes) = polynomial_solid_modes(body.solid(), &mesh, &bar)?;
                (solid, Some(modes))
            }
        };
        let modes = match modes {
            Some(modes) => modes,
            None => body.on_surface(&solid.modes)?,
        };
        // As `sscc modes` does.
        let weights = match self.kind {
            Kind::Linear(_) => solid.eigenvalues.clone(),
            _ => filter_eigenvalues(&solid.eigenvalues, DEFAULT_ELL)?,
        };
        let model = ReducedModel::with_metric(mesh, modes, energy_metric(&weights)?)?;
        let info = ModelInfo::new("", format!("{source}, {:?}", self.kind))
            .with_elasticity(elasticity(solid.eigenvalues, solid.forces));
        Ok((model, info))
    }
}
