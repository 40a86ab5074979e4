//! The answer of `sscc check` to one query: the keys of its JSON line.

use serde::Serialize;
use sscc::parts::BodyPenetration;
use sscc::{Clearance, Enclosed, Pair, Proof};
use sscc_tasks::{DetectionAnswer, LeftOut, Near};

/// The answer to a discrete query at one q or frame, or to a continuous query from one to the next.
#[derive(Serialize)]
pub struct Answer<'a> {
    /// The mesh, if the run has several. Its name may have line breaks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The node, in an animation or a scene; with --against only if several nodes show the mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<usize>,
    /// The node of the other mesh, in an answer about two nodes; with --against only if several nodes show that mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_node: Option<usize>,
    /// The name of the node, in a scene at rest and in an answer about two nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node_name: Option<&'a str>,
    /// The name of the other node, in an answer about two nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_node_name: Option<&'a str>,
    /// The names of both nodes, for the text.
    #[serde(skip)]
    pub names: [Option<&'a str>; 2],
    /// The time, in an animation (s) or a `.pvd` collection.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    pub index: usize,
    /// |z|, for continuous queries the larger one of start and end; null without modes.
    pub norm: Option<f64>,
    pub colliding: bool,
    pub count: usize,
    pub complete: bool,
    pub pairs: &'a [Pair],
    /// The time of impact of each pair, for continuous queries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times: Option<&'a [f64]>,
    /// The penetration depth of each pair.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depths: Option<Vec<f64>>,
    /// For each pair the direction in which its second triangle leaves the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub directions: Option<Vec<[f64; 3]>>,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub near: Option<NearAnswer<'a>>,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub inside: Option<InsideAnswer>,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub penetration: Option<PenetrationAnswer>,
    pub microseconds: f64,
    pub root_certified: Option<bool>,
    /// The kind of proof of the answer: `radius`, `local` or `search`; null without modes.
    pub proof: Option<&'static str>,
    /// Number of pairs that no certificate covers; absent if it is 0.
    #[serde(skip_serializing_if = "is_zero")]
    pub exceptions: usize,
    /// Number of ignored pairs; absent if it is 0.
    #[serde(skip_serializing_if = "is_zero")]
    pub ignored: usize,
    /// Names of all pairs that are left out, if pairs are ignored.
    #[serde(rename = "left_out", skip_serializing_if = "Option::is_none")]
    pub listed_left_out: Option<String>,
    #[serde(skip)]
    pub left_out: &'a LeftOut,
    pub opened: u64,
    pub box_tests: u64,
    pub triangle_tests: u64,
}

/// The parts of two meshes that are inside the other one, if nothing collides.
#[derive(Serialize)]
pub struct InsideAnswer {
    /// Number of connected components of the mesh inside the other one, and of the other one inside the mesh.
    pub inside: [usize; 2],
    /// Number of all connected components of the mesh, and of the other one.
    pub components: [usize; 2],
}

/// The overlap of two closed meshes.
#[derive(Serialize)]
pub struct PenetrationAnswer {
    /// The volume that both share.
    pub penetration_volume: f64,
    /// Bound of the error of this volume.
    pub penetration_volume_error: f64,
    /// The diameter of a ball inside of both.
    pub penetration_depth: f64,
    /// Bound of the error: no ball inside of both has a diameter larger by more than this.
    pub penetration_depth_error: f64,
}

impl From<BodyPenetration> for PenetrationAnswer {
    fn from(found: BodyPenetration) -> Self {
        Self {
            penetration_volume: found.volume,
            penetration_volume_error: found.volume_error,
            penetration_depth: found.depth,
            penetration_depth_error: found.depth_error,
        }
    }
}

impl InsideAnswer {
    fn new(sides: [Enclosed; 2]) -> Option<Self> {
        let inside = sides.map(|side| side.inside);
        (inside != [0, 0]).then(|| Self { inside, components: sides.map(|side| side.components) })
    }
}

/// The pairs that are nearer than a clearance.
#[derive(Serialize)]
pub struct NearAnswer<'a> {
    pub clearance: f64,
    pub rings: u32,
    /// The smallest distance of two triangles that count, even if it is not below the clearance. Null if none count, or if it
    /// is not below the clearance and certificates do not determine it.
    pub distance: Option<f64>,
    /// The triangles at the smallest distance.
    pub nearest: Option<Pair>,
    /// The distance of each pair.
    pub distances: &'a [f64],
    /// Whether the smallest distance is unknown, because certificates only prove that it is not below the clearance.
    #[serde(skip)]
    pub is_open: bool,
}

impl<'a> NearAnswer<'a> {
    fn new((clearance, near): (Clearance, &'a Near)) -> Self {
        Self {
            clearance: clearance.distance(),
            rings: clearance.rings(),
            distance: near.nearest.map(|near| near.distance),
            nearest: near.nearest.map(|near| near.pair),
            distances: &near.distances,
            is_open: near.is_open,
        }
    }
}

impl<'a> Answer<'a> {
    /// Whether the answer is a finding: a collision, or a pair nearer than the clearance.
    pub fn is_finding(&self) -> bool {
        self.count > 0
    }

    /// Creates the line of an answer. `has_files` states whether the run has several files.
    pub fn new(found: &DetectionAnswer<'a>, has_files: bool) -> Self {
        let has_names = found.time.is_none() || found.other_node.is_some();
        Self {
            file: has_files.then(|| found.file.display().to_string()),
            node: found.node,
            against_node: found.other_node,
            node_name: has_names.then_some(found.node_names[0]).flatten(),
            against_node_name: found.node_names[1],
            names: found.node_names,
            time: found.time,
            index: found.index,
            norm: found.norm,
            colliding: match found.near {
                Some((_, near)) => near.distances.contains(&0.0),
                None => !found.pairs.is_empty(),
            },
            count: found.pairs.len(),
            complete: found.is_complete,
            pairs: found.pairs,
            times: found.times,
            depths: found.penetrations.map(|all| all.iter().map(|pair| pair.depth).collect()),
            directions: found
                .penetrations
                .map(|all| all.iter().map(|pair| pair.direction.to_array()).collect()),
            near: found.near.map(NearAnswer::new),
            inside: found.enclosed.and_then(InsideAnswer::new),
            penetration: found.body_penetration.map(PenetrationAnswer::from),
            microseconds: found.microseconds,
            root_certified: found.root_certified,
            proof: found.proof.map(Proof::into),
            exceptions: found.exceptions,
            ignored: found.left_out.ignored(),
            listed_left_out: (found.left_out.ignored() > 0).then(|| found.left_out.to_string()),
            left_out: found.left_out,
            opened: found.opened,
            box_tests: found.box_tests,
            triangle_tests: found.triangle_tests,
        }
    }
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}
