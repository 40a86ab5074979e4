//! `sscc.modes`: models of bodies and of samples, with modes that are made for them.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sscc::TriMesh;
use sscc_cli::make::{self, AskedMaterial, Body, Kind, Wanted};
use sscc_io::{IoError, ModelInfo, read_frames, splits_vertices};
use sscc_modes::{ModesError, pca_modes};

use crate::arguments::{choice, count, number};
use crate::arrays::{floats, integers};
use crate::errors::{file, kind, room, value};
use crate::interrupt::run;
use crate::model::{Loaded, Model, mesh, mesh_of, points};
use crate::pool::{self, on_threads};

/// A mesh or solid in a file, or a surface as `(vertices, faces)`.
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

    fn body(&self) -> Body<'_> {
        match self {
            Self::File(path) => Body::File(path),
            Self::Surface(mesh) => Body::Surface(mesh.clone()),
        }
    }

    /// A refusal, with the name of the file.
    fn refused(&self, error: &anyhow::Error) -> PyErr {
        match error.downcast_ref::<IoError>() {
            Some(error) => file(error),
            None => match self {
                Self::File(path) => value(format!("{}: {error:#}", path.to_string_lossy().escape_debug())),
                Self::Surface(_) => value(format!("source: {error:#}")),
            },
        }
    }
}

/// What the builders of elastic bodies have in common.
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
    let kinds = [("linear", Kind::Linear), ("nonlinear", Kind::Nonlinear), ("polynomial", Kind::Polynomial)];
    let kind = choice(Some(kind), "kind", &kinds)?.unwrap_or(Kind::Linear);
    let source = Source::of(source)?;
    let mut wanted = Wanted::default();
    wanted.rank = count(rank, "rank", 1..=500)?;
    wanted.material = read_material(&material)?;
    wanted.resolution = count(resolution, "resolution", 1..=2000)?.map(|cells| cells as u32);
    if let Some(fix) = fix {
        wanted.fixed = vertex_numbers(fix)?;
    }
    if let Some(corners) = fix_box {
        let corners = points(&floats(corners, "fix_box")?, "fix_box")?;
        let [a, b] = corners[..] else {
            return Err(value(format!("fix_box has {} rows: two corners were expected", corners.len())));
        };
        wanted.fixed_box = Some([a, b]);
    }
    let threads = pool::threads(threads)?;
    let source = Arc::new(source);
    let of_worker = Arc::clone(&source);
    let made = run(py, progress, "modes", move |progress| {
        on_threads(threads, || make::elastic(of_worker.body(), kind, wanted, progress))
    })?;
    made.map(loaded).map_err(|error| source.refused(&error))
}

/// Polynomial modes of a surface alone; a solid in a file gets its stiffness, too.
#[pyfunction]
pub fn _polynomial(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let source = Source::of(source)?;
    let threads = pool::threads(threads)?;
    let source = Arc::new(source);
    let of_worker = Arc::clone(&source);
    let made = run(py, progress, "modes", move |progress| {
        on_threads(threads, || match &*of_worker {
            Source::File(path) if make::is_volumetric(path) => {
                make::elastic(of_worker.body(), Kind::Polynomial, Wanted::default(), progress)
            }
            _ => make::polynomial(of_worker.body()),
        })
    })?;
    made.map(loaded).map_err(|error| source.refused(&error))
}

fn loaded(made: make::Model) -> Model {
    Model::of(Loaded::new(made.model, made.info, made.is_split))
}

fn read_material([youngs, poisson, density]: &[Option<Bound<'_, PyAny>>; 3]) -> PyResult<AskedMaterial> {
    Ok(AskedMaterial {
        youngs: number(youngs.as_ref(), "youngs")?,
        poisson: number(poisson.as_ref(), "poisson")?,
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

/// The mean and the principal components of shapes.
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
    let (mesh, frames, name, is_split) = if let Ok(folder) = shapes.extract::<PathBuf>() {
        if faces.is_some() {
            return Err(value("faces: the meshes of a folder have their own"));
        }
        let frames = py.detach(|| read_frames(&folder)).map_err(|error| file(&error))?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        (frames.mesh, frames.positions, format!("meshes in {name}"), splits_vertices(&frames.paths[0]))
    } else {
        let Some(faces) = faces else {
            return Err(kind("faces is missing: (F, 3) vertex numbers of the shapes"));
        };
        let frames = read_shapes(shapes)?;
        let Some(first) = frames.first() else { return Err(value("shapes is empty")) };
        (mesh_of(first.clone(), "shapes", faces)?, frames, "shapes in memory".into(), false)
    };
    let count = frames.len();
    let found = run(py, progress, "principal components", move |progress| {
        on_threads(threads, || pca_modes(&mesh, &frames, rank, progress))
    })?;
    let found = found.map_err(|error: ModesError| value(format!("shapes: {error}")))?;
    let model = sscc::ReducedModel::new(found.mesh, found.modes)
        .map_err(|error| value(format!("shapes: {error}")))?;
    let info = ModelInfo::new("", format!("mean and principal components of {count} {name}"));
    Ok(Model::of(Loaded::new(model, info, is_split)))
}

/// Shapes from an array (n, V, 3) or (n, 3V).
fn read_shapes(any: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<DVec3>>> {
    let array = floats(any, "shapes")?;
    let entries = match *array.shape() {
        [_, _, 3] => array.shape()[1] * 3,
        // One shape (V, 3) is none of one vertex each.
        [_, entries] if entries % 3 == 0 && entries != 3 => entries,
        _ => {
            return Err(value(format!(
                "shapes has shape {:?}: (n, V, 3) or (n, 3V) was expected",
                array.shape()
            )));
        }
    };
    let mut shapes = room(array.shape()[0], "shapes")?;
    for shape in array.as_slice()?.chunks_exact(entries.max(1)) {
        let mut points = room(entries / 3, "shapes")?;
        points.extend(shape.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)));
        shapes.push(points);
    }
    Ok(shapes)
}
