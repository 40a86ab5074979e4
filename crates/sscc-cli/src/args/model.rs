//! The model, its certificates and options that several commands share.

use std::path::PathBuf;

use super::values::named;
use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};
use sscc::Neighbours;
use sscc::parts::is_reach;

/// The files of a model.
#[derive(Debug, Args)]
pub struct Model {
    /// The model: *.model.safetensors, a .glb, .gltf or .vrm with morph targets, a complete .npz (mean, components,
    /// faces), or a mesh (.obj, .off, .ply, .stl) or solid (.mesh, .veg, .msh, .node, .ele, .vtu, .vtk) with --modes; check without a
    /// q takes any of them but the models as a mesh
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

/// Options of certificates. Each option may be absent, so a flag that contradicts given certificates can be refused.
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
    /// Ignore the pairs that collide at rest, and with --ignore-rest=N those within N rings of them on the surface (N = 1: pairs
    /// whose triangles have a vertex in common with those of such a pair): they never count
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
    /// Which certificates to store [default: full; paper where check, sweep, resolve or view computes them]
    #[arg(long, value_enum, value_name = "SCHEME")]
    pub scheme: Option<Scheme>,
    /// Memory for the pair tree of the scheme full, in bytes for each triangle; a node pair takes 8 [default: 64]
    #[arg(long, value_name = "BYTES", value_parser = clap::value_parser!(u32).range(1..))]
    pub budget: Option<u32>,
    /// Memory for local certificates of the scheme full, in bytes for each triangle; the memory that the pair tree does not use
    /// is added, and 10 to 14 bytes for the BVH and its radii are subtracted; 0: no local certificates [default: 64]
    #[arg(long, value_name = "BYTES")]
    pub local_budget: Option<u32>,
    /// Limit of the radii of the scheme full, as a multiple of the paper's global radius, at least 1; the budget may end them
    /// before [default: 1]
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
    /// The groups: group (OBJ: g; glTF: primitives, named #0, #1, ...), object or node (OBJ: o; glTF: nodes), mesh (glTF:
    /// meshes), material (OBJ: usemtl; glTF: materials), or a file with one number for each triangle (.npy or text)
    /// [default: group; in a scene, an animation or between two meshes: names of any of these kinds]
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
        ("include-one-vertex", "Those with exactly one common vertex, if they have another common point"),
        (
            "include-folded",
            "Those with one, two or three, if they have another common point than these vertices and the edges between them, \
             and doubled faces. For meshes without modes; not with --continuous",
        ),
    ])
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
