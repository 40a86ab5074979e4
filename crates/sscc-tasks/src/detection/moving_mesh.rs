//! A mesh with its detector, and its positions at each frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use sscc::parts::detector_with_weld_classes;
use sscc::{ContactFilter, Detector, TriMesh, TriangleGroups};
use sscc_io::gltf::{MeshNode, SceneState, SkinWeights, read_scene};
use sscc_io::{FormatError, FrameReader, IoError};

use super::mesh_source::{MAX_WEIGHT_ERROR, MeshSource};
use super::request::{AnimationMotion, Detection, MeshMotion};
use super::scene_poses::ScenePoses;
use super::scene_size::check_scene_size;
use super::weld_classes::WeldClasses;
use crate::LeftOut;
use crate::error::{At, Result};
use crate::watch::{Stage, Watch, check_cancelled};

/// A mesh that moves.
pub(super) struct MovingMesh<'w> {
    pub file: PathBuf,
    pub node: Option<usize>,
    /// The name of the node, in an animation or a scene.
    pub name: Option<String>,
    pub mesh: TriMesh,
    pub detector: Detector,
    /// The pairs that its queries do not test.
    pub left_out: LeftOut,
    motion: Motion,
    watch: &'w dyn Watch,
}

enum Motion {
    Rest,
    Frames(FrameReader),
    Animation(Evaluation),
}

/// A node of a scene at given times.
struct Evaluation {
    /// The poses of the scene, which all nodes share.
    poses: Arc<ScenePoses>,
    node: usize,
    weights: SkinWeights,
    /// Whether the warning that the node is flattened was sent.
    is_warned: AtomicBool,
}

impl<'w> MovingMesh<'w> {
    /// Returns a mesh at rest, at one of its places.
    pub fn at_rest(
        source: &MeshSource,
        place: usize,
        request: &Detection,
        watch: &'w dyn Watch,
    ) -> Result<Self> {
        let classes = || source.weld_classes(place);
        Self::with_motion(source, place, request, (watch, classes), |_, _| Ok(Motion::Rest))
    }

    /// Returns a mesh with frames, and checks all frames. Transforms of nodes are not applied to the positions of
    /// frames.
    pub fn with_frames(
        source: &MeshSource,
        frames: &Path,
        request: &Detection,
        watch: &'w dyn Watch,
    ) -> Result<Self> {
        let classes = || WeldClasses::at(source.own_positions());
        Self::with_motion(source, 0, request, (watch, classes), |mesh, mut classes| {
            let mut reader = FrameReader::open(frames, mesh, &source.file)?;
            // If the mesh is in the same collection, its reader has sent the warnings.
            let lines = if frames == source.file { &[] } else { reader.warnings() };
            lines.iter().for_each(|line| watch.warn(&format!("{}: {line}", frames.display())));
            watch.begin(Stage::Reading);
            let mut positions = Vec::new();
            for frame in 0..reader.len() {
                check_cancelled(watch)?;
                reader.check(frame, &mut positions)?;
                if let Some(classes) = &mut classes {
                    classes.split(&positions);
                }
                watch.report(frame + 1, reader.len());
            }
            Ok(Motion::Frames(reader))
        })
    }

    fn with_motion(
        source: &MeshSource,
        place: usize,
        request: &Detection,
        (watch, classes): (&'w dyn Watch, impl FnOnce() -> WeldClasses),
        motion: impl FnOnce(&TriMesh, Option<&mut WeldClasses>) -> Result<Motion>,
    ) -> Result<Self> {
        let file = source.file.as_path();
        let mesh = source.mesh(place)?;
        let weld = request.weld.unwrap_or(ContactFilter::of(&mesh).weld);
        let mut classes = weld.then(classes);
        let motion = motion(&mesh, classes.as_mut())?;
        let groups = match request.against {
            Some(_) => source.groups.clone(),
            None => request.groups.of_mesh(file, source.name.as_deref(), mesh.faces().len())?,
        };
        let filter = filter(request, weld, groups);
        let make = |filter: &ContactFilter| match &classes {
            Some(classes) => detector_with_weld_classes(&mesh, classes.numbers(), filter),
            None => Detector::with_filter(&mesh, filter),
        };
        let (detector, left_out) = detector(&mesh, filter, request, watch, make).in_file(file)?;
        let left_out = match request.against {
            Some(_) => left_out.between_meshes(),
            None => {
                // Frames are independent of nodes.
                let is_shown_again = matches!(motion, Motion::Rest) && source.places() > 1;
                let left_out = if is_shown_again { left_out.and_between_nodes() } else { left_out };
                if request.meshes.len() > 1 { left_out.and_between_files() } else { left_out }
            }
        };
        // Frames are independent of nodes.
        let is_placed = request.against.is_some() && matches!(motion, Motion::Rest);
        let node = source.node(place).filter(|_| is_placed);
        Ok(Self { file: file.to_owned(), node, name: None, mesh, detector, left_out, motion, watch })
    }

    /// Loads the nodes of an animation, or of a scene at rest.
    ///
    /// # Errors
    /// When the file cannot be read, or does not fit the request; when its nodes are too many, or have too many triangles or
    /// vertices; when `watch` cancels.
    pub fn animated(
        file: &Path,
        animated: &AnimationMotion,
        request: &Detection,
        watch: &'w dyn Watch,
    ) -> Result<Vec<Self>> {
        let scene = Arc::new(read_scene(file)?);
        scene.notes().iter().for_each(|note| watch.warn(&format!("{}: {note}", file.display())));
        let animation = animated.animation.as_deref().map(|name| scene.find_animation(name)).transpose();
        let animation = animation.map_err(|error| in_file(error, file))?;
        let info = animation.map(|number| (number, &scene.animations()[number]));
        if let Some((number, info)) = info
            && info.channels > 0
            && info.extension_channels > 0
        {
            watch.warn(&format!(
                "{}: animations[{number}]: {} of its channels are those of extensions, which are not evaluated",
                file.display(),
                info.extension_channels
            ));
        }
        let times = animated.times.of(info.map_or(0.0, |(_, info)| info.last_time));
        let times = times.map_err(|cause| crate::TaskError::refused(file.display(), cause))?;
        let nodes = scene.find_mesh_nodes(animated.node.as_deref()).map_err(|error| in_file(error, file))?;
        check_scene_size(file, nodes, request)?;
        let poses = Arc::new(ScenePoses::new(Arc::clone(&scene), animation, times, nodes.len()));
        let groups = request.groups.of_nodes(file, nodes, compares_nodes(request))?;
        let mesh = |(node, groups): (&MeshNode, Option<TriangleGroups>)| {
            check_cancelled(watch)?;
            let weights = animated.weights;
            if weights == SkinWeights::Normalized && node.largest_weight_error() > MAX_WEIGHT_ERROR {
                let place = format!("{}: node {}", file.display(), node.node());
                let error = node.largest_weight_error();
                watch.warn(&format!(
                    "{place}: the sums of skin weights differ from 1 by up to {error:.3}; they were normalized"
                ));
            }
            let mesh = TriMesh::new(node.rest_positions().to_vec(), node.faces().to_vec()).in_file(file)?;
            let is_welded = request.weld.unwrap_or(true);
            let make = |filter: &ContactFilter| match is_welded {
                true => detector_with_weld_classes(&mesh, node.weld_classes(), filter),
                false => Detector::with_filter(&mesh, filter),
            };
            let filter = filter(request, is_welded, groups);
            let (detector, mut left_out) = detector(&mesh, filter, request, watch, make).in_file(file)?;
            if nodes.len() > 1 && !compares_nodes(request) {
                left_out = left_out.and_between_nodes();
            }
            if request.meshes.len() > 1 {
                left_out = left_out.and_between_files();
            }
            let motion = Motion::Animation(Evaluation {
                poses: Arc::clone(&poses),
                node: node.node(),
                weights,
                is_warned: AtomicBool::new(false),
            });
            let (node, name) = (Some(node.node()), node.name().map(str::to_owned));
            Ok(Self { file: file.to_owned(), node, name, mesh, detector, left_out, motion, watch })
        };
        nodes.iter().zip(groups).map(mesh).collect()
    }

    /// Returns an error if the caller cancels.
    pub fn check_cancelled(&self) -> Result<()> {
        check_cancelled(self.watch)
    }

    /// Returns the number of frames, at least 1.
    pub fn frames(&self) -> usize {
        match &self.motion {
            Motion::Rest => 1,
            Motion::Frames(reader) => reader.len(),
            Motion::Animation(evaluation) => evaluation.poses.times().len(),
        }
    }

    /// Returns the times of all frames, in an animation or a collection.
    pub fn times(&self) -> Option<&[f64]> {
        match &self.motion {
            Motion::Frames(reader) => reader.times(),
            Motion::Animation(evaluation) if evaluation.poses.is_animated() => Some(evaluation.poses.times()),
            _ => None,
        }
    }

    /// Returns the time of a frame.
    pub fn time(&self, frame: usize) -> Option<f64> {
        self.times().map(|times| times[frame])
    }

    /// Returns the name of a frame in messages.
    pub fn place(&self, frame: usize) -> String {
        let file = self.file.display();
        match (self.node, self.time(frame)) {
            (Some(node), Some(time)) => format!("{file}: node {node} at {time} s"),
            (Some(node), None) => format!("{file}: node {node}"),
            (None, Some(time)) => format!("{file}: frame {frame} at {time} s"),
            _ if self.frames() > 1 => format!("{file}: frame {frame}"),
            _ => file.to_string(),
        }
    }

    /// Returns the state of the scene at a frame, for [`MovingMesh::positions`] of all meshes of the file; None if the mesh does
    /// not move with a scene.
    pub fn scene_state(&self, frame: usize) -> Result<Option<Arc<SceneState>>> {
        let Motion::Animation(evaluation) = &self.motion else { return Ok(None) };
        let state = evaluation.poses.state(frame.min(self.frames() - 1));
        Ok(Some(state.map_err(|error| in_file(error, &self.file))?))
    }

    /// Replaces `positions` by the positions at a frame. Beyond the last frame, these are the positions at the last
    /// one. `state` is the state of the scene at the frame, if it is known.
    pub fn positions(
        &self,
        frame: usize,
        state: Option<&Arc<SceneState>>,
        positions: &mut Vec<DVec3>,
    ) -> Result<()> {
        let frame = frame.min(self.frames() - 1);
        match &self.motion {
            Motion::Rest => {
                positions.clear();
                positions.extend(self.mesh.rest_positions());
            }
            Motion::Frames(reader) => reader.read(frame, positions)?,
            Motion::Animation(evaluation) => {
                let is_flat = evaluation.positions(frame, state, positions);
                let is_flat = is_flat.map_err(|error| in_file(error, &self.file))?;
                // The first such frame depends on the threads, so the warning names no frame.
                if is_flat && !evaluation.is_warned.swap(true, Ordering::Relaxed) {
                    self.watch.warn(&format!(
                        "{}: node {}: a scale of 0 flattens the mesh at some time, so that its triangles touch",
                        self.file.display(),
                        evaluation.node
                    ));
                }
            }
        }
        Ok(())
    }
}

impl Evaluation {
    /// Replaces `positions` by the positions at a frame. Returns whether a scale of 0 flattens triangles. `state` is the state of
    /// the scene at the frame, if it is known.
    fn positions(
        &self,
        frame: usize,
        state: Option<&Arc<SceneState>>,
        positions: &mut Vec<DVec3>,
    ) -> Result<bool, FormatError> {
        let pose = match state {
            Some(state) => self.poses.pose_of(Arc::clone(state)),
            None => self.poses.pose_of_node(self.node, frame)?,
        };
        pose.positions(self.node, self.weights, positions)?;
        Ok(pose.is_flattened(self.node))
    }
}

/// Whether the meshes of different nodes are compared with each other.
pub(super) fn compares_nodes(request: &Detection) -> bool {
    let is_scene = matches!(request.motion, MeshMotion::Rest);
    request.between_nodes || is_scene
}

fn filter(request: &Detection, weld: bool, groups: Option<TriangleGroups>) -> ContactFilter {
    let filter = ContactFilter::new(request.neighbours).weld(weld);
    match groups {
        Some(groups) => filter.with_groups(groups),
        None => filter,
    }
}

/// Creates a detector with a filter, which ignores pairs that collide at rest if the request requires it. Also returns the
/// pairs that the filter excludes.
fn detector(
    mesh: &TriMesh,
    filter: ContactFilter,
    request: &Detection,
    watch: &dyn Watch,
    make: impl Fn(&ContactFilter) -> Result<Detector, sscc::Error>,
) -> Result<(Detector, LeftOut), sscc::Error> {
    let (mut detector, mut filter) = (make(&filter)?.cancelled_by(watch.cancel_token().cloned()), filter);
    if let Some(rings) = request.ignore_rest {
        let at_rest = detector.discrete(mesh.rest_positions())?.to_vec();
        filter = filter.ignoring(detector.surroundings(&at_rest, rings)?);
        detector = make(&filter)?.cancelled_by(watch.cancel_token().cloned());
    }
    Ok((detector, LeftOut::of(&filter)))
}

fn in_file(error: FormatError, file: &Path) -> IoError {
    IoError::Format { path: file.to_owned(), error }
}
