//! A request to [`detect`](super::detect).

use std::path::PathBuf;

use sscc::{Clearance, Neighbours};
use sscc_io::gltf::SkinWeights;

use super::contacts::ContactOptions;
use crate::GroupRules;

/// Meshes, their motion, and which pairs of triangles count.
#[derive(Clone, Debug)]
pub struct Detection {
    /// Files of meshes; each is answered separately. Frames and another mesh need exactly one file. `FILE#NAME` names a mesh
    /// of a glTF file ([`sscc_io::split_mesh_name`]).
    pub meshes: Vec<PathBuf>,
    /// Name of the mesh in a glTF file with several meshes. It applies only to `meshes`, not to the other mesh.
    pub mesh_name: Option<String>,
    /// Motion of the meshes.
    pub motion: MeshMotion,
    /// Another mesh: pairs are then (triangle of the mesh, triangle of the other), and every pair counts that `groups`
    /// does not exclude.
    pub against: Option<OtherMesh>,
    /// Which triangles that share a vertex count.
    pub neighbours: Neighbours,
    /// Whether equal vertices are one vertex for adjacency: vertices of equal position at rest and in all frames; in
    /// animations and scenes vertices of equal rest position, morph displacements and influences. None means as the
    /// mesh requires it ([`sscc::ContactFilter::of`]), and true in animations and scenes.
    pub weld: Option<bool>,
    /// Pairs within this number of rings of pairs that collide at rest never count. None ignores no pair for that
    /// reason.
    pub ignore_rest: Option<u32>,
    /// Whether the meshes of different nodes of an animation are also compared with each other. The nodes of a scene of
    /// several meshes at rest are always compared. If pairs at rest are ignored, so are the pairs of different nodes that
    /// collide at the first time, and the pairs around them.
    pub between_nodes: bool,
    /// Rules for pairs of groups of triangles; with another mesh, or between nodes, they also apply between the meshes.
    pub groups: GroupRules,
    /// Whether to answer continuous queries, from each frame to the next, every vertex on a straight line.
    pub is_continuous: bool,
    /// Maximum number of pairs for each query; for continuous queries, of the earliest pairs. None means no limit, and more
    /// than [`sscc::Detector::MAX_PAIRS`] pairs are an error.
    pub limit: Option<usize>,
    /// Requests the pairs nearer than this, with their distances, instead of colliding pairs. Only for discrete queries
    /// without a limit.
    pub clearance: Option<Clearance>,
    /// Requests for two closed meshes the volume inside both and the largest ball inside both. Only for discrete queries.
    pub penetration: bool,
    /// Options of discrete queries for the contacts of their pairs.
    pub contacts: ContactOptions,
    /// Whether answers have the positions of each frame, as reports need them.
    pub has_positions: bool,
    /// Number of threads. None means all cores. Answers do not depend on it.
    pub threads: Option<usize>,
}

impl Default for Detection {
    /// Returns a request without meshes. All other values are the defaults: meshes at rest, without a limit.
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
    /// The mesh as it is in its file; a glTF mesh at the first node that shows it. With another mesh, there is an
    /// answer for every node of the mesh with every node of the other one. A glTF file with several meshes, none of
    /// which is named, is a scene: there is an answer for every node with a mesh, and for every two nodes that collide.
    Rest,
    /// Frames from a file or a folder of meshes ([`sscc_io::FrameReader`] lists the formats).
    Frames(PathBuf),
    /// An animation of the glTF file.
    Animation(AnimationMotion),
}

/// An animation of a glTF file, and the times of its queries.
#[derive(Clone, Debug)]
pub struct AnimationMotion {
    /// Name of the animation, or its number. None means the scene as it is stored, at each of the times.
    pub animation: Option<String>,
    /// Times of the queries.
    pub times: Times,
    /// Number or name of the node. None means every node that shows a mesh with triangles.
    pub node: Option<String>,
    /// Reading of weights that do not sum to 1.
    pub weights: SkinWeights,
}

impl AnimationMotion {
    /// Returns the scene as it is stored.
    pub(super) fn at_rest() -> Self {
        Self { animation: None, times: Times::List(vec![0.0]), node: None, weights: SkinWeights::default() }
    }
}

/// Times of an animation.
#[derive(Clone, Debug)]
pub enum Times {
    /// This number of times per second, from 0 to the last key frame, both included.
    PerSecond(f64),
    /// A list of times (s).
    List(Vec<f64>),
}

impl Default for Times {
    /// Returns 30 times per second.
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
    /// Frames of the mesh; if both meshes have several frames, as many as those of the first mesh. None means that it
    /// does not move.
    pub frames: Option<PathBuf>,
}
