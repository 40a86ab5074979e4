//! Shapes of recipes: embedded shapes and files.

use std::env;
use std::path::{Path, PathBuf};

use sscc::TriMesh;
use sscc_io::{Message, Setting, read_mesh_with_warnings, read_volume_mesh, read_volume_mesh_with_warnings};
use sscc_modes::shapes::{hare, serpent, spring_of};
use sscc_solid::PartialMaterial;

use super::given_model::{GivenModel, ModelFiles};
use crate::error::At;
use crate::models::{SolidSource, is_solid, read_embedded};
use crate::resize::{Resize, scaled};
use crate::text::file_name;
use crate::{TaskError, Watch};

/// Number of rings of the embedded spring, and number of vertices of each ring.
pub const SPRING_RINGS: [usize; 2] = [500, 16];

/// Shape of a recipe.
#[derive(Clone, Debug)]
pub enum Shape {
    /// The embedded spring with a given resolution.
    Spring {
        /// Number of rings.
        rings: usize,
        /// Number of vertices of each ring.
        around: usize,
    },
    /// The bunny; the embedded hare if there are no files.
    Bunny,
    /// The dragon; the embedded serpent if there are no files.
    Dragon,
    /// A surface or a solid.
    File(PathBuf),
    /// A surface embedded in a solid.
    Embedded {
        /// The surface.
        surface: PathBuf,
        /// The solid.
        solid: PathBuf,
    },
    /// A model whose file contains modes.
    Model(ModelFiles),
}

/// Content of a loaded shape.
pub(super) enum Matter {
    /// A surface, without a lattice.
    Surface(TriMesh),
    /// A solid from a file, with or without a separate surface.
    Solid(Box<SolidSource>),
    /// A model whose file contains modes.
    Model(Box<GivenModel>),
}

/// A shape with its origin.
pub(super) struct LoadedShape {
    pub matter: Matter,
    pub source: String,
    /// A note, for example on an embedded shape in place of a file.
    pub note: Option<String>,
    /// Factor on the lengths of its files.
    pub factor: f64,
}

impl Shape {
    /// The embedded spring of 16,000 triangles.
    pub const SPRING: Self = Self::Spring { rings: SPRING_RINGS[0], around: SPRING_RINGS[1] };
    /// The embedded spring of 4,000 triangles.
    pub const SMALL_SPRING: Self = Self::Spring { rings: SPRING_RINGS[0] / 2, around: SPRING_RINGS[1] / 2 };

    /// Reads or generates the shape. `models` is the folder of real models.
    pub(super) fn load(
        &self,
        models: Option<&Path>,
        material: &PartialMaterial,
        resize: Resize,
        watch: &dyn Watch,
    ) -> Result<LoadedShape, TaskError> {
        let surface = |mesh: TriMesh, source: String, note| -> Result<LoadedShape, TaskError> {
            let factor = resize.factor(mesh.rest_positions()).at(|| source.clone())?;
            let matter = Matter::Surface(scaled(mesh, factor)?);
            Ok(LoadedShape { matter, source, note, factor })
        };
        let solid = |solid: SolidSource, source: String, factor| -> Result<LoadedShape, TaskError> {
            let replaced = solid.material().replaced.as_ref();
            let note = replaced
                .map(|replaced| format!("the scene's material overrides numbers of {source}: {replaced}"));
            Ok(LoadedShape { matter: Matter::Solid(Box::new(solid)), source, note, factor })
        };
        let (file, name, embedded): (_, _, fn() -> TriMesh) = match self {
            Self::Spring { rings, around } => {
                return surface(spring_of(*rings, *around), "embedded spring".into(), None);
            }
            Self::File(path) if !is_solid(path) => {
                let (mesh, warnings) = read_mesh_with_warnings(path)?;
                let source = file_name(path);
                let note = note_of(&source, &warnings);
                return surface(mesh, source, note);
            }
            Self::File(path) => {
                let (file, left_out) = read_volume_mesh_with_warnings(path)?;
                let factor = resize.factor(file.vertices()).in_file(path)?;
                let file = file.scaled(factor).in_file(path)?;
                let found = SolidSource::whole(&file, material).in_file(path)?;
                return solid(found.with_warnings(left_out), file_name(path), factor);
            }
            Self::Embedded { surface, solid: path } => {
                let (mesh, warnings) = read_embedded(surface).in_file(surface)?;
                let factor = resize.factor(mesh.rest_positions()).in_file(surface)?;
                let file = read_volume_mesh(path)?.scaled(factor).in_file(path)?;
                let found = SolidSource::embedded(scaled(mesh, factor)?, &file, material, watch);
                let source = format!("{} in {}", file_name(surface), file_name(path));
                return solid(found.in_file(path)?.with_warnings(warnings), source, factor);
            }
            Self::Model(files) => {
                let given = GivenModel::load(files, material, resize)?;
                let source = file_name(&files.path);
                let notes: Vec<String> =
                    note_of(&source, &given.warnings).into_iter().chain(given.assumed.clone()).collect();
                let note = (!notes.is_empty()).then(|| notes.join("; "));
                return Ok(LoadedShape { matter: Matter::Model(Box::new(given)), source, note, factor: 1.0 });
            }
            Self::Bunny => ("bunny_14964_closed.obj", "hare", hare),
            Self::Dragon => ("dragon_77202_closed.ply", "serpent", serpent),
        };
        match models {
            Some(folder) => {
                let (mesh, warnings) = read_mesh_with_warnings(&folder.join(file))?;
                surface(mesh, file.into(), note_of(file, &warnings))
            }
            None => surface(
                embedded(),
                format!("embedded {name}"),
                Some(format!(
                    "the embedded {name} stands in for {file}: no {} given",
                    watch.name(Setting::Models)
                )),
            ),
        }
    }
}

/// Returns the warnings about a file as one note, if there are any.
fn note_of(source: &str, warnings: &[String]) -> Option<String> {
    (!warnings.is_empty()).then(|| format!("{source}: {}", warnings.join("; ")))
}

/// Returns the folder of real models: `wanted`, else the folder in the environment variable `SSCC_MODELS`, else None.
///
/// # Errors
/// When that path is not a folder.
pub fn models_folder(wanted: Option<&Path>) -> Result<Option<PathBuf>, TaskError> {
    let named = env::var_os("SSCC_MODELS").filter(|folder| !folder.is_empty()).map(PathBuf::from);
    let (folder, named_by) = match (wanted, named) {
        (Some(wanted), _) => (wanted.to_owned(), Message::from(Setting::Models)),
        (None, Some(named)) => (named, "the environment variable SSCC_MODELS".into()),
        (None, None) => return Ok(None),
    };
    if !folder.is_dir() {
        let cause = Message::from("no folder of models; leave out ");
        return Err(TaskError::refused(folder.display(), cause + named_by));
    }
    Ok(Some(folder))
}
