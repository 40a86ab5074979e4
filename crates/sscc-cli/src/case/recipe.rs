//! Models by what they are made from: a shape, a material and a kind of modes.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use glam::DQuat;
use sscc::{Metric, MetricKind, ReducedModel, TriMesh};
use sscc_io::{ModelInfo, read_mesh};
use sscc_modes::shapes::{hare, serpent, spring_of};
use sscc_modes::{
    DEFAULT_ELL, energy_metric, filter_eigenvalues, linear_modes, nonlinear_modes, polynomial_solid_modes,
};

use super::cache::Key;
use crate::commands::modes::{AskedMaterial, Source, elasticity, is_solid};
use crate::load::in_file;
use crate::progress::Bar;

/// A free elastic body with modes.
#[derive(Clone, Debug)]
pub struct Recipe {
    pub name: String,
    pub shape: Shape,
    pub kind: Kind,
    /// Goes before what the file of a solid names.
    pub material: AskedMaterial,
    /// Cubes along the longest side of the lattice around a surface; none: as many as the shape has by default.
    pub cells: Option<usize>,
    /// The longest side of the box around a surface; none: as it is.
    pub size: Option<f64>,
    /// How far q goes along each mode as a rule: certificates measure it in these units. None: in the model's metric.
    pub spread: Option<Vec<f64>>,
}

/// A shape to begin with.
#[derive(Clone, Debug)]
pub enum Shape {
    /// The embedded spring, finer or coarser.
    Spring { rings: usize, around: usize },
    /// The bunny; without files the embedded hare.
    Bunny,
    /// The dragon; without files the embedded serpent.
    Dragon,
    /// A surface or a solid.
    File(PathBuf),
}

/// Modes of a free elastic body.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Linear(usize),
    Nonlinear(usize),
    Polynomial,
}

impl Kind {
    /// Number of modes r.
    pub fn rank(self) -> usize {
        match self {
            Self::Linear(rank) | Self::Nonlinear(rank) => rank,
            Self::Polynomial => 24,
        }
    }
}

/// Rings of the embedded spring, and vertices of each.
pub const SPRING_RINGS: [usize; 2] = [500, 16];

/// Cubes along the spring, as in the library's `elastic_spring`.
const SPRING_CELLS: usize = 30;

impl Shape {
    /// The embedded spring of 16,000 triangles.
    pub const SPRING: Self = Self::Spring { rings: SPRING_RINGS[0], around: SPRING_RINGS[1] };
    /// A quarter of the triangles.
    pub const SMALL_SPRING: Self = Self::Spring { rings: SPRING_RINGS[0] / 2, around: SPRING_RINGS[1] / 2 };

    /// Reads or makes it.
    fn begin(
        &self,
        models: Option<&Path>,
        material: &AskedMaterial,
    ) -> Result<(Matter, String, Option<String>)> {
        let (file, name, embedded): (_, _, fn() -> TriMesh) = match self {
            Self::Spring { rings, around } => {
                return Ok((Matter::Surface(spring_of(*rings, *around)), "embedded spring".into(), None));
            }
            Self::File(path) => {
                let name: String = path.file_name().unwrap_or_default().to_string_lossy().into();
                if !is_solid(path) {
                    return Ok((Matter::Surface(read_mesh(path)?), name, None));
                }
                let whole = Source::read(path, None, material, &Bar::new("modes"));
                let whole = whole.map_err(|error| in_file(error, path))?;
                let replaced = whole.material().replaced.as_ref();
                let note = replaced
                    .map(|replaced| format!("the scene's material overrides what {name} states: {replaced}"));
                return Ok((Matter::Solid(Box::new(whole)), name, note));
            }
            Self::Bunny => ("bunny_14964_closed.obj", "hare", hare),
            Self::Dragon => ("dragon_77202_closed.ply", "serpent", serpent),
        };
        Ok(match models {
            Some(folder) => (Matter::Surface(read_mesh(&folder.join(file))?), file.into(), None),
            None => (
                Matter::Surface(embedded()),
                format!("embedded {name}"),
                Some(format!("the embedded {name} stands in for {file}: no --models given")),
            ),
        })
    }
}

impl Recipe {
    /// Of the default material, in its own size and its usual lattice.
    pub fn new(name: impl Into<String>, shape: Shape, kind: Kind) -> Self {
        Self {
            name: name.into(),
            shape,
            kind,
            material: AskedMaterial::default(),
            cells: None,
            size: None,
            spread: None,
        }
    }

    /// Cubes along the longest side of the lattice; none: as many as any surface has.
    fn cells(&self) -> Option<usize> {
        let usual = matches!(self.shape, Shape::Spring { .. }).then_some(SPRING_CELLS);
        self.cells.or(usual)
    }

    /// The metric of certificates of a model made from this.
    pub fn metric(&self, model: &ReducedModel) -> Result<Metric> {
        let Some(spread) = &self.spread else { return Ok(model.metric().clone()) };
        let scales = spread.iter().map(|far| 1.0 / far).collect();
        Metric::from_scales(MetricKind::Given, scales).with_context(|| format!("{}: spread", self.name))
    }

    /// Reads or makes the shape.
    pub fn begin(&self, models: Option<&Path>) -> Result<Begun<'_>> {
        let (mut matter, source, note) = self.shape.begin(models, &self.material)?;
        match (&mut matter, self.size) {
            (Matter::Surface(mesh), Some(size)) => *mesh = resized(mesh, size)?,
            (Matter::Solid(_), Some(_)) => {
                bail!("{source}: size is for surfaces; a solid's file has its own")
            }
            (_, None) => {}
        }
        ensure!(
            self.cells.is_none() || matches!(matter, Matter::Surface(_)),
            "{source}: resolution is for surfaces; a solid's file brings its own elements"
        );
        // The files have y up, embedded shapes z.
        let is_turned = models.is_some() && matches!(self.shape, Shape::Bunny | Shape::Dragon);
        let upright =
            if is_turned { DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2) } else { DQuat::IDENTITY };
        Ok(Begun { recipe: self, matter, source, note, upright, around: OnceCell::new() })
    }
}

/// The shape of a recipe, before anything that takes long.
pub struct Begun<'a> {
    recipe: &'a Recipe,
    matter: Matter,
    /// Where the shape is from.
    pub source: String,
    /// What an embedded shape stands in for, or which numbers of a file a material replaces.
    pub note: Option<String>,
    /// From its own axes to those of a shape that stands upright, z up.
    pub upright: DQuat,
    /// The lattice around a surface.
    around: OnceCell<Source>,
}

enum Matter {
    Surface(TriMesh),
    Solid(Box<Source>),
}

impl Begun<'_> {
    pub fn recipe(&self) -> &Recipe {
        self.recipe
    }

    /// The hash of all that something of this solid is made from.
    pub fn key(&self, what: &str) -> Key {
        let material = self.recipe.material.alone();
        let key = Key::new(what).text(&format!("{material:?} {:?}", self.recipe.cells()));
        match &self.matter {
            Matter::Surface(mesh) => key.mesh(mesh),
            Matter::Solid(source) => key.text(&format!("{:?}", source.solid())),
        }
    }

    /// The solid with its surface.
    pub fn solid(&self) -> Result<&Source> {
        let mesh = match &self.matter {
            Matter::Solid(source) => return Ok(source),
            Matter::Surface(mesh) => mesh,
        };
        if let Some(source) = self.around.get() {
            return Ok(source);
        }
        let Recipe { material, .. } = self.recipe;
        let around = Source::around(mesh.clone(), self.recipe.cells(), material, &Bar::new("solid"));
        let around = around.with_context(|| self.source.clone())?;
        Ok(self.around.get_or_init(|| around))
    }

    /// Makes modes; takes up to some minutes.
    pub fn modes(&self, kind: Kind) -> Result<(ReducedModel, ModelInfo)> {
        let source = self.solid()?;
        let bar = Bar::new("modes");
        let (solid, modes) = match kind {
            Kind::Linear(rank) => (linear_modes(source.solid(), &[], rank, &bar)?, None),
            Kind::Nonlinear(rank) => (nonlinear_modes(source.solid(), &[], rank, &bar)?, None),
            Kind::Polynomial => {
                let (solid, modes) = polynomial_solid_modes(source.solid(), source.mesh(), &bar)?;
                (solid, Some(modes))
            }
        };
        let modes = match modes {
            Some(modes) => modes,
            None => source.on_surface(&solid.modes)?,
        };
        // As `sscc modes` does.
        let weights = match kind {
            Kind::Linear(_) => solid.eigenvalues.clone(),
            _ => filter_eigenvalues(&solid.eigenvalues, DEFAULT_ELL)?,
        };
        let model = ReducedModel::with_metric(source.mesh().clone(), modes, energy_metric(&weights)?)?;
        let info = ModelInfo::new("", format!("{}, {kind:?}", self.source))
            .with_elasticity(elasticity(solid.eigenvalues, solid.forces));
        Ok((model, info))
    }
}

/// The same shape, the longest side of its box so long.
fn resized(mesh: &TriMesh, size: f64) -> Result<TriMesh> {
    let rest = mesh.rest_positions();
    let (lower, upper) = rest.iter().fold((rest[0], rest[0]), |(a, b), p| (a.min(*p), b.max(*p)));
    let scale = size / (upper - lower).max_element();
    ensure!(scale.is_finite() && scale > 0.0, "a shape of no size cannot be made {size:e} long");
    Ok(TriMesh::new(rest.iter().map(|p| p * scale).collect(), mesh.faces().to_vec())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_tells_the_cells_that_a_shape_has_by_itself() {
        let key = |cells| {
            let recipe = Recipe { cells, ..Recipe::new("spring", Shape::SMALL_SPRING, Kind::Linear(6)) };
            recipe.begin(None).unwrap().key("model").to_string()
        };
        assert_eq!(key(None), key(Some(SPRING_CELLS)));
        assert_ne!(key(None), key(Some(SPRING_CELLS + 1)));
    }

    /// One tetrahedron of a soft material.
    const SOFT: &str = "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n\
        *MATERIAL soft\nENU, 1000, 1e6, 0.4\n*REGION\nallElements, soft\n";

    #[test]
    fn a_scenes_material_goes_before_that_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("soft.veg");
        std::fs::write(&file, SOFT).unwrap();
        let first = |material: AskedMaterial| {
            let recipe = Recipe::new("soft", Shape::File(file.clone()), Kind::Linear(6));
            let recipe = Recipe { material, ..recipe };
            let begun = recipe.begin(None).unwrap();
            let (_, info) = begun.modes(Kind::Linear(6)).unwrap();
            (info.elasticity.unwrap().stiffness()[0], begun.note.clone(), begun.key("model").to_string())
        };
        let (own, nothing, key) = first(AskedMaterial::default());
        assert_eq!(nothing, None);
        let (stiff, note, of_stiff) = first(AskedMaterial { youngs: Some(4e6), ..Default::default() });
        assert!((stiff / own - 4.0).abs() < 1e-9, "{own} {stiff}");
        let said = "the scene's material overrides what soft.veg states: youngs=4e6";
        assert_eq!(note.as_deref(), Some(said));
        assert_ne!(key, of_stiff);
    }

    #[test]
    fn the_spread_is_the_unit_of_certificates() {
        let plain = Recipe::new("spring", Shape::SMALL_SPRING, Kind::Linear(6));
        let (model, _) = plain.begin(None).unwrap().modes(Kind::Linear(6)).unwrap();
        assert_eq!(&plain.metric(&model).unwrap(), model.metric());
        let spread = vec![0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
        let metric = Recipe { spread: Some(spread.clone()), ..plain }.metric(&model).unwrap();
        assert_eq!(metric.kind(), MetricKind::Given);
        assert!((metric.norm(&spread) - 6.0_f64.sqrt()).abs() < 1e-12);
    }
}
