//! The meshes of one file of a request, each paired with the other mesh.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use sscc_io::gltf::{count_meshes, is_gltf};
use sscc_io::{Setting, split_mesh_name};

use super::ignored_between::IgnoredBetween;
use super::mesh_source::MeshSource;
use super::moving_mesh::{MovingMesh, compares_nodes};
use super::request::{AnimationMotion, Detection, MeshMotion, OtherMesh};
use crate::TaskError;
use crate::error::Result;
use crate::watch::Watch;

/// Maximum number of pairs of places of two meshes, each of which needs a detector. More indicate a mistake or a hostile file.
const MAX_PLACES: usize = 10_000;

/// A mesh, and the other mesh if there is one.
pub(super) type MeshPair<'w> = (Arc<MovingMesh<'w>>, Option<Arc<MovingMesh<'w>>>);

/// The meshes of one file, each with each place of the other mesh. At most two meshes with their detectors are in memory,
/// except for those of an animation; each thread has copies of the detectors that it uses.
pub(super) struct Sides<'r, 'w> {
    request: &'r Detection,
    watch: &'w dyn Watch,
    mesh: Side<'w>,
    other: Option<Side<'w>>,
    /// Number of frames of the motion, at least 1.
    pub frames: usize,
    /// The pairs that do not count between nodes, for an animation or a scene whose nodes are also compared with each other.
    compared: Option<IgnoredBetween>,
    /// The mesh of the last pair, with its number.
    last: Option<(usize, Arc<MovingMesh<'w>>)>,
}

enum Side<'w> {
    /// A mesh at rest, at this number of places.
    Places(Box<MeshSource>, usize),
    /// Meshes that move.
    Moving(Vec<Arc<MovingMesh<'w>>>),
}

impl<'w> Side<'w> {
    fn len(&self) -> usize {
        match self {
            Self::Places(_, places) => *places,
            Self::Moving(meshes) => meshes.len(),
        }
    }

    fn frames(&self) -> usize {
        match self {
            Self::Places(..) => 1,
            Self::Moving(meshes) => meshes.first().map_or(1, |mesh| mesh.frames()),
        }
    }

    fn get(&self, number: usize, request: &Detection, watch: &'w dyn Watch) -> Result<Arc<MovingMesh<'w>>> {
        match self {
            Self::Places(source, _) => Ok(Arc::new(MovingMesh::at_rest(source, number, request, watch)?)),
            Self::Moving(meshes) => Ok(Arc::clone(&meshes[number])),
        }
    }
}

impl<'r, 'w> Sides<'r, 'w> {
    /// Loads the meshes of a file, and the other mesh.
    pub fn load(file: &Path, request: &'r Detection, watch: &'w dyn Watch) -> Result<Self> {
        let animated = |animated: &AnimationMotion| {
            let mut meshes = MovingMesh::animated(file, animated, request, watch)?;
            let ignored = match compares_nodes(request) {
                true => Some(IgnoredBetween::find(request, &mut meshes)?),
                false => None,
            };
            let mesh = Side::Moving(meshes.into_iter().map(Arc::new).collect());
            Ok(Self { compared: ignored, ..Self::new(file, mesh, None, request, watch)? })
        };
        match &request.motion {
            MeshMotion::Animation(motion) => {
                check_animated(file)?;
                animated(motion)
            }
            MeshMotion::Rest if is_scene(file, request) => animated(&AnimationMotion::at_rest()),
            MeshMotion::Rest | MeshMotion::Frames(_) if request.between_nodes => {
                let cause = "only the nodes of a .glb, .gltf or .vrm as a whole are compared with each other";
                Err(TaskError::refused(file.display(), cause))
            }
            MeshMotion::Rest | MeshMotion::Frames(_) => {
                let mut source = MeshSource::read(file, request.mesh_name.as_deref(), watch)?;
                let frames = match &request.motion {
                    MeshMotion::Frames(frames) => Some(frames.as_path()),
                    _ => None,
                };
                let other = request.against.as_ref();
                let mut other = other.map(|other| other_source(other, &source, frames, watch)).transpose()?;
                if let Some(other) = &mut other {
                    MeshSource::set_groups(&request.groups, [&mut source, other])?;
                }
                let mesh = side(source, frames, request, watch)?;
                let other = match (other, &request.against) {
                    (Some(source), Some(OtherMesh { frames, .. })) => {
                        Some(side(source, frames.as_deref(), request, watch)?)
                    }
                    _ => None,
                };
                Self::new(file, mesh, other, request, watch)
            }
        }
    }

    /// Returns the meshes that are compared with each other, if any, and the pairs between them that do not count.
    pub fn compared(&self) -> Option<(&[Arc<MovingMesh<'w>>], &IgnoredBetween)> {
        match (&self.mesh, &self.compared) {
            (Side::Moving(meshes), Some(ignored)) if meshes.len() > 1 => Some((meshes, ignored)),
            _ => None,
        }
    }

    fn new(
        file: &Path,
        mesh: Side<'w>,
        other: Option<Side<'w>>,
        request: &'r Detection,
        watch: &'w dyn Watch,
    ) -> Result<Self> {
        let (n, m) = (mesh.frames(), other.as_ref().map_or(1, Side::frames));
        if n.max(m) == 1 && request.is_continuous {
            return Err(TaskError::refused(
                file.display(),
                "there is one frame; a motion needs at least two",
            ));
        }
        if n != m && n > 1 && m > 1 {
            let cause =
                format!("there are {n} frames, but {m} of the other mesh: as many are needed, or one");
            return Err(TaskError::refused(file.display(), cause));
        }
        let sides = Self { request, watch, mesh, other, frames: n.max(m), compared: None, last: None };
        if request.against.is_some() && sides.len() > MAX_PLACES {
            let cause = format!(
                "{} nodes show the mesh, and {} the other one: name one of them, as in FILE#NODE",
                sides.mesh.len(),
                sides.others()
            );
            return Err(TaskError::refused(file.display(), cause));
        }
        if request.against.is_some() && request.has_positions && sides.len() > 1 {
            let cause = "several nodes show the meshes, and a report shows one of each: name the nodes, as in FILE#NODE";
            return Err(TaskError::refused(file.display(), cause));
        }
        Ok(sides)
    }

    /// Returns the number of pairs of meshes; without another mesh, the number of meshes.
    pub fn len(&self) -> usize {
        self.mesh.len().saturating_mul(self.others())
    }

    fn others(&self) -> usize {
        self.other.as_ref().map_or(1, Side::len)
    }

    /// Returns a pair by its number. The order is mesh by mesh, each with all places of the other mesh.
    pub fn get(&mut self, number: usize) -> Result<MeshPair<'w>> {
        let (of_mesh, of_other) = (number / self.others(), number % self.others());
        let mesh = match self.last.take().filter(|(last, _)| *last == of_mesh) {
            Some((_, mesh)) => mesh,
            None => self.mesh.get(of_mesh, self.request, self.watch)?,
        };
        self.last = Some((of_mesh, Arc::clone(&mesh)));
        let other = self.other.as_ref().map(|other| other.get(of_other, self.request, self.watch));
        Ok((mesh, other.transpose()?))
    }
}

/// Reads the other mesh, which must differ from `mesh` or have other frames.
fn other_source(
    other: &OtherMesh,
    mesh: &MeshSource,
    frames: Option<&Path>,
    watch: &dyn Watch,
) -> Result<MeshSource> {
    let source = MeshSource::read(&other.mesh, other.mesh_name.as_deref(), watch)?;
    let real = |frames: &Path| fs::canonicalize(frames).ok();
    if frames.map(real) == other.frames.as_deref().map(real) {
        mesh.check_differs(&source, frames.is_some())?;
    }
    Ok(source)
}

fn side<'w>(
    source: MeshSource,
    frames: Option<&Path>,
    request: &Detection,
    watch: &'w dyn Watch,
) -> Result<Side<'w>> {
    let is_everywhere = frames.is_none() && request.against.is_some();
    // Each pair of places creates its meshes again, so the warnings are sent here, at most for the allowed places.
    source.warn_of_flattened_places(if is_everywhere { source.places().min(MAX_PLACES) } else { 1 }, watch);
    Ok(match frames {
        Some(frames) => {
            Side::Moving(vec![Arc::new(MovingMesh::with_frames(&source, frames, request, watch)?)])
        }
        None if is_everywhere => {
            let places = source.places();
            Side::Places(Box::new(source), places)
        }
        None => {
            // An affine map does not change which triangles of a mesh intersect, so its first place represents all places.
            source.warn_of_other_places(watch);
            Side::Places(Box::new(source), 1)
        }
    })
}

/// Whether a file is checked as a scene: it is glTF, has several meshes (or its nodes are compared), and the request names no
/// mesh of it and no other mesh.
pub(super) fn is_scene(file: &Path, request: &Detection) -> bool {
    let is_whole =
        request.against.is_none() && request.mesh_name.is_none() && split_mesh_name(file).1.is_none();
    // The reader refuses malformed files.
    is_whole && is_gltf(file) && (request.between_nodes || count_meshes(file).is_ok_and(|count| count > 1))
}

/// Refuses a file of a format without animations, and a mesh of a glTF file (`FILE#NAME`). The reader reports a missing
/// file.
fn check_animated(file: &Path) -> Result<()> {
    if is_gltf(file) || !file.exists() && split_mesh_name(file).1.is_none() {
        return Ok(());
    }
    let cause = match split_mesh_name(file) {
        (_, Some(_)) => {
            "an animation moves every node: leave out the name after #; " + Setting::Node + " selects a node"
        }
        _ => "only .glb, .gltf and .vrm files have animations: give " + Setting::Frames,
    };
    Err(TaskError::refused(file.display(), cause))
}
