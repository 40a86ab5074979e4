//! The answer of `sscc check` to one query: the keys of its JSON line.

use serde::Serialize;
use sscc::parts::BodyPenetration;
use sscc::{Clearance, Enclosed, Pair, Proof};
use sscc_tasks::{DetectionAnswer, LeftOut, Near};

/// The answer to a discrete query at one q or frame, or to a continuous query from one to the next.
#[derive(Serialize)]
pub struct Answer<'a> {
    /// The mesh, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The node and the time, in an animation; the node also where several show the mesh, with --against.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<usize>,
    /// The node of the other mesh, where several show it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_node: Option<usize>,
    /// The names of both, in a scene at rest and of two nodes; text has them in any case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node_name: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_node_name: Option<&'a str>,
    #[serde(skip)]
    pub names: [Option<&'a str>; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    pub index: usize,
    /// |z|; none without modes.
    pub norm: Option<f64>,
    pub colliding: bool,
    pub count: usize,
    pub complete: bool,
    pub pairs: &'a [Pair],
    /// The time of impact of each pair, for continuous queries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times: Option<&'a [f64]>,
    /// The penetration depth of each pair, and the direction in which its second triangle leaves the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depths: Option<Vec<f64>>,
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
    /// What proved the answer: `radius`, `local` or `search`; none without modes.
    pub proof: Option<&'static str>,
    /// Pairs that no certificate covers, where there are any.
    #[serde(skip_serializing_if = "is_zero")]
    pub exceptions: usize,
    /// The number of ignored pairs, and the names of all pairs that are left out, where pairs are ignored.
    #[serde(skip_serializing_if = "is_zero")]
    pub ignored: usize,
    #[serde(rename = "left_out", skip_serializing_if = "Option::is_none")]
    pub listed_left_out: Option<String>,
    #[serde(skip)]
    pub left_out: &'a LeftOut,
    pub opened: u64,
    pub box_tests: u64,
    pub triangle_tests: u64,
}

/// Where nothing collides, but one mesh has parts inside the other one.
#[derive(Serialize)]
pub struct InsideAnswer {
    /// How many connected components of the mesh are inside the other one, and of the other inside the mesh.
    pub inside: [usize; 2],
    /// How many they have.
    pub components: [usize; 2],
}

/// How deep two closed meshes are in each other.
#[derive(Serialize)]
pub struct PenetrationAnswer {
    /// The volume that both share, and a bound of its error.
    pub penetration_volume: f64,
    pub penetration_volume_error: f64,
    /// The diameter of a ball inside of both, and by how much more no such ball is larger.
    pub penetration_depth: f64,
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

/// Which pairs are nearer than a clearance.
#[derive(Serialize)]
pub struct NearAnswer<'a> {
    pub clearance: f64,
    pub rings: u32,
    /// The smallest distance of two triangles that count, also where it is not below the clearance; none where none count, and
    /// where it is not below and certificates leave it open.
    pub distance: Option<f64>,
    /// These triangles.
    pub nearest: Option<Pair>,
    /// The distance of each pair.
    pub distances: &'a [f64],
    /// Whether certificates leave the smallest distance open.
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

    /// Takes the values of an answer. `has_files`: whether the run has several files.
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
