//! Answers all queries of a request.

use std::ops::ControlFlow;
use std::path::Path;

use glam::DVec3;
use sscc::TriMesh;

use super::answer::{DetectionAnswer, ShapeInMotion};
use super::in_order::in_order;
use super::moving_mesh::MovingMesh;
use super::request::{Detection, MeshMotion, OtherMesh};
use super::worker::{QueryResult, Worker};
use crate::error::Result;
use crate::watch::check_cancelled;
use crate::{SimError, Stage, Watch, available_threads};

/// Calls `take` with the answer to each query: mesh by mesh, node by node, frame by frame. `take` can end that early.
///
/// Frames from files are checked before the first answer. Memory is that of one mesh and a few frames for each thread;
/// meshes of a folder of frames are kept up to 1 GiB.
///
/// # Errors
/// When a file cannot be read or does not fit its mesh; when a request is contradictory; when positions are not finite;
/// when a query has more than [`sscc::Detector::MAX_PAIRS`] pairs and no limit; when `watch` cancels; when `take` fails.
pub fn detect<E: From<SimError>>(
    request: &Detection,
    watch: &dyn Watch,
    mut take: impl FnMut(&DetectionAnswer<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    check_request(request)?;
    let is_at_rest = matches!(request.motion, MeshMotion::Rest) && request.against.is_none();
    if is_at_rest && request.meshes.len() > 1 && !request.is_continuous {
        return at_rest(request, watch, take);
    }
    for (number, file) in request.meshes.iter().enumerate() {
        let (meshes, other) = load(file, request, watch)?;
        let frames = meshes.iter().chain(&other).map(MovingMesh::frames).max().unwrap_or(1);
        let each = if request.is_continuous { frames - 1 } else { frames };
        let queries = each * meshes.len();
        watch.begin(Stage::Detection);
        for (before, mesh) in meshes.iter().enumerate() {
            let is_last = number + 1 == request.meshes.len() && before + 1 == meshes.len();
            let last = is_last.then_some(each - 1);
            let taken = in_order(
                each,
                request.threads.unwrap_or_else(available_threads),
                || Worker::new(request, mesh, other.as_ref(), last),
                Worker::answer,
                |index, found| {
                    check_cancelled(watch)?;
                    let taken = take(&answer(
                        mesh.into(),
                        other.as_ref().map(AnswerSource::from),
                        index,
                        &found?,
                        [queries, frames],
                    ))?;
                    watch.report(before * each + index + 1, queries);
                    Ok::<_, E>(taken)
                },
            )?;
            if taken.is_break() {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// Answers several meshes at rest, each on one thread.
fn at_rest<E: From<SimError>>(
    request: &Detection,
    watch: &dyn Watch,
    mut take: impl FnMut(&DetectionAnswer<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    watch.begin(Stage::Detection);
    let count = request.meshes.len();
    let work = |(): &mut (), index: usize| {
        let mesh = MovingMesh::at_rest(&request.meshes[index], request, watch)?;
        let last = (index + 1 == count).then_some(0);
        let found = Worker::new(request, &mesh, None, last).answer(0)?;
        // Its detector is no longer needed: it is far larger than the mesh.
        Ok((mesh.mesh, found))
    };
    let taken = in_order(
        count,
        request.threads.unwrap_or_else(available_threads),
        || (),
        work,
        |index, result: Result<_>| {
            check_cancelled(watch)?;
            let (mesh, found) = result?;
            let mesh = AnswerSource { file: &request.meshes[index], mesh: &mesh, node: None, times: None };
            let taken = take(&answer(mesh, None, 0, &found, [1, 1]))?;
            watch.report(index + 1, count);
            Ok(taken)
        },
    );
    taken.map(drop)
}

/// The parts of a [`MovingMesh`] that answers show.
#[derive(Clone, Copy)]
struct AnswerSource<'a> {
    file: &'a Path,
    mesh: &'a TriMesh,
    node: Option<usize>,
    times: Option<&'a [f64]>,
}

impl<'a> From<&'a MovingMesh<'_>> for AnswerSource<'a> {
    fn from(mesh: &'a MovingMesh<'_>) -> Self {
        Self { file: &mesh.file, mesh: &mesh.mesh, node: mesh.node, times: mesh.times() }
    }
}

fn answer<'a>(
    mesh: AnswerSource<'a>,
    other: Option<AnswerSource<'a>>,
    index: usize,
    found: &'a QueryResult,
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
        index,
        time: mesh.times.map(|times| times[index]),
        pairs: &found.pairs,
        times: found.times.as_deref(),
        penetrations: found.contacts.penetrations.as_deref(),
        curves: found.contacts.curves.as_ref(),
        is_complete: found.is_complete,
        microseconds: found.microseconds,
        norm: None,
        root_certified: None,
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
    let needs_one = match (&request.motion, &request.against) {
        (_, Some(other)) => Some(other.mesh.as_path()),
        (MeshMotion::Frames(frames), None) => Some(frames.as_path()),
        _ => None,
    };
    if let (Some(path), [_, second, ..]) = (needs_one, &request.meshes[..]) {
        let cause = format!("belongs to one mesh: leave out {} and any others", second.display());
        return Err(SimError::refused(path.display(), cause));
    }
    if let (Some(other), MeshMotion::Animation(_)) = (&request.against, &request.motion) {
        let cause = "an animation cannot be compared with another mesh: write its positions as frames (.npy)";
        return Err(SimError::refused(other.mesh.display(), cause));
    }
    Ok(())
}

/// Whether the file is glTF, or is missing, which its reader reports.
fn can_be_animated(file: &Path) -> bool {
    let ending = file.extension().map(|e| e.to_ascii_lowercase());
    !file.exists() || ending.is_some_and(|ending| ending == "glb" || ending == "gltf")
}

/// Loads the meshes of a file, and the other mesh.
fn load<'w>(
    file: &Path,
    request: &Detection,
    watch: &'w dyn Watch,
) -> Result<(Vec<MovingMesh<'w>>, Option<MovingMesh<'w>>)> {
    let meshes = match &request.motion {
        MeshMotion::Rest => vec![MovingMesh::at_rest(file, request, watch)?],
        MeshMotion::Frames(frames) => vec![MovingMesh::with_frames(file, frames, request, watch)?],
        MeshMotion::Animation(animated) if can_be_animated(file) => {
            MovingMesh::animated(file, animated, request, watch)?
        }
        MeshMotion::Animation(_) => {
            let cause = "only .glb and .gltf files have animations: give --frames";
            return Err(SimError::refused(file.display(), cause));
        }
    };
    let other = match &request.against {
        None => None,
        Some(OtherMesh { mesh, frames: None }) => Some(MovingMesh::at_rest(mesh, request, watch)?),
        Some(OtherMesh { mesh, frames: Some(frames) }) => {
            Some(MovingMesh::with_frames(mesh, frames, request, watch)?)
        }
    };
    let counts = (meshes[0].frames(), other.as_ref().map_or(1, MovingMesh::frames));
    match counts {
        (1, 1) if request.is_continuous => {
            Err(SimError::refused(file.display(), "there is one frame; a motion needs at least two"))
        }
        (n, m) if n != m && n > 1 && m > 1 => {
            let cause =
                format!("there are {n} frames, but {m} of the other mesh: as many are needed, or one");
            Err(SimError::refused(file.display(), cause))
        }
        _ => Ok((meshes, other)),
    }
}
