//! `sscc.modes`: models with computed modes, from bodies and from samples.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sscc::{Progress, TriMesh};
use sscc_io::read_frames;
use sscc_solid::PartialMaterial;
use sscc_tasks::{
    ModesKind, NewModel, SolidSource, TaskError, elastic_model, is_solid, pca_model, polynomial_model,
    read_surface,
};

use crate::arguments::{choice, count, number};
use crate::arrays::{floats, integers};
use crate::errors::{file, kind, room, value, warn};
use crate::interrupt::{run, run_detachable};
use crate::model::{LoadedModel, Model, mesh, mesh_of, points};
use crate::pool;
use crate::watching::Phases;

/// A file with a mesh or solid, or a surface as `(vertices, faces)`.
enum Source {
    File(PathBuf),
    Surface(TriMesh),
}

impl Source {
    fn of(any: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(path) = any.extract::<PathBuf>() {
            return Ok(Self::File(path));
        }
        match any.cast::<PyTuple>() {
            Ok(pair) if pair.len() == 2 => Ok(Self::Surface(mesh(&pair.get_item(0)?, &pair.get_item(1)?)?)),
            _ => {
                let found = any.get_type().name()?;
                Err(kind(format!(
                    "source is a {found}: the name of a file or (vertices, faces) was expected"
                )))
            }
        }
    }

    /// Returns the name of the source for the provenance of a model.
    fn name(&self) -> String {
        match self {
            Self::File(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            Self::Surface(_) => "in memory".into(),
        }
    }

    /// Converts an error; the message names the file.
    fn refused(&self, error: &TaskError) -> PyErr {
        match error.file() {
            Some(error) => file(error),
            None => match self {
                Self::File(path) => value(format!("{}: {error}", path.to_string_lossy().escape_debug())),
                Self::Surface(_) => value(format!("source: {error}")),
            },
        }
    }
}

/// Returns the model of an elastic body with linear, nonlinear or polynomial modes.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn _elastic(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    kind: &Bound<'_, PyAny>,
    rank: Option<&Bound<'_, PyAny>>,
    fix: Option<&Bound<'_, PyAny>>,
    fix_box: Option<&Bound<'_, PyAny>>,
    material: [Option<Bound<'_, PyAny>>; 3],
    resolution: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let kinds = [
        ("linear", ModesKind::Linear),
        ("nonlinear", ModesKind::Nonlinear),
        ("polynomial", ModesKind::Polynomial),
    ];
    let kind = choice(Some(kind), "kind", &kinds)?.unwrap_or(ModesKind::Linear);
    let source = Source::of(source)?;
    let mut options = BodyOptions {
        rank: count(rank, "rank", 1..=500)?,
        material: read_material(&material)?,
        resolution: count(resolution, "resolution", 1..=2000)?,
        ..BodyOptions::default()
    };
    options.fixed = fix.map(vertex_numbers).transpose()?;
    if let Some(corners) = fix_box {
        options.fixed_box = Some(two_corners(corners)?);
    }
    let phases = phase_count(&source, kind);
    compute(py, source, threads, progress, phases, move |source, progress| {
        elastic(source, kind, options, progress)
    })
}

/// Returns the number of phases in which the modes are computed: for a surface its lattice; then the vibrations or the forces,
/// for nonlinear modes the vibrations, their derivatives and the forces.
fn phase_count(source: &Source, kind: ModesKind) -> usize {
    let has_lattice = !matches!(source, Source::File(path) if is_solid(path));
    let of_modes = if kind == ModesKind::Nonlinear { 3 } else { 1 };
    usize::from(has_lattice) + of_modes
}

/// Returns the two corners of a box from an array (2, 3).
fn two_corners(corners: &Bound<'_, PyAny>) -> PyResult<[DVec3; 2]> {
    let array = floats(corners, "fix_box")?;
    let wrong = || {
        let shape = array.shape();
        value(format!("fix_box has shape {shape:?}: (2, 3) was expected, two corners of a box"))
    };
    if array.shape() != [2, 3] {
        return Err(wrong());
    }
    let corners: [DVec3; 2] = points(&array, "fix_box")?.try_into().map_err(|_| wrong())?;
    for (row, corner) in corners.iter().enumerate() {
        if let Some(axis) = corner.to_array().iter().position(|x| !x.is_finite()) {
            let x = corner[axis];
            return Err(value(format!("fix_box[{row}][{axis}] is {x}: every entry must be finite")));
        }
    }
    Ok(corners)
}

/// Returns a model with polynomial modes of a surface. A solid in a file adds its stiffness.
#[pyfunction]
pub fn _polynomial(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let source = Source::of(source)?;
    let phases = phase_count(&source, ModesKind::Polynomial);
    compute(py, source, threads, progress, phases, |source, progress| match source {
        Source::File(path) if is_solid(path) => {
            elastic(source, ModesKind::Polynomial, BodyOptions::default(), progress)
        }
        Source::File(path) => {
            let (mesh, warnings) = read_surface(path)?;
            let note = (!warnings.is_empty()).then(|| warnings.join("; "));
            Ok((polynomial_model(mesh, &source.name())?, note))
        }
        Source::Surface(mesh) => Ok((polynomial_model(mesh.clone(), &source.name())?, None)),
    })
}

/// The options of an elastic body, apart from the kind of its modes.
#[derive(Default)]
struct BodyOptions {
    rank: Option<usize>,
    material: PartialMaterial,
    /// Fixed vertices.
    fixed: Option<Vec<u32>>,
    /// A box in which all vertices are fixed, too, as two corners.
    fixed_box: Option<[DVec3; 2]>,
    resolution: Option<usize>,
}

/// Returns the model of an elastic body, and a note on the reading of its file.
fn elastic(
    source: &Source,
    kind: ModesKind,
    options: BodyOptions,
    progress: &dyn Progress,
) -> Result<(NewModel, Option<String>), TaskError> {
    let BodyOptions { rank, material, fixed, fixed_box, resolution } = options;
    let solid = match source {
        Source::File(path) => SolidSource::read(path, resolution, 1.0, &material, progress)?,
        Source::Surface(mesh) => SolidSource::around(mesh.clone(), resolution, &material, progress)?,
    };
    let mut held = Vec::new();
    if let Some(numbers) = fixed {
        for number in numbers {
            held.extend(solid.holding(number).map_err(|error| error.at("fix"))?);
        }
        if held.is_empty() {
            return Err(TaskError::refused(
                "fix",
                "it selects no vertex: name vertices of elements, or leave it out",
            ));
        }
    }
    if let Some([a, b]) = fixed_box {
        let within = solid.within(a.min(b), a.max(b));
        if within.is_empty() {
            return Err(TaskError::refused("fix_box", "it contains no vertex: enlarge or move it"));
        }
        held.extend(within);
    }
    held.sort_unstable();
    held.dedup();
    let note = solid.note();
    Ok((elastic_model(kind, rank, solid, &held, &source.name(), progress)?, note))
}

/// Computes a model on other threads, in this number of phases, and issues the note on its file as a warning.
fn compute(
    py: Python<'_>,
    source: Source,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
    phases: usize,
    make: impl FnOnce(&Source, &dyn Progress) -> Result<(NewModel, Option<String>), TaskError> + Send + 'static,
) -> PyResult<Model> {
    let threads = pool::start(pool::threads(threads)?)?;
    let source = Arc::new(source);
    let of_worker = Arc::clone(&source);
    let model = run(py, progress, "modes", move |progress| {
        let progress = Phases::new(progress, phases);
        threads.install(|| make(&of_worker, &progress))
    })?;
    let (model, note) = model.map_err(|error| source.refused(&error))?;
    warn(py, note.as_slice())?;
    Ok(Model::of(LoadedModel::new(model.model, model.info)))
}

fn read_material([youngs, poisson, density]: &[Option<Bound<'_, PyAny>>; 3]) -> PyResult<PartialMaterial> {
    Ok(PartialMaterial {
        youngs_modulus: number(youngs.as_ref(), "youngs")?,
        poisson_ratio: number(poisson.as_ref(), "poisson")?,
        density: number(density.as_ref(), "density")?,
    })
}

fn vertex_numbers(any: &Bound<'_, PyAny>) -> PyResult<Vec<u32>> {
    let array = integers(any, "fix")?;
    if array.ndim() != 1 {
        return Err(value(format!(
            "fix has shape {:?}: a list of vertex numbers was expected",
            array.shape()
        )));
    }
    let number = |(at, v): (usize, &i64)| {
        u32::try_from(*v).map_err(|_| value(format!("fix[{at}] is {v}: a vertex number was expected")))
    };
    array.as_slice()?.iter().enumerate().map(number).collect()
}

/// Returns the model of the mean and the principal components of shapes.
#[pyfunction]
pub fn _pca(
    py: Python<'_>,
    shapes: &Bound<'_, PyAny>,
    faces: Option<&Bound<'_, PyAny>>,
    rank: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let rank = count(rank, "rank", 1..=usize::MAX)?;
    let threads = pool::threads(threads)?;
    let (mesh, frames, name) = if let Ok(folder) = shapes.extract::<PathBuf>() {
        if faces.is_some() {
            return Err(value("faces: the meshes of a folder have their own: leave faces out"));
        }
        let of_worker = folder.clone();
        let frames = run_detachable(py, move || read_frames(&of_worker))?.map_err(|error| file(&error))?;
        let first = frames.paths.first().unwrap_or(&folder).to_string_lossy().escape_debug().to_string();
        warn(py, &frames.warnings.iter().map(|warning| format!("{first}: {warning}")).collect::<Vec<_>>())?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        (frames.mesh, frames.positions, format!("meshes in {name}"))
    } else {
        let Some(faces) = faces else {
            return Err(kind("faces is missing: (F, 3) vertex numbers of the shapes"));
        };
        let frames = read_shapes(shapes)?;
        let Some(first) = frames.first() else { return Err(value("shapes is empty")) };
        (mesh_of(first.clone(), "shapes", faces)?, frames, "shapes in memory".into())
    };
    let threads = pool::start(threads)?;
    let found = run(py, progress, "principal components", move |progress| {
        threads.install(|| pca_model(&mesh, &frames, rank, &name, progress))
    })?;
    let found = found.map_err(|error| value(format!("shapes: {error}")))?;
    Ok(Model::of(LoadedModel::new(found.model, found.info)))
}

/// Returns the shapes in an array (n, V, 3) or (n, 3V).
fn read_shapes(any: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<DVec3>>> {
    let array = floats(any, "shapes")?;
    let entries = match *array.shape() {
        // Shapes without vertices would need memory without any input.
        [_, vertices, 3] if vertices > 0 => vertices * 3,
        // (V, 3) is one shape, not V shapes of one vertex.
        [_, entries] if entries % 3 == 0 && entries > 3 => entries,
        _ => {
            return Err(value(format!(
                "shapes has shape {:?}: (n, V, 3) or (n, 3V) was expected",
                array.shape()
            )));
        }
    };
    let mut shapes = room(array.shape()[0], "shapes")?;
    for shape in array.as_slice()?.chunks_exact(entries) {
        let mut points = room(entries / 3, "shapes")?;
        points.extend(shape.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)));
        shapes.push(points);
    }
    Ok(shapes)
}
