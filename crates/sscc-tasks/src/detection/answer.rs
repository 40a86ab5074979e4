//! The answer to one query.

use std::path::Path;

use glam::DVec3;
use sscc::parts::{ContactCurves, Penetration};
use sscc::{Clearance, Enclosed, Impact, Pair, Proof, TriMesh};

use super::near::Near;
use crate::LeftOut;

/// The answer to one query of a [`Detection`](super::Detection), or at one q of a model.
#[derive(Clone, Copy, Debug)]
pub struct DetectionAnswer<'a> {
    /// File of the mesh; empty for a model.
    pub file: &'a Path,
    /// The mesh, at rest.
    pub mesh: &'a TriMesh,
    /// Number of the node, in an animation or a scene, or if several nodes show the mesh and there is another mesh.
    pub node: Option<usize>,
    /// Number of the node of the other mesh, if two nodes are compared, or if several nodes show the other mesh.
    pub other_node: Option<usize>,
    /// Names of these nodes, in an animation or a scene.
    pub node_names: [Option<&'a str>; 2],
    /// Number of the q, frame or time, counted from 0; for continuous queries, of the one at the start.
    pub index: usize,
    /// Time of the frame, in an animation (s) or a `.pvd` collection.
    pub time: Option<f64>,
    /// Colliding pairs, sorted.
    pub pairs: &'a [Pair],
    /// Time of impact (0 to 1) of each pair, for continuous queries.
    pub times: Option<&'a [f64]>,
    /// Depth and direction of the smallest translation of the second triangle that separates each pair, on request.
    pub penetrations: Option<&'a [Penetration]>,
    /// Contact curves of the last answer, on request. Answers about two nodes of a scene have none, so that the last answer
    /// before them has the curves.
    pub curves: Option<&'a ContactCurves>,
    /// The clearance, and the distances that were found; `pairs` are then the pairs nearer than the clearance.
    pub near: Option<(Clearance, &'a Near)>,
    /// Number of connected components of the mesh that are inside the other mesh, and of the other mesh inside this one, if
    /// discrete queries find no colliding pair.
    pub enclosed: Option<[Enclosed; 2]>,
    /// For two closed meshes the volume inside both and the largest ball inside both, on request.
    pub body_penetration: Option<sscc::parts::BodyPenetration>,
    /// Whether `pairs` contains all pairs.
    pub is_complete: bool,
    /// Duration of the query on its thread, without reading files and evaluating animations. If several q of a model are
    /// answered together, it is the time of all of them divided by their number.
    pub microseconds: f64,
    /// |z|, for a model; for continuous queries the larger one of start and end.
    pub norm: Option<f64>,
    /// Whether the root's certificate held, for a model.
    pub root_certified: Option<bool>,
    /// The kind of proof, for a model.
    pub proof: Option<Proof>,
    /// Number of pairs that no certificate covers, so that each query tests them, for a model.
    pub exceptions: usize,
    /// The pairs that are not tested.
    pub left_out: &'a LeftOut,
    /// Nodes and node pairs that the query opened.
    pub opened: u64,
    /// Pairs of AABBs that the query compared.
    pub box_tests: u64,
    /// Pairs of triangles that the query tested exactly.
    pub triangle_tests: u64,
    /// Number of queries of the whole file, without those of different nodes against each other.
    pub queries: usize,
    /// Number of frames of the motion; 1 at rest, and for a model the number of rows.
    pub frames: usize,
    /// Times of all frames, in an animation (s) or a `.pvd` collection.
    pub frame_times: Option<&'a [f64]>,
    /// The mesh at the frame; None without [`has_positions`](super::Detection::has_positions).
    pub shape: Option<ShapeInMotion<'a>>,
    /// The other mesh at the frame; None without `has_positions` or without another mesh.
    pub other: Option<ShapeInMotion<'a>>,
}

/// A mesh at a frame.
#[derive(Clone, Copy, Debug)]
pub struct ShapeInMotion<'a> {
    /// File of the mesh.
    pub file: &'a Path,
    /// The mesh, at rest.
    pub mesh: &'a TriMesh,
    /// Positions of its vertices at the frame.
    pub x_t0: &'a [DVec3],
    /// Positions at the next frame, for continuous queries; else empty.
    pub x_t1: &'a [DVec3],
}

/// Returns the `limit` earliest impacts, sorted by pair. None means all impacts.
pub(super) fn earliest_impacts(impacts: &[Impact], limit: Option<usize>) -> Vec<Impact> {
    let mut kept = impacts.to_vec();
    if let Some(limit) = limit.filter(|limit| *limit < kept.len()) {
        kept.sort_by(|a, b| a.time.total_cmp(&b.time));
        kept.truncate(limit);
        kept.sort_by_key(|impact| impact.pair);
    }
    kept
}
