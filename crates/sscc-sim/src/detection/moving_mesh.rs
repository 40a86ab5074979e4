//! A mesh with its detector, and its positions at each frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use sscc::{ContactFilter, Detector, TriMesh};
use sscc_io::gltf::{AnimatedScene, MeshNode, SkinWeights, read_scene};
use sscc_io::{FormatError, FrameReader, IoError, load_mesh, splits_vertices};

use super::request::{Animated, Detection};
use crate::error::{At, Result};
use crate::watch::{Stage, Watch, check_cancelled};

/// Weights whose sums differ from 1 by more than this are no rounding.
const MAX_WEIGHT_ERROR: f64 = 1e-3;

/// A mesh that moves.
pub(super) struct MovingMesh<'w> {
    pub file: PathBuf,
    pub node: Option<usize>,
    pub mesh: TriMesh,
    pub detector: Detector<'w>,
    motion: Motion,
}

enum Motion {
    Rest,
    Frames(FrameReader),
    Animation { scene: Arc<AnimatedScene>, animation: usize, weights: SkinWeights, times: Arc<[f64]> },
}

impl<'w> MovingMesh<'w> {
    /// Loads a mesh at rest.
    pub fn at_rest(file: &Path, request: &Detection, watch: &'w dyn Watch) -> Result<Self> {
        Self::with_motion(file, request, watch, |_| Ok(Motion::Rest))
    }

    /// Loads a mesh with frames, and checks all frames.
    pub fn with_frames(
        file: &Path,
        frames: &Path,
        request: &Detection,
        watch: &'w dyn Watch,
    ) -> Result<Self> {
        Self::with_motion(file, request, watch, |mesh| {
            let mut reader = FrameReader::open(frames, mesh, file)?;
            watch.begin(Stage::Reading);
            for frame in 0..reader.len() {
                check_cancelled(watch)?;
                reader.check(frame)?;
                watch.report(frame + 1, reader.len());
            }
            Ok(Motion::Frames(reader))
        })
    }

    fn with_motion(
        file: &Path,
        request: &Detection,
        watch: &'w dyn Watch,
        motion: impl FnOnce(&TriMesh) -> Result<Motion>,
    ) -> Result<Self> {
        let name = request.mesh_name.as_deref().filter(|_| request.meshes.iter().any(|mesh| mesh == file));
        let mesh = load_mesh(file, name)?;
        let motion = motion(&mesh)?;
        let weld = request.weld.unwrap_or_else(|| splits_vertices(file));
        let filter = ContactFilter::new(request.neighbours, weld);
        let make = |filter: &ContactFilter| Detector::with_filter(&mesh, filter);
        let detector = detector(&mesh, filter, request, watch, make).in_file(file)?;
        Ok(Self { file: file.to_owned(), node: None, mesh, detector, motion })
    }

    /// Loads the nodes of an animation.
    pub fn animated(
        file: &Path,
        animated: &Animated,
        request: &Detection,
        watch: &'w dyn Watch,
    ) -> Result<Vec<Self>> {
        let scene = Arc::new(read_scene(file)?);
        let animation = scene.find_animation(&animated.animation).map_err(|error| in_file(error, file))?;
        let times = animated.times.of(scene.animations()[animation].last_time);
        let times: Arc<[f64]> =
            times.map_err(|cause| crate::SimError::refused(file.display(), cause))?.into();
        let nodes = scene.find_mesh_nodes(animated.node).map_err(|error| in_file(error, file))?;
        let mesh = |node: &MeshNode| {
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
                true => Detector::with_weld_classes(&mesh, node.weld_classes(), filter),
                false => Detector::with_filter(&mesh, filter),
            };
            let filter = ContactFilter::new(request.neighbours, is_welded);
            let detector = detector(&mesh, filter, request, watch, make).in_file(file)?;
            let (scene, times) = (Arc::clone(&scene), Arc::clone(&times));
            let motion = Motion::Animation { scene, animation, weights, times };
            Ok(Self { file: file.to_owned(), node: Some(node.node()), mesh, detector, motion })
        };
        nodes.iter().map(mesh).collect()
    }

    /// Returns the number of frames, at least 1.
    pub fn frames(&self) -> usize {
        match &self.motion {
            Motion::Rest => 1,
            Motion::Frames(reader) => reader.len(),
            Motion::Animation { times, .. } => times.len(),
        }
    }

    /// Returns the times of all frames, in an animation.
    pub fn times(&self) -> Option<&[f64]> {
        match &self.motion {
            Motion::Animation { times, .. } => Some(times),
            _ => None,
        }
    }

    /// Returns the time of a frame, in an animation.
    pub fn time(&self, frame: usize) -> Option<f64> {
        self.times().map(|times| times[frame])
    }

    /// Replaces `positions` by those at a frame. A mesh with one frame has it at all times.
    pub fn positions(&self, frame: usize, positions: &mut Vec<DVec3>) -> Result<()> {
        let frame = frame.min(self.frames() - 1);
        match &self.motion {
            Motion::Rest => {
                positions.clear();
                positions.extend(self.mesh.rest_positions());
            }
            Motion::Frames(reader) => reader.read(frame, positions)?,
            Motion::Animation { scene, animation, weights, times } => scene
                .positions(self.node.unwrap_or_default(), Some(*animation), times[frame], *weights, positions)
                .map_err(|error| in_file(error, &self.file))?,
        }
        Ok(())
    }
}

/// Makes a detector under a filter, which ignores pairs that collide at rest if the request says so.
fn detector<'w>(
    mesh: &TriMesh,
    filter: ContactFilter,
    request: &Detection,
    watch: &'w dyn Watch,
    make: impl Fn(&ContactFilter) -> Result<Detector<'w>, sscc::Error>,
) -> Result<Detector<'w>, sscc::Error> {
    let mut detector = make(&filter)?.cancelled_by(watch);
    if request.ignore_rest {
        let pairs = detector.discrete(mesh.rest_positions())?.to_vec();
        detector = make(&filter.ignoring(pairs))?.cancelled_by(watch);
    }
    Ok(detector)
}

fn in_file(error: FormatError, file: &Path) -> IoError {
    IoError::Format { path: file.to_owned(), error }
}
