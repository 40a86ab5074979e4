//! Answers all queries of a request.

use std::ops::ControlFlow;
use std::path::Path;

use glam::DVec3;
use sscc::parts::check_continuous;
use sscc::{Clearance, TriMesh};

use super::answer::{DetectionAnswer, ShapeInMotion};
use super::in_order::in_order;
use super::mesh_source::MeshSource;
use super::moving_mesh::MovingMesh;
use super::node_pairs::NodePairs;
use super::request::{Detection, MeshMotion};
use super::sides::{Sides, is_scene};
use super::worker::{QueryResult, Worker};
use crate::error::Result;
use crate::watch::check_cancelled;
use crate::{LeftOut, Stage, TaskError, Watch, available_threads};

/// Calls `take` with each file and the answer to each query: mesh by mesh, node by node (each with all nodes of the other
/// mesh), frame by frame; then, frame by frame, for every two nodes of a scene that collide with each other. `take` can end
/// the run early. Several meshes at rest are read and answered in parallel.
///
/// If a file cannot be answered, `take` receives the error. It returns the error to end the run, or continues with the next file.
///
/// Frames from files are checked before the first answer. Memory holds the mesh (all meshes of an animation or a scene)
/// and the other mesh, and for each thread their detectors and a few frames; meshes of a folder of frames are kept up to
/// 1 GiB, and so are the transforms of a scene's nodes at all times. Of several meshes at rest it holds a few for each thread.
///
/// # Errors
/// When a request is contradictory; when `watch` cancels; when `take` fails. `take` receives the errors of a file: when
/// it cannot be read or does not fit its mesh or the request; when the nodes of a scene have more than 2^25 triangles (each
/// node counts as at least 64) or vertices together, or more than 2^20 pairs of them collide at one time; when a mesh would be compared with itself; when a position is not finite or is beyond
/// [`sscc::limits::LARGEST`]; when a query has more than [`sscc::Detector::MAX_PAIRS`] pairs and no limit.
pub fn detect<E: From<TaskError>>(
    request: &Detection,
    watch: &dyn Watch,
    mut take: impl FnMut(&Path, Result<&DetectionAnswer<'_>>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    check_request(request)?;
    let is_at_rest = matches!(request.motion, MeshMotion::Rest) && request.against.is_none();
    if is_at_rest && request.meshes.len() > 1 && !request.is_continuous {
        return at_rest(request, watch, take).map(drop);
    }
    for (number, file) in request.meshes.iter().enumerate() {
        let is_last = number + 1 == request.meshes.len();
        if by_itself(file, is_last, request, watch, &mut take)?.is_break() {
            return Ok(());
        }
    }
    Ok(())
}

/// Answers the queries of one file, in parallel. `take` receives the error of the file.
fn by_itself<E: From<TaskError>>(
    file: &Path,
    is_last: bool,
    request: &Detection,
    watch: &dyn Watch,
    take: &mut impl FnMut(&Path, Result<&DetectionAnswer<'_>>) -> Result<ControlFlow<()>, E>,
) -> Result<ControlFlow<()>, E> {
    match in_motion(file, is_last, request, watch, |found| take(file, Ok(found))) {
        Ok(taken) => Ok(taken),
        Err(Failure::File(error)) => {
            check_cancelled(watch)?;
            take(file, Err(error))
        }
        Err(Failure::Run(error)) => Err(error),
    }
}

/// An error that ends a file, or the whole run.
enum Failure<E> {
    File(TaskError),
    Run(E),
}

impl<E> From<TaskError> for Failure<E> {
    fn from(error: TaskError) -> Self {
        Self::File(error)
    }
}

/// Answers the queries of one file, in parallel. `is_last` states whether no other file follows.
fn in_motion<E>(
    file: &Path,
    is_last: bool,
    request: &Detection,
    watch: &dyn Watch,
    mut take: impl FnMut(&DetectionAnswer<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<ControlFlow<()>, Failure<E>> {
    let mut sides = Sides::load(file, request, watch)?;
    let frames = sides.frames;
    let each = if request.is_continuous { frames - 1 } else { frames };
    let queries = each * sides.len();
    watch.begin(Stage::Detection);
    for before in 0..sides.len() {
        let (mesh, other) = sides.get(before)?;
        let (mesh, other) = (&*mesh, other.as_deref());
        let last = (is_last && before + 1 == sides.len()).then_some(each - 1);
        let taken = in_order(
            each,
            request.threads.unwrap_or_else(available_threads),
            || Worker::new(request, mesh, other, last),
            Worker::answer,
            |index, found| {
                check_cancelled(watch)?;
                let other = other.map(AnswerSource::from);
                let found = (&found?, request.clearance);
                let answer = answer(mesh.into(), other, index, found, [queries, frames]);
                let taken = take(&answer).map_err(Failure::Run)?;
                watch.report(before * each + index + 1, queries);
                Ok::<_, Failure<E>>(taken)
            },
        )?;
        if taken.is_break() {
            return Ok(taken);
        }
    }
    let Some((meshes, ignored)) = sides.compared() else { return Ok(ControlFlow::Continue(())) };
    watch.begin(Stage::Detection);
    in_order(
        each,
        request.threads.unwrap_or_else(available_threads),
        || NodePairs::new(request, meshes, ignored),
        NodePairs::answer,
        |index, found| {
            check_cancelled(watch)?;
            for (nodes, found) in found? {
                let [mesh, other] = nodes.map(|node| AnswerSource::from(&*meshes[node]));
                let answer = answer(mesh, Some(other), index, (&found, request.clearance), [queries, frames]);
                if take(&answer).map_err(Failure::Run)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
            watch.report(index + 1, each);
            Ok::<_, Failure<E>>(ControlFlow::Continue(()))
        },
    )
}

/// Answers several files at rest, each on one thread. Scenes are answered one by one, at their place in the order.
fn at_rest<E: From<TaskError>>(
    request: &Detection,
    watch: &dyn Watch,
    mut take: impl FnMut(&Path, Result<&DetectionAnswer<'_>>) -> Result<ControlFlow<()>, E>,
) -> Result<ControlFlow<()>, E> {
    watch.begin(Stage::Detection);
    let count = request.meshes.len();
    let work = |(): &mut (), index: usize| {
        let file = &request.meshes[index];
        // `by_itself` refuses files whose nodes cannot be compared.
        if request.between_nodes || is_scene(file, request) {
            return Ok(None);
        }
        let source = MeshSource::read(file, request.mesh_name.as_deref(), watch)?;
        source.warn_of_other_places(watch);
        let mesh = MovingMesh::at_rest(&source, 0, request, watch)?;
        let last = (index + 1 == count).then_some(0);
        let found = Worker::new(request, &mesh, None, last).answer(0)?;
        // The detector is dropped: it is far larger than the mesh.
        Ok(Some((mesh.mesh, mesh.left_out, found)))
    };
    in_order(
        count,
        request.threads.unwrap_or_else(available_threads),
        || (),
        work,
        |index, result: Result<_>| {
            check_cancelled(watch)?;
            let file = &request.meshes[index];
            let taken = match result {
                Ok(Some((mesh, left_out, found))) => {
                    let mesh = AnswerSource {
                        file,
                        mesh: &mesh,
                        node: None,
                        name: None,
                        times: None,
                        left_out: &left_out,
                    };
                    take(file, Ok(&answer(mesh, None, 0, (&found, request.clearance), [1, 1])))
                }
                // The file is a scene, or is refused.
                Ok(None) => by_itself(file, index + 1 == count, request, watch, &mut take),
                Err(error) => take(file, Err(error)),
            }?;
            watch.report(index + 1, count);
            Ok(taken)
        },
    )
}

/// The parts of a [`MovingMesh`] that answers show.
#[derive(Clone, Copy)]
struct AnswerSource<'a> {
    file: &'a Path,
    mesh: &'a TriMesh,
    node: Option<usize>,
    name: Option<&'a str>,
    times: Option<&'a [f64]>,
    left_out: &'a LeftOut,
}

impl<'a> From<&'a MovingMesh<'_>> for AnswerSource<'a> {
    fn from(mesh: &'a MovingMesh<'_>) -> Self {
        let MovingMesh { file, mesh: faces, node, name, left_out, .. } = mesh;
        Self { file, mesh: faces, node: *node, name: name.as_deref(), times: mesh.times(), left_out }
    }
}

fn answer<'a>(
    mesh: AnswerSource<'a>,
    other: Option<AnswerSource<'a>>,
    index: usize,
    (found, clearance): (&'a QueryResult, Option<Clearance>),
    [queries, frames]: [usize; 2],
) -> DetectionAnswer<'a> {
    let shape = |AnswerSource { file, mesh, .. }: AnswerSource<'a>, [x_t0, x_t1]: &'a [Vec<DVec3>; 2]| {
        ShapeInMotion { file, mesh, x_t0, x_t1 }
    };
    let mut shapes = [mesh].into_iter().chain(other).zip(&found.positions);
    let mut next = || shapes.next().map(|(mesh, positions)| shape(mesh, positions));
    DetectionAnswer {
        file: mesh.file,
        mesh: mesh.mesh,
        node: mesh.node,
        other_node: other.and_then(|other| other.node),
        node_names: [mesh.name, other.and_then(|other| other.name)],
        index,
        time: mesh.times.map(|times| times[index]),
        pairs: &found.pairs,
        times: found.times.as_deref(),
        penetrations: found.contacts.penetrations.as_deref(),
        curves: found.contacts.curves.as_ref(),
        near: clearance.zip(found.near.as_ref()),
        enclosed: found.enclosed,
        body_penetration: found.penetration,
        is_complete: found.is_complete,
        microseconds: found.microseconds,
        norm: None,
        root_certified: None,
        proof: None,
        exceptions: 0,
        left_out: mesh.left_out,
        opened: found.statistics.opened,
        box_tests: found.statistics.box_tests,
        triangle_tests: found.statistics.triangle_tests,
        queries,
        frames,
        frame_times: mesh.times,
        shape: next(),
        other: next(),
    }
}

fn check_request(request: &Detection) -> Result<()> {
    if request.is_continuous {
        check_continuous(request.neighbours)?;
    }
    let needs_one = match (&request.motion, &request.against) {
        (_, Some(other)) => Some(other.mesh.as_path()),
        (MeshMotion::Frames(frames), None) => Some(frames.as_path()),
        _ => None,
    };
    if let (Some(path), [_, second, ..]) = (needs_one, &request.meshes[..]) {
        let cause = format!("belongs to one mesh: leave out {} and any others", second.display());
        return Err(TaskError::refused(path.display(), cause));
    }
    if let (Some(other), MeshMotion::Animation(_)) = (&request.against, &request.motion) {
        let cause = "an animation cannot be compared with another mesh: write its positions as frames (.npy)";
        return Err(TaskError::refused(other.mesh.display(), cause));
    }
    Ok(())
}
