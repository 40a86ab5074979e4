//! Command-line arguments as typed, and the help texts. [`commands`](crate::commands) interprets the arguments.

use std::ffi::OsString;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec3;
use sscc::parts::is_reach;
use sscc::{Clearance, Method, Neighbours};
use sscc_sim::UNITS;

/// The template of a help page with examples, one command a line. The examples are part of the template because clap
/// wraps all other text at the terminal's width, and a wrapped command cannot be pasted into a shell.
macro_rules! with_examples {
    ($($example:literal)+) => {
        concat!(
            "{before-help}{about-with-newline}\n{usage-heading} {usage}\n\n{all-args}\n\nExamples:",
            $("\n  ", $example,)+
            "{after-help}"
        )
    };
}

/// Exact self-collision detection for deformable triangle meshes.
///
/// A mesh deforms by modes: at q its shape is x = p + U q. `sscc certify` computes certificates once. `sscc check` then
/// answers whether the shape collides with itself at q. For the guarantee see docs/guarantees.md in the repository.
#[derive(Debug, Parser)]
#[command(
    name = "sscc",
    version,
    propagate_version = true,
    max_term_width = 100,
    help_template = with_examples!(
        "sscc demo --out demo"
        "sscc certify demo/spring.model.safetensors -o spring.sscc.safetensors"
        "sscc check demo/spring.model.safetensors --certificates spring.sscc.safetensors --trajectory demo/spring.npy"
    ),
    after_help = "Exit codes: 0 done (check: every q is free), 1 check found a collision or audit a violation, 2 error, \
        130 interrupted."
)]
pub struct Cli {
    /// The subcommand.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Certify and animate an embedded spring, and check every frame by three methods
    Demo(Demo),
    /// Compute deformation modes of a surface, a solid or an animation, and write a model file
    Modes(Modes),
    /// Compute the certificates of a model, and write them to a file
    Certify(Certify),
    /// Check whether a model collides with itself at q, or a mesh as it is, in frames, in an animation or against another
    /// mesh, and list the colliding triangle pairs
    Check(Box<Check>),
    /// Find for each mode or morph target the first weight at which the shape touches itself
    Sweep(Box<Sweep>),
    /// Find a free q near each colliding q of a model
    Resolve(Box<Resolve>),
    /// Compute the q of a load: the linear static answer of a model with stiffness
    Load(Load),
    /// Compute the q whose shape is nearest to given positions of all vertices
    Fit(Fit),
    /// Search for collisions that refute certificates, and measure how tight their radii are
    Audit(Audit),
    /// Show the contents of a model, certificate, mesh, solid or glTF file
    Info(Info),
    /// Simulate the bodies of a scene with contact and friction, and write their motion
    Simulate(Simulate),
    /// Measure queries by every method, and by another library for comparison
    Bench(Bench),
    /// Show a model in the browser (modes, collisions and certified radii, live), or the report of a folder
    View(View),
}

/// `sscc demo`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc demo"
        "sscc demo --out demo"
    )
)]
pub struct Demo {
    /// Also write the spring, its model, its certificates, the animation and a report to this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc modes`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc modes bunny.obj -o bunny.model.safetensors --kind nonlinear --rank 30"
        "sscc modes bunny.obj -o bunny.model.safetensors --kind polynomial"
        "sscc modes frames/ -o horse.model.safetensors --kind pca --rank 10"
        "sscc modes bar.veg -o bar.model.safetensors --kind linear --rank 20 --fix box:-1,-1,-1,1,1,0"
    ),
    after_help = "\
A closed surface is embedded in a lattice of cubes. The lattice keeps parts separate that are close in space but not \
along the surface. Modes of solids are mass-orthonormal, and their default metric is energy. Modes without a solid \
(pca, or polynomial modes of a surface) have the displacement metric."
)]
pub struct Modes {
    /// A triangle mesh (.obj, .off, .ply, .stl), or a solid of tetrahedra and cubes (.mesh, .veg, .msh, .node, .ele);
    /// for pca a folder of meshes with the same faces (the frames)
    #[arg(value_name = "SOURCE")]
    pub source: PathBuf,
    /// The model file to write: *.model.safetensors
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How to compute the modes
    #[arg(long, value_enum)]
    pub kind: ModesKind,
    /// Number of modes [default: 20 for linear, 30 for nonlinear; for pca as many as explain 99.9% of the variance]
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(1..=500))]
    pub rank: Option<u32>,
    /// A solid that moves the surface SOURCE, such as a coarse mesh around it: each vertex moves with the element that
    /// contains it, or with the nearest one
    #[arg(long, value_name = "FILE", conflicts_with = "resolution")]
    pub solid: Option<PathBuf>,
    /// Factor on all lengths of the files, which are in metres then
    #[arg(long, value_name = "S", value_parser = scale, conflicts_with = "units")]
    pub scale: Option<f64>,
    /// Unit of length of the files [default: m]
    #[arg(long, value_name = "UNIT", value_parser = PossibleValuesParser::new(UNITS.map(|(name, _)| name)))]
    pub units: Option<String>,
    /// Vertices that do not move: numbers counted from 0, as in 0,5,7 (with --solid those of the solid);
    /// box:X0,Y0,Z0,X1,Y1,Z1 in the units of the file; or a file of numbers (.npy, text; VegaFEM's .bou counts from 1) [default: none; the modes
    /// are those of a free body, without its rigid motions]
    #[arg(long, value_name = "VERTICES", allow_hyphen_values = true)]
    pub fix: Option<String>,
    /// The material: steel, aluminium, glass, ceramic, wood, plastic, polycarbonate, rubber,
    /// spring-steel, stainless-steel, titanium, brass, copper, nylon, pla, concrete, or any of
    /// youngs=E,poisson=NU,density=RHO; it overrides the materials in a solid's file [default: those of the file, else
    /// youngs=1e6,poisson=0.4,density=1000]
    #[arg(long, value_name = "MATERIAL")]
    pub material: Option<String>,
    /// Cubes along the longest side of the lattice around a surface [default: as many as make about 20,000 cubes in
    /// all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub resolution: Option<u32>,
    #[command(flatten)]
    pub json: Json,
}

impl Modes {
    /// Returns the factor on all lengths of the files.
    pub fn factor(&self) -> f64 {
        let unit = |name: &String| UNITS.iter().find(|(known, _)| known == name).map(|(_, metres)| *metres);
        self.scale.or_else(|| self.units.as_ref().and_then(unit)).unwrap_or(1.0)
    }
}

/// Parses a factor on lengths.
fn scale(typed: &str) -> Result<f64, String> {
    let factor = typed.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
    factor.ok_or_else(|| "a number above 0 was expected".into())
}

/// Kinds of modes that `sscc modes` makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModesKind {
    /// The lowest natural vibrations of a solid (linear modal analysis)
    Linear,
    /// A basis for large deformations (modal derivatives), with the reduced forces of the solid
    Nonlinear,
    /// The 24 quadratic polynomials of the rest position without rigid motions; with --resolution or --material also
    /// the stiffness and reduced forces of a solid
    Polynomial,
    /// The mean and the principal components of an animation; a unit of q is one standard deviation
    Pca,
}

impl ModesKind {
    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Nonlinear => "nonlinear",
            Self::Polynomial => "polynomial",
            Self::Pca => "pca",
        }
    }
}

/// The files of a model.
#[derive(Debug, Args)]
pub struct Model {
    /// The model: *.model.safetensors, a .glb, .gltf or .vrm with morph targets, a complete .npz (mean, components,
    /// faces), or a mesh (.obj, .off, .ply, .stl) or solid (.mesh, .veg, .msh, .node, .ele) with --modes; check without a
    /// q takes any of them as a mesh
    #[arg(value_name = "MODEL")]
    pub path: PathBuf,
    /// The modes U of a mesh: .npy (3V x r, V x 3 x r, r x V x 3), .npz, a VegaFEM modal matrix (.U, .float, ...), or
    /// a folder of target meshes
    #[arg(long, value_name = "FILE")]
    pub modes: Option<PathBuf>,
    /// The mesh of a glTF file that has several (sscc info lists them); FILE#NAME in place of FILE does the same
    #[arg(long, value_name = "NAME")]
    pub mesh_name: Option<String>,
}

/// How to compute certificates. Each option may be absent, so a flag that contradicts given certificates can be
/// refused.
#[derive(Debug, Args)]
pub struct Options {
    /// Largest relative error of the root's radius; between 0 and 1. Much larger radii are less precise [default: 0.1]
    #[arg(long, value_name = "E", value_parser = parse_epsilon)]
    pub epsilon: Option<f64>,
    /// The metric: energy (of models with a stiffness), displacement, mass, identity, or a file with the matrix M: its
    /// diagonal, one weight for each mode (.npy or text), or a dense symmetric one (.npy of shape r x r) [default: the
    /// model's]
    #[arg(long, value_name = "METRIC")]
    pub metric: Option<PathBuf>,
    /// The centre, the q from which |z| is measured: r numbers, weights by name, or a file [default: 0, the rest pose]
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub center: Option<String>,
    /// Which pairs of triangles with a common vertex count as colliding [default: exclude]
    #[arg(long, value_parser = neighbours(), value_name = "FILTER")]
    pub neighbours: Option<Neighbours>,
    /// Ignore the pairs that collide at rest, and those within this many rings of them on the surface (--ignore-rest=1: whose
    /// triangles touch theirs): they never count
    #[arg(long, value_name = "RINGS", num_args = 0..=1, require_equals = true, default_missing_value = "0")]
    pub ignore_rest: Option<u32>,
    #[command(flatten)]
    pub groups: Groups,
    /// Whether to weld vertices of equal position and modes (or frames), for adjacency only [default: on for STL and glTF]
    #[arg(long, value_enum, value_name = "SWITCH", num_args = 0..=1, require_equals = true, default_missing_value = "on")]
    pub weld: Option<Switch>,
    /// Maximum number of exceptions: pairs that collide at the centre, which no radius covers and every query tests
    /// [default: half the number of triangles]
    #[arg(long, value_name = "N")]
    pub max_exceptions: Option<usize>,
    /// Which certificates to store [default: full; paper where check or view computes them]
    #[arg(long, value_enum, value_name = "SCHEME")]
    pub scheme: Option<Scheme>,
    /// Memory for the pair tree of the scheme full, in bytes for each triangle; a node pair takes 8 [default: 64]
    #[arg(long, value_name = "BYTES", value_parser = clap::value_parser!(u32).range(1..))]
    pub budget: Option<u32>,
    /// Memory for local certificates of the scheme full, in bytes for each triangle, beside what the pair tree leaves of its own;
    /// 0: none [default: 64]
    #[arg(long, value_name = "BYTES")]
    pub local_budget: Option<u32>,
    /// How far radii of the scheme full may reach, in units of the paper's global radius, at least 1; they end before where
    /// the budget does [default: 1]
    #[arg(long, value_name = "X", value_parser = parse_reach)]
    pub reach: Option<f64>,
    #[command(flatten)]
    pub threads: Threads,
}

/// Groups of triangles, and which pairs of them count.
#[derive(Debug, Args)]
pub struct Groups {
    /// Pairs of triangles between groups A and B do not count (A,A: within A); can be repeated
    #[arg(long, value_name = "A,B", conflicts_with = "only_groups")]
    pub ignore_groups: Vec<String>,
    /// Only pairs of triangles between groups A and B count (A,A: within A); can be repeated
    #[arg(long, value_name = "A,B")]
    pub only_groups: Vec<String>,
    /// The groups: group (OBJ: g; glTF: primitives, named #0, #1, ...), object (OBJ: o), material (OBJ: usemtl; glTF:
    /// materials), or a file with one number for each triangle (.npy or text) [default: group]
    #[arg(long, value_name = "GROUPS")]
    pub group_by: Option<PathBuf>,
}

/// On or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Yes
    On,
    /// No
    Off,
}

/// Parses which pairs of triangles with common vertices count.
fn neighbours() -> impl TypedValueParser<Value = Neighbours> {
    named([
        ("exclude", "None"),
        ("include-one-vertex", "Those with exactly one common vertex, where they have another common point"),
        (
            "include-folded",
            "Those with one, two or three, where they have another common point than these vertices and the edges between them, \
             and doubled faces. For meshes without modes; not with --continuous",
        ),
    ])
}

/// Parses a value of the core by its name. Each name has a help text.
fn named<T, const N: usize>(names: [(&'static str, &'static str); N]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = sscc::Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<T>())
}

/// The number of threads.
#[derive(Debug, Args)]
pub struct Threads {
    /// Number of threads; the result does not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

/// Which certificates a file stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Scheme {
    /// A radius for each node of the BVH, and for each pair of the root's children
    Paper,
    /// Also the pair tree: the node pairs with radii below a limit, within the budget; and local certificates, which prove nodes
    /// free far beyond their radii. Queries are faster where the root's radius is reached, but the file is larger and takes
    /// longer to compute
    Full,
}

/// `sscc certify`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc certify bunny.model.safetensors -o bunny.sscc.safetensors"
        "sscc certify bunny.model.safetensors -o large.sscc.safetensors --budget 256 --reach 32"
        "sscc certify face.obj --modes face.U.float -o face.sscc.safetensors --metric mass --scheme paper"
        "sscc certify head.glb --mesh-name Head -o head.sscc.safetensors --picture head.png"
    )
)]
pub struct Certify {
    #[command(flatten)]
    pub model: Model,
    /// The certificate file to write: *.sscc.safetensors
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Also draw the certified deformations (.png): the shape at the centre, and the shape at the root's radius along
    /// each of the first four modes
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

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
        "sscc check face.obj --against bunny.obj --curves cut.obj"
        "sscc check character.glb#shirt --against character.glb#body"
        "sscc check bunny.obj --depths --json"
        "sscc check face.obj --against bunny.obj --clearance 0.2"
    ),
    after_help = "\
With --q or --trajectory, the certificates contain the metric, the centre, the neighbours, welding and ignored pairs; a \
flag that contradicts them is refused. Without, a mesh needs no modes: it is checked as it is, or in frames or an \
animation.\n\
Exit codes: 0 everything is free, 1 something collides (with --clearance: is nearer than that), 2 error."
)]
pub struct Check {
    #[command(flatten)]
    pub model: Model,
    /// Further meshes, checked one by one; each result names its file. A folder is a data set: all its meshes, solids and glTF
    /// files. A file that cannot be read does not end the run
    #[arg(value_name = "MESH")]
    pub meshes: Vec<PathBuf>,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
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
    /// and tell the smallest distance; triangles with a common vertex never count
    #[arg(
        long,
        value_name = "D",
        allow_hyphen_values = true,
        conflicts_with_all = ["continuous", "first", "limit", "depths", "curves", "pose", "report", "method", "certificates", "neighbours"]
    )]
    pub clearance: Option<f64>,
    /// With --clearance: leave out triangles of one mesh within N rings of each other on the surface: 1 for a common vertex, 2 for a
    /// common neighbour of this kind, and so on [default: 1]
    #[arg(long, value_name = "N", requires = "clearance", conflicts_with = "against", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rings: Option<u32>,
    /// List one colliding pair of each query (with --continuous: the one with the earliest time of impact)
    #[arg(long, conflicts_with = "limit")]
    pub first: bool,
    /// List at most N colliding pairs of each query (with --continuous: those with the earliest times of impact); if the
    /// limit stops the search, the count is a lower bound
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Also write the shape of the last answer with its colliding triangles marked: .ply (red) or .obj (in groups)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["trajectory", "first", "limit", "against", "meshes"])]
    pub pose: Option<PathBuf>,
    /// Also write the curves in which the last answer's surfaces intersect, as polylines: .obj or .ply
    #[arg(long, value_name = "FILE", conflicts_with_all = ["continuous", "first", "limit"])]
    pub curves: Option<PathBuf>,
    /// Add the penetration depth of each pair, and the direction in which its second triangle leaves the first
    #[arg(long, conflicts_with = "continuous")]
    pub depths: bool,
    /// Also write a report (.html) that plays the frames of a mesh with their colliding pairs: one file for any browser
    #[arg(long, value_name = "FILE", conflicts_with_all = ["trajectory", "q", "first", "limit", "meshes"])]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
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

/// Which answers to print.
#[derive(Debug, Args)]
pub struct Only {
    /// Print these answers only; the summary and the exit code are those of all [default: print all]
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
    /// Those of q, frames and meshes that collide
    Colliding,
}

impl Check {
    /// Returns the clearance that is asked for.
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub fn clearance(&self) -> anyhow::Result<Option<Clearance>> {
        let of = |distance: f64| match Clearance::new(distance) {
            Ok(clearance) => Ok(clearance.beyond_rings(self.rings.unwrap_or(1))),
            Err(_) => anyhow::bail!("--clearance is {distance}: it must be positive and finite"),
        };
        self.clearance.map(of).transpose()
    }

    /// Returns the maximum number of pairs for each query.
    pub fn max_pairs(&self) -> Option<usize> {
        self.limit.map(|limit| limit as usize).or(self.first.then_some(1))
    }
}

/// The motion of a mesh without modes.
#[derive(Debug, Args)]
pub struct Motion {
    /// Frames of the mesh: .npy of shape (T, V, 3) with the positions of all vertices, a .pc2 point cache, or a folder
    /// of meshes with the same faces (9.obj before 10.obj)
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["trajectory", "q", "animation"])]
    pub frames: Option<PathBuf>,
    /// Another mesh: list the pairs (triangle of MODEL, triangle of this mesh) that collide
    #[arg(long, value_name = "MESH", conflicts_with_all = ["trajectory", "q", "animation", "meshes"])]
    pub against: Option<PathBuf>,
    /// The other mesh where its glTF file has several, as --mesh-name for MODEL
    #[arg(long, value_name = "NAME", requires = "against")]
    pub against_mesh: Option<String>,
    /// Frames of the other mesh, as many as those of --frames
    #[arg(long, value_name = "FRAMES", requires = "against")]
    pub against_frames: Option<PathBuf>,
    /// The animation of a .glb, .gltf or .vrm, by name or number, as a player would show it: nodes, morph targets, skins
    #[arg(long, value_name = "NAME", conflicts_with_all = ["trajectory", "q", "mesh_name"])]
    pub animation: Option<String>,
    /// Check the animation N times a second, from 0 to its last key frame [default: 30]
    #[arg(long, value_name = "N", requires = "animation", conflicts_with = "times")]
    pub fps: Option<f64>,
    /// Check the animation at these times (s)
    #[arg(
        long,
        value_name = "TIMES",
        requires = "animation",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub times: Option<Vec<f64>>,
    /// Also compare the meshes of every two nodes with each other at each time; those that collide have a line. A glTF file with
    /// several meshes is compared so without --animation, too
    #[arg(long, requires = "animation")]
    pub between_nodes: bool,
    /// Check the mesh at this node only, by its number in the file [default: every node with a mesh]
    #[arg(long, value_name = "N", requires = "animation")]
    pub node: Option<usize>,
    /// How to read skin weights that do not sum to 1 [default: normalized]
    #[arg(long, value_enum, value_name = "READING", requires = "animation")]
    pub weights: Option<Weights>,
}

/// Readings of skin weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Weights {
    /// Divide the weights of each vertex by their sum, as three.js does
    Normalized,
    /// Use the weights of the file
    AsStored,
}

/// Parses a method of a query.
fn method() -> impl TypedValueParser<Value = Method> {
    named([
        ("certified", "Certificates; where they fail, a traversal with BD-tree AABBs"),
        ("bdtree", "A traversal with BD-tree AABBs, without certificates"),
        ("traditional", "A refit of all AABBs, then a traversal"),
        ("normal-cones", "As traditional, with normal cones and the contour test"),
        ("brute-force", "A test of every triangle pair"),
    ])
}

/// `sscc sweep`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc sweep head.glb"
        "sscc sweep spring.model.safetensors --certificates spring.sscc.safetensors --range=-1,1 --json"
        "sscc sweep face.obj --modes targets/ --ignore-rest --pose poses/"
        "sscc sweep head.glb --ignore-rest=1 --intervals"
    ),
    after_help = "\
Each weight goes up and down from its value in --q; the others stay. Free is proven at every weight, not at samples.\n\
Exit codes: 0 nothing touches, 1 some sweep is not free to its end, 2 error."
)]
pub struct Sweep {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    /// The range of every weight [default: 0,1 for morph targets; 3 standard deviations for principal components; else as
    /// far as moves a vertex by half the AABB's diagonal]
    #[arg(long, value_name = "A,B", allow_hyphen_values = true)]
    pub range: Option<String>,
    /// The weights at the start: r numbers, by name, as in jawOpen=0.5, or a file [default: the centre]
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub q: Option<String>,
    /// Also write the shape at each hit (.ply), its colliding triangles red, to this folder
    #[arg(long, value_name = "DIR")]
    pub pose: Option<PathBuf>,
    /// Find all intervals of each weight over which the shape collides, from the low end of its range to the high one, with the
    /// pairs and the largest penetration depth of N samples
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "101", conflicts_with = "pose")]
    pub intervals: Option<usize>,
    /// List the pairs of modes that, both at the upper end of their ranges, collide in pairs that collide with neither alone
    #[arg(long, conflicts_with_all = ["pose", "intervals"])]
    pub combinations: bool,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc resolve`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc resolve spring.model.safetensors --certificates spring.sscc.safetensors --trajectory q.npy"
        "sscc resolve head.glb --q=1,0,0 --json"
    ),
    after_help = "\
Exit codes: 0 every q is resolved, 1 some q is not, 2 error."
)]
pub struct Resolve {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    #[command(flatten)]
    pub at: At,
    #[command(flatten)]
    pub only: Only,
    /// The free q from which the search begins: r numbers, weights by name, or a file [default: the centre]
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub from: Option<String>,
    /// Exceptions, the pairs that collide at the centre, must be free as well
    #[arg(long)]
    pub all: bool,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc load`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc load bar.model.safetensors --force 12:0,0,-5 --force 13:0,0,-5 -o load.npy"
        "sscc load bar.model.safetensors --gravity -o load.npy"
    )
)]
pub struct Load {
    #[command(flatten)]
    pub model: Model,
    /// A force on a vertex of the surface (N); may be repeated
    #[arg(long, value_name = "VERTEX:FX,FY,FZ", allow_hyphen_values = true, value_parser = force)]
    pub force: Vec<(u32, DVec3)>,
    /// The weight of the body, with this acceleration [default where it has no value: 0,0,-9.81 m/s^2]
    #[arg(long, value_name = "GX,GY,GZ", num_args = 0..=1, require_equals = true, default_missing_value = "0,0,-9.81",
        allow_hyphen_values = true, value_parser = vector)]
    pub gravity: Option<DVec3>,
    /// The q to write: *.npy of shape (r)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc fit`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc fit spring.model.safetensors frames.npy -o fitted.npy"
        "sscc fit spring.model.safetensors frames/ -o fitted.npy --json"
    )
)]
pub struct Fit {
    #[command(flatten)]
    pub model: Model,
    /// Positions of all vertices: .npy of shape (V, 3) or (T, V, 3), a .pc2 point cache, or a folder of meshes with the same faces
    #[arg(value_name = "POSITIONS")]
    pub positions: PathBuf,
    /// The q to write: *.npy of shape (r), of several frames (T, r)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub json: Json,
}

/// Parses a force on a vertex.
fn force(typed: &str) -> Result<(u32, DVec3), String> {
    let found = typed.split_once(':').and_then(|(number, force)| Some((number.trim().parse().ok()?, force)));
    let Some((number, force)) = found else {
        return Err("VERTEX:FX,FY,FZ was expected, as in 12:0,0,-5".into());
    };
    Ok((number, vector(force)?))
}

/// Parses three finite numbers.
fn vector(typed: &str) -> Result<DVec3, String> {
    let numbers: Result<Vec<f64>, _> = typed.split(',').map(|number| number.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()).map(DVec3::from_array);
    numbers.filter(|v| v.is_finite()).ok_or_else(|| "three numbers were expected, as in 0,0,-9.81".into())
}

/// `sscc audit`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc audit spring.model.safetensors --certificates spring.sscc.safetensors --samples 2000"
    ),
    after_help = "\
Exit codes: 0 no violation, 1 a collision refutes a certificate, 2 error."
)]
pub struct Audit {
    #[command(flatten)]
    pub model: Model,
    /// The certificates to attack
    #[arg(long, value_name = "FILE")]
    pub certificates: PathBuf,
    /// Number of configurations to test
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// Seed of the pseudo-random numbers; the same seed gives the same configurations
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc info`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc info spring.sscc.safetensors"
        "sscc info bunny.obj --json"
        "sscc info bar.veg"
        "sscc info character.glb"
    )
)]
pub struct Info {
    /// A model (*.model.safetensors, .glb, .gltf, .vrm, .npz), certificates (*.sscc.safetensors), a mesh (.obj, .off, .ply,
    /// .stl) or a solid (.mesh, .veg, .msh, .node, .ele)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc simulate`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc simulate scenes/spring.toml --out spring"
        "sscc simulate bunny16 --models models/ --out bunnies"
        "sscc simulate bunny16 --models models/ --out bunnies --steps 500"
        "sscc simulate my.toml --json"
    ),
    after_help = "\
The command writes trajectories.npz, costs.npz, animation.glb, summary.json, report.html and, for scenes with sound, \
sound.wav and sound_float.wav. The same command resumes a simulation that was interrupted or killed. The results are \
bit for bit those of an uninterrupted one.\n\
Embedded scenes: spring, bunny16, bunny128, dragon-nonlinear, dragon-polynomial.\n\
Exit codes: 0 done, 2 error or the motion diverges (the steps before are written), 130 interrupted."
)]
pub struct Simulate {
    /// The scene: a .toml file, or the name of an embedded scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The output folder, created if it is missing [default: the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of steps from the beginning of the scene [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,
    /// Begin again, and remove the files of an earlier simulation from the folder
    #[arg(long)]
    pub restart: bool,
    /// The folder of bunny_14964_closed.obj and dragon_77202_closed.ply [default: SSCC_MODELS; without it embedded
    /// shapes replace them]
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// The folder in which runs share models and certificates [default: sscc in the system's cache folder]
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    #[command(flatten)]
    pub threads: Threads,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc bench`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc bench --list"
        "sscc bench amplitudes --models models/"
        "sscc bench amplitudes --only spring --samples 4"
        "sscc bench bunny128 --steps 50 --json"
    ),
    after_help = "\
All methods answer the same queries, interleaved on one thread, and must list the same pairs.\n\
Exit codes: 0 done, 2 error, or two exact methods differ."
)]
pub struct Bench {
    /// The scenario to measure (--list lists all)
    #[arg(value_name = "SCENARIO", required_unless_present = "list")]
    pub scenario: Option<String>,
    /// List the scenarios
    #[arg(long)]
    pub list: bool,
    /// The folder of bunny_14964_closed.obj and dragon_77202_closed.ply [default: SSCC_MODELS; without it embedded
    /// shapes replace them]
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// Scenes and kinetic: steps to measure, in 10 blocks spread evenly [default: 100, kinetic 20,000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,
    /// Amplitudes, mixed, norms and growth: samples of each row [default: 64, mixed 200, norms 50, growth 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: Option<u32>,
    /// Amplitudes, mixed, norms and growth: measure this model only
    #[arg(long, value_name = "MODEL")]
    pub only: Option<String>,
    /// Replace every model by a spring of 4,000 triangles, to test the bench in seconds
    #[arg(long)]
    pub quick: bool,
    /// Growth and norms: also plot the results
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Scenes, amplitudes, mixed, norms and growth: also write the results as a page in one file
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// The folder in which runs share models and certificates [default: sscc in the system's cache folder]
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    #[command(flatten)]
    pub json: Json,
}

/// `sscc view`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc view spring.model.safetensors --certificates spring.sscc.safetensors"
        "sscc view head.glb --no-open --port 8080"
        "sscc view demo/"
        "sscc view spring.model.safetensors --compare-metrics"
    ),
    after_help = "\
The server listens on this machine only, and its address contains a random token. The page works offline. Ctrl-C or \
SIGTERM stops the server.\n\
MODEL may be a folder with a report, as written by sscc simulate or sscc demo --out: the page then shows the report, \
and takes no options of models.\n\
The certificates contain the metric, the centre, the neighbours, welding and ignored pairs; a flag that contradicts \
them is refused."
)]
pub struct View {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    /// Port of the address [default: a free port]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub port: Option<u16>,
    /// Print the address only, and open no browser
    #[arg(long)]
    pub no_open: bool,
    /// Models with a stiffness: also plot the largest deformation that the root certifies under the energy and the
    /// displacement metric, over the number of modes; certificates for each number are computed first
    #[arg(long)]
    pub compare_metrics: bool,
    #[command(flatten)]
    pub options: Options,
}

/// The form of the result.
#[derive(Clone, Copy, Debug, Args)]
pub struct Json {
    /// Print the result only, as JSON
    #[arg(long)]
    pub json: bool,
}

/// Joins `--weld on` and `--weld off` to one argument. The value of `--weld` is optional, so the parser would take a word
/// after it for the name of a file.
pub fn with_joined_switches(typed: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut has_ended = false;
    for word in typed {
        let is_value = word == "on" || word == "off";
        match joined.last_mut() {
            Some(last) if !has_ended && is_value && last == "--weld" => {
                last.push("=");
                last.push(word);
            }
            _ => {
                has_ended |= word == "--";
                joined.push(word);
            }
        }
    }
    joined
}

fn parse_epsilon(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(epsilon) if epsilon > 0.0 && epsilon < 1.0 => Ok(epsilon),
        _ => Err("a number between 0 and 1 was expected".into()),
    }
}

fn parse_reach(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(reach) if is_reach(reach) => Ok(reach),
        _ => Err("a finite number of at least 1 was expected".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_value_of_weld_may_follow_a_blank() {
        let weld = |words: &str| {
            let words = with_joined_switches(words.split(' ').map(OsString::from));
            match Cli::try_parse_from(words).map(|cli| cli.command) {
                Ok(Command::Check(check)) => Some((check.options.weld, check.meshes)),
                _ => None,
            }
        };
        assert_eq!(weld("sscc check a.obj --weld off"), Some((Some(Switch::Off), vec![])));
        assert_eq!(weld("sscc check --weld on a.obj"), Some((Some(Switch::On), vec![])));
        assert_eq!(weld("sscc check --weld=off a.obj"), Some((Some(Switch::Off), vec![])));
        assert_eq!(weld("sscc check a.obj --weld b.obj"), Some((Some(Switch::On), vec!["b.obj".into()])));
        assert_eq!(weld("sscc check a.obj -- off"), Some((None, vec!["off".into()])));
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
