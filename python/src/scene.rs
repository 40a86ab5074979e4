//! The parts of `sscc.Scene` in Rust: the contents of a glTF file, its collisions, and the positions of a node.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use numpy::{PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyList;
use sscc::{Clearance, Pair};
use sscc_io::gltf::{AnimatedScene, SkinWeights, read_scene};
use sscc_io::{FormatError, IoError};
use sscc_tasks::{
    AnimationMotion, Detection, DetectionAnswer, GroupRules, MeshMotion, TaskError, Times, detect,
};

use crate::arguments::{self, choice, count, neighbours_by_name, number, switch};
use crate::arrays::{frozen, line, pairs, vector};
use crate::certify::rest_rings;
use crate::errors::{file, refused_task, room, value, warn};
use crate::interrupt::{answer, run_borrowing, run_detachable, signals};
use crate::pool;
use crate::watching::{Phases, Watching};

/// Times per second, if neither a rate nor times are given.
const RATE: f64 = 30.0;

/// A node: its number and name, the name of its mesh, its vertices and triangles.
type Node = (usize, Option<String>, Option<String>, usize, usize);

/// Returns the nodes with meshes, and the animations with their last times.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn _scene_contents(
    py: Python<'_>,
    path: &Bound<'_, PyAny>,
) -> PyResult<(Vec<Node>, Vec<(Option<String>, f64)>)> {
    let path = arguments::path(path, "path")?;
    let scene = read(py, &path)?;
    let owned = |name: Option<&str>| name.map(str::to_owned);
    let nodes = scene.mesh_nodes().iter().map(|node| {
        let sizes = (node.rest_positions().len(), node.faces().len());
        (node.node(), owned(node.name()), owned(node.mesh_name()), sizes.0, sizes.1)
    });
    let animations = scene.animations().iter().map(|info| (info.name.clone(), info.last_time));
    Ok((nodes.collect(), animations.collect()))
}

/// Returns the positions of a node at times, (T, V, 3).
#[pyfunction]
pub fn _scene_positions<'py>(
    py: Python<'py>,
    path: &Bound<'py, PyAny>,
    node: &str,
    animation: Option<&str>,
    times: Option<&Bound<'py, PyAny>>,
    fps: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let path = arguments::path(path, "path")?;
    let times = times_of(animation, times, fps)?;
    let scene = read(py, &path)?;
    let in_file = |error: FormatError| file(&IoError::Format { path: path.clone(), error });
    let number = animation.map(|name| scene.find_animation(name)).transpose().map_err(in_file)?;
    let last = number.map_or(0.0, |number| scene.animations()[number].last_time);
    let times = times.of(last).map_err(value)?;
    let node = &scene.find_mesh_nodes(Some(node)).map_err(in_file)?[0];
    let vertices = node.rest_positions().len();
    let mut all: Vec<f64> = room(times.len().saturating_mul(3 * vertices), "positions")?;
    let found = answer(py, || -> Result<(), FormatError> {
        let mut positions = Vec::new();
        // After a cancellation, `answer` returns the exception of the signal handler.
        for time in times.iter().take_while(|_| !signals().is_cancelled()) {
            scene.pose(number, *time)?.positions(node.node(), SkinWeights::Normalized, &mut positions)?;
            all.extend(positions.iter().flat_map(|x| x.to_array()));
        }
        Ok(())
    })?;
    found.map_err(in_file)?;
    let array = numpy::PyArray1::from_vec(py, all).reshape([times.len(), vertices, 3])?;
    Ok(array.cast_into::<PyArray3<f64>>()?.into_any())
}

fn read(py: Python<'_>, path: &Path) -> PyResult<AnimatedScene> {
    let of_worker = path.to_owned();
    run_detachable(py, move || read_scene(&of_worker))?.map_err(|error| file(&error))
}

/// Returns the times of the arguments `times` and `fps`.
fn times_of(
    animation: Option<&str>,
    times: Option<&Bound<'_, PyAny>>,
    fps: Option<&Bound<'_, PyAny>>,
) -> PyResult<Times> {
    let rate = number(fps, "fps")?;
    match (animation, times, rate) {
        (None, None, None) => Ok(Times::List(vec![0.0])),
        (None, ..) => Err(value("times and fps are those of an animation: give an animation")),
        (_, Some(_), Some(_)) => Err(value("give times or fps, not both")),
        (_, Some(times), None) => Ok(Times::List(vector(times, "times")?)),
        (_, None, rate) => Ok(Times::PerSecond(rate.unwrap_or(RATE))),
    }
}

/// The stored parts of an answer.
struct Kept {
    nodes: [Option<usize>; 2],
    names: [Option<String>; 2],
    index: usize,
    time: Option<f64>,
    pairs: Vec<Pair>,
    times: Option<Vec<f64>>,
    distances: Option<Vec<f64>>,
    distance: Option<f64>,
    is_complete: bool,
}

impl Kept {
    fn of(found: &DetectionAnswer<'_>) -> Self {
        Self {
            nodes: [found.node, found.other_node],
            names: found.node_names.map(|name| name.map(str::to_owned)),
            index: found.index,
            time: found.time,
            pairs: found.pairs.to_vec(),
            times: found.times.map(<[f64]>::to_vec),
            distances: found.near.map(|(_, near)| near.distances.clone()),
            distance: found.near.and_then(|(_, near)| Some(near.nearest?.distance)),
            is_complete: found.is_complete,
        }
    }
}

/// Checks a scene; returns a list of `sscc.SceneAnswer`. `phases` is 2 if several nodes are compared with each other, else 1.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn _check_scene<'py>(
    py: Python<'py>,
    path: &Bound<'py, PyAny>,
    animation: Option<String>,
    times: Option<&Bound<'py, PyAny>>,
    fps: Option<&Bound<'py, PyAny>>,
    node: Option<String>,
    between_nodes: &Bound<'py, PyAny>,
    continuous: &Bound<'py, PyAny>,
    clearance: Option<&Bound<'py, PyAny>>,
    groups: (Vec<String>, Vec<String>, Option<PathBuf>),
    neighbours: Option<&Bound<'py, PyAny>>,
    ignore_rest: Option<&Bound<'py, PyAny>>,
    limit: Option<&Bound<'py, PyAny>>,
    threads: Option<&Bound<'py, PyAny>>,
    progress: Option<&Bound<'py, PyAny>>,
    phases: usize,
) -> PyResult<Bound<'py, PyList>> {
    let times = times_of(animation.as_deref(), times, fps)?;
    let clearance = number(clearance, "clearance")?.map(Clearance::new).transpose();
    let (ignored, only, by) = groups;
    let mut request = Detection {
        meshes: vec![arguments::path(path, "path")?],
        between_nodes: switch(Some(between_nodes), "between_nodes")?.unwrap_or(true),
        is_continuous: switch(Some(continuous), "continuous")?.unwrap_or(false),
        clearance: clearance.map_err(|error| crate::errors::refused(&error, ""))?,
        groups: GroupRules { ignored, only, by },
        neighbours: choice(neighbours, "neighbours", &neighbours_by_name())?.unwrap_or_default(),
        ignore_rest: rest_rings(ignore_rest)?,
        limit: count(limit, "limit", 1..=u32::MAX as usize)?,
        threads: pool::threads(threads)?,
        ..Detection::default()
    };
    if request.clearance.is_some() && (request.is_continuous || request.limit.is_some()) {
        return Err(value(
            "clearance works only at positions, without a limit: leave out continuous and limit",
        ));
    }
    request.motion =
        MeshMotion::Animation(AnimationMotion { animation, times, node, weights: SkinWeights::Normalized });
    let mut warnings = Vec::new();
    let found = run_borrowing(py, progress, "checking", |progress| {
        let progress = Phases::new(progress, phases);
        let watch = Watching::all(&progress);
        let mut kept = Vec::new();
        let found = detect(&request, &watch, |_, found| {
            kept.push(Kept::of(found?));
            Ok::<_, TaskError>(ControlFlow::Continue(()))
        });
        warnings = watch.notes();
        found.map(|()| kept)
    })?;
    warn(py, &warnings)?;
    let class = py.import("sscc._scene")?.getattr("SceneAnswer")?;
    let made = found.map_err(|error| refused_task(&error))?.into_iter().map(|kept| {
        let ([node, other], [name, other_name]) = (kept.nodes, kept.names);
        let numbers = |all: Option<Vec<f64>>| all.map(|all| frozen(line(py, all))).transpose();
        let found = frozen(pairs(py, &kept.pairs)?)?;
        let of_pairs = (numbers(kept.times)?, numbers(kept.distances)?, kept.distance);
        class.call1((
            node,
            name,
            other,
            other_name,
            kept.index,
            kept.time,
            found,
            of_pairs.0,
            of_pairs.1,
            of_pairs.2,
            kept.is_complete,
        ))
    });
    PyList::new(py, made.collect::<PyResult<Vec<_>>>()?)
}
