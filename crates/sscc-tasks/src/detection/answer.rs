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
    /// Number of the node, in an animation, or where several nodes show the mesh and there is another mesh.
    pub node: Option<usize>,
    /// Number of the node of the other mesh, where several show it.
    pub other_node: Option<usize>,
    /// Their names, in an animation or a scene.
    pub node_names: [Option<&'a str>; 2],
    /// Number of the q, frame or time, counted from 0; of continuous queries that of the start.
    pub index: usize,
    /// Its time (s), in an animation.
    pub time: Option<f64>,
    /// Colliding pairs, sorted.
    pub pairs: &'a [Pair],
    /// Time of impact (0 to 1) of each pair, of continuous queries.
    pub times: Option<&'a [f64]>,
    /// Depth and direction of the smallest translation that parts each pair, on request: that of its second triangle.
    pub penetrations: Option<&'a [Penetration]>,
    /// Contact curves, on request of the last answer.
    pub curves: Option<&'a ContactCurves>,
    /// The clearance, and the distances that were found; then `pairs` are those nearer than it.
    pub near: Option<(Clearance, &'a Near)>,
    /// How many connected components of the mesh are inside the other one, and of the other inside this one, where discrete
    /// queries find no pair that collides.
    pub enclosed: Option<[Enclosed; 2]>,
    /// Of two closed meshes the volume that they share and the largest ball inside of both, where asked for.
    pub body_penetration: Option<sscc::parts::BodyPenetration>,
    /// Whether `pairs` are all.
    pub is_complete: bool,
    /// Duration of the query on its thread, without reading files and evaluating animations. Where several q of a model are
    /// answered together, the time of all of them divided by their number.
    pub microseconds: f64,
    /// |z|, of a model.
    pub norm: Option<f64>,
    /// Whether the root's certificate held, of a model.
    pub root_certified: Option<bool>,
    /// What proved the answer, of a model.
    pub proof: Option<Proof>,
    /// Number of pairs that no certificate covers, so that each query tests them, of a model.
    pub exceptions: usize,
    /// The pairs that the run does not test.
    pub left_out: &'a LeftOut,
    /// Nodes and node pairs that the query opened.
    pub opened: u64,
    /// Pairs of AABBs that it compared.
    pub box_tests: u64,
    /// Pairs of triangles that it tested exactly.
    pub triangle_tests: u64,
    /// Number of queries of the whole file.
    pub queries: usize,
    /// Number of frames of the motion; 1 at rest.
    pub frames: usize,
    /// Times of all frames (s), in an animation.
    pub frame_times: Option<&'a [f64]>,
    /// The mesh at the frame; none without [`has_positions`](super::Detection::has_positions).
    pub shape: Option<ShapeInMotion<'a>>,
    /// The other mesh at the frame, likewise.
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
    /// Positions at the next frame, of continuous queries; else empty.
    pub x_t1: &'a [DVec3],
}

/// Returns the `limit` earliest impacts (None: all), sorted by pair.
pub(super) fn earliest_impacts(impacts: &[Impact], limit: Option<usize>) -> Vec<Impact> {
    let mut kept = impacts.to_vec();
    if let Some(limit) = limit.filter(|limit| *limit < kept.len()) {
        kept.sort_by(|a, b| a.time.total_cmp(&b.time));
        kept.truncate(limit);
        kept.sort_by_key(|impact| impact.pair);
    }
    kept
}
