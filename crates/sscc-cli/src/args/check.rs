//! Arguments of `sscc check`.

use std::path::PathBuf;

use super::certify::clearance;
use super::model::{Model, Options};
use super::motion::Motion;
use super::values::{Json, method};
use clap::{Args, ValueEnum};
use sscc::{Clearance, Method};

/// `sscc check`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc check spring.model.safetensors --certificates spring.sscc.safetensors --trajectory q.npy"
        "sscc check spring.model.safetensors --certificates spring.sscc.safetensors --trajectory q.npy --continuous"
        "sscc check face.obj --modes face.U.float --method traditional --q=0.5,0,-1.25"
        "sscc check head.glb --first --q=1,0,0"
        "sscc check face.obj --modes targets/ --q=0,0.5 --pose smile.ply"
        "sscc check spring.model.safetensors --trajectory q.npy --only colliding --json"
        "sscc check bunny.obj"
        "sscc check bunny.obj face.obj --json"
        "sscc check meshes/ --json"
        "sscc check mesh.obj --frames frames/ --continuous"
        "sscc check mesh.obj --frames frames.npy --ignore-rest"
        "sscc check character.glb --animation wave --fps 60 --report wave.html"
        "sscc check character.glb --animation wave --node shirt --frames-out shirt.npy"
        "sscc check face.obj --against bunny.obj --curves cut.obj"
        "sscc check character.glb#shirt --against character.glb#body"
        "sscc check bunny.obj --depths --json"
        "sscc check face.obj --against bunny.obj --clearance 0.2"
        "sscc check spring.model.safetensors --trajectory q.npy --clearance 0.01 --rings 3 --certificates near.sscc.safetensors"
    ),
    after_help = "\
With --q or --trajectory, the certificates contain the metric, the centre, the neighbours, welding and ignored pairs; a \
flag that contradicts them is refused. Without --q and --trajectory, a mesh needs no modes: it is checked as it is, or \
in frames or an animation.\n\
Exit codes: 0 everything is free, 1 something collides (with --clearance: is nearer than that), 2 error."
)]
pub struct Check {
    #[command(flatten)]
    pub model: Model,
    /// Further meshes, checked one by one; each result names its file. A folder is a data set: all its meshes, solids and glTF
    /// files. A file that cannot be read does not end the run
    #[arg(value_name = "MESH")]
    pub meshes: Vec<PathBuf>,
    /// Certificates of this model, from `sscc certify`; without them they are computed first (not with --clearance, and
    /// not for another --method than certified)
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    #[command(flatten)]
    pub at: At,
    #[command(flatten)]
    pub only: Only,
    #[command(flatten)]
    pub motion: Motion,
    /// Answer continuous queries (CCD) from each q of the trajectory, frame or time to the next, every vertex on a straight
    /// line, with a time of impact from 0 to 1 for each pair; for the tolerance see docs/guarantees.md in the repository
    #[arg(long, conflicts_with_all = ["q", "pose"])]
    pub continuous: bool,
    /// The method of the search at q; all methods list the same pairs (with --continuous they may differ in pairs that
    /// come within the tolerance without touching) [default: certified]
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// List the pairs nearer than this distance (in units of the mesh) in place of those that collide, with their distances,
    /// and print the smallest distance; triangles with a common vertex never count. With --certificates of this clearance, or a
    /// larger one, most answers take one comparison; the smallest distance is then printed only if it is below D
    #[arg(
        long,
        value_name = "D",
        allow_hyphen_values = true,
        conflicts_with_all = ["continuous", "first", "limit", "depths", "curves", "pose", "report", "method", "neighbours"]
    )]
    pub clearance: Option<f64>,
    /// With --clearance: leave out triangles of one mesh within N rings of each other on the surface: 1 for a common vertex, 2 for a
    /// common neighbour of this kind, and so on [default: 1]
    #[arg(long, value_name = "N", conflicts_with = "against", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rings: Option<u32>,
    /// List one colliding pair of each query (with --continuous: the one with the earliest time of impact)
    #[arg(long, conflicts_with = "limit")]
    pub first: bool,
    /// List at most N colliding pairs of each query (with --continuous: those with the earliest times of impact); if the
    /// limit stops the search, the count is a lower bound
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Also write the shape of the last answer with its colliding triangles marked: .ply (red), .obj (in groups) or
    /// .vtu (as data of the triangles)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["trajectory", "first", "limit", "against", "meshes"])]
    pub pose: Option<PathBuf>,
    /// Also write the curves in which the last answer's surfaces intersect, as polylines: .obj or .ply
    #[arg(long, value_name = "FILE", conflicts_with_all = ["continuous", "first", "limit"])]
    pub curves: Option<PathBuf>,
    /// Add the penetration depth of each pair, and the direction in which its second triangle leaves the first
    #[arg(long, conflicts_with = "continuous")]
    pub depths: bool,
    /// With --against: add the volume that both meshes share, and the diameter of the largest ball inside of both; both must be closed
    #[arg(long, conflicts_with_all = ["continuous", "clearance"])]
    pub penetration: bool,
    /// Also write a report (.html) that plays the frames of a mesh with their colliding pairs: one file for any browser
    #[arg(long, value_name = "FILE", conflicts_with_all = ["trajectory", "q", "first", "limit", "meshes"])]
    pub report: Option<PathBuf>,
    /// Also write the positions that are checked in every frame or at every time: .npy of shape (T, V, 3), or .pvd
    /// with .vtu files for ParaView, which have the time of each frame and mark colliding triangles; --frames reads both. For an
    /// animation that moves several nodes, with --node
    #[arg(long, value_name = "FILE", conflicts_with_all = ["trajectory", "q", "meshes", "against"])]
    pub frames_out: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

impl Check {
    /// Returns the clearance of these arguments.
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub fn clearance(&self) -> anyhow::Result<Option<Clearance>> {
        clearance(self.clearance, self.rings)
    }

    /// Returns the maximum number of pairs for each query.
    pub fn max_pairs(&self) -> Option<usize> {
        self.limit.map(|limit| limit as usize).or(self.first.then_some(1))
    }
}

/// The configurations of the queries.
#[derive(Debug, Args)]
#[group(multiple = false)]
pub struct At {
    /// Configurations, one q in each row: .npy of shape (T, r), or (r)
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// One q: r numbers, weights by the names of modes, as in jawOpen=0.5,smile=0.2 (the others are 0), or a file
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub q: Option<String>,
}

/// Selection of the answers to print.
#[derive(Debug, Args)]
pub struct Only {
    /// Print these answers only; the summary and the exit code are about all answers [default: print all]
    #[arg(long, value_enum, value_name = "ANSWERS")]
    pub only: Option<Answers>,
}

impl Only {
    /// Whether free answers are not printed.
    pub fn is_colliding(&self) -> bool {
        self.only == Some(Answers::Colliding)
    }
}

/// Kinds of answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Answers {
    /// Answers for q, frames and meshes that collide
    Colliding,
}
