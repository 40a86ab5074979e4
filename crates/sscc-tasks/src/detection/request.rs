//! A request to [`detect`](super::detect).

use std::path::PathBuf;

use sscc::{Clearance, Neighbours};
use sscc_io::gltf::SkinWeights;

use super::contacts::ContactOptions;
use crate::GroupRules;

/// Meshes, their motion, and which pairs of triangles count.
#[derive(Clone, Debug)]
pub struct Detection {
    /// Files of meshes; each is answered by itself. Frames and another mesh need exactly one. `FILE#NAME` names a mesh of
    /// a glTF file ([`sscc_io::split_mesh_name`]).
    pub meshes: Vec<PathBuf>,
    /// Name of the mesh in a glTF file with several meshes; of `meshes` alone, not of the other mesh.
    pub mesh_name: Option<String>,
    /// Motion of the meshes.
    pub motion: MeshMotion,
    /// Another mesh: pairs are then (triangle of the mesh, triangle of the other), and every pair counts.
    pub against: Option<OtherMesh>,
    /// Which triangles that share a vertex count.
    pub neighbours: Neighbours,
    /// Whether equal vertices are one vertex for adjacency: those of equal position at rest and in all frames; in animations
    /// those of equal rest position, morph displacements and influences. None: as the
    /// mesh has it ([`sscc::ContactFilter::of`]); in animations they are.
    pub weld: Option<bool>,
    /// Whether pairs that collide at rest never count.
    pub ignore_rest: Option<u32>,
    /// Whether the meshes of different nodes of an animation are also compared with each other; those of a scene of several
    /// meshes at rest are in any case. Where pairs at rest are ignored, so are the pairs of different nodes that collide at the first
    /// time, and those around them.
    pub between_nodes: bool,
    /// Which pairs of groups of triangles count; with another mesh, or between nodes, also those between the meshes.
    pub groups: GroupRules,
    /// Whether to answer continuous queries, from each frame to the next, every vertex on a straight line.
    pub is_continuous: bool,
    /// Maximum number of pairs for each query; of continuous queries the earliest. None: more than
    /// [`sscc::Detector::MAX_PAIRS`] are an error.
    pub limit: Option<usize>,
    /// Asks for the pairs nearer than this, with their distances, in place of those that collide. For discrete queries without a limit.
    pub clearance: Option<Clearance>,
    /// Asks of two meshes, both closed, for the volume that they share and the largest ball inside of both. For discrete queries.
    pub penetration: bool,
    /// What discrete queries compute of the contacts of their pairs.
    pub contacts: ContactOptions,
    /// Whether answers have the positions of each frame, as reports need them.
    pub has_positions: bool,
    /// Number of threads; none: all cores. Answers do not depend on it.
    pub threads: Option<usize>,
}

impl Default for Detection {
    /// No mesh; everything else as for a mesh at rest, with all pairs.
    fn default() -> Self {
        Self {
            meshes: Vec::new(),
            mesh_name: None,
            motion: MeshMotion::Rest,
            against: None,
            neighbours: Neighbours::default(),
            weld: None,
            ignore_rest: None,
            between_nodes: false,
            groups: GroupRules::default(),
            is_continuous: false,
            limit: None,
            clearance: None,
            penetration: false,
            contacts: ContactOptions::default(),
            has_positions: false,
            threads: None,
        }
    }
}

/// Motion of a mesh.
#[derive(Clone, Debug)]
pub enum MeshMotion {
    /// The mesh as it is in its file: of glTF at the first node that shows it. With another mesh, every node of both meshes
    /// has an answer. Of a glTF file with several meshes, none of which is named, the scene: every node with a mesh, and every two
    /// nodes.
    Rest,
    /// Frames from a `.npy` file or a folder ([`sscc_io::FrameReader`]).
    Frames(PathBuf),
    /// An animation of the glTF file.
    Animation(AnimationMotion),
}

/// An animation of a glTF file, and when it is answered.
#[derive(Clone, Debug)]
pub struct AnimationMotion {
    /// Name of the animation, or its number; none: the scene as it is stored, at one time.
    pub animation: Option<String>,
    /// Times of the queries.
    pub times: Times,
    /// Number or name of the node; none: every node that shows a mesh with triangles.
    pub node: Option<String>,
    /// Reading of weights that do not sum to 1.
    pub weights: SkinWeights,
}

impl AnimationMotion {
    /// The scene as it is stored.
    pub(super) fn at_rest() -> Self {
        Self { animation: None, times: Times::List(vec![0.0]), node: None, weights: SkinWeights::default() }
    }
}

/// Times of an animation.
#[derive(Clone, Debug)]
pub enum Times {
    /// So many a second, from 0 to the last key frame, both included.
    PerSecond(f64),
    /// These (s).
    List(Vec<f64>),
}

impl Default for Times {
    /// 30 times a second.
    fn default() -> Self {
        Self::PerSecond(30.0)
    }
}

/// A mesh to collide with.
#[derive(Clone, Debug)]
pub struct OtherMesh {
    /// File of the mesh; `FILE#NAME` names a mesh of a glTF file.
    pub mesh: PathBuf,
    /// Name of the mesh in a glTF file with several meshes.
    pub mesh_name: Option<String>,
    /// Its frames, as many as those of the mesh; none: it does not move.
    pub frames: Option<PathBuf>,
}
