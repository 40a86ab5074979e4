//! What was typed. What it means is told in [`commands`](crate::commands).

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// A page of help with examples, one command a line. They are part of the template, so that they are never wrapped: what
/// is copied from any terminal can be pasted into a shell. Everything else is wrapped at the terminal's width.
macro_rules! with_examples {
    ($($example:literal)+) => {
        concat!(
            "{before-help}{about-with-newline}\n{usage-heading} {usage}\n\n{all-args}\n\nExamples:",
            $("\n  ", $example,)+
            "{after-help}"
        )
    };
}

/// Proven self-collision detection for deformable models.
///
/// Certify a model (a triangle mesh with its deformation modes) once; from then on ask whether the deformed
/// shape x = p + U q collides with itself. "Free" is proven; "colliding" lists exactly the intersecting pairs of
/// triangles that share no vertex.
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
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Show what this does on an embedded spring: certify, animate, check every frame
    Demo(Demo),
    /// Give a mesh deformation modes, and write both as a model file
    Modes(Modes),
    /// Compute the certificates of a model, once
    Certify(Certify),
    /// Tell whether the model collides with itself at q, and which triangles meet
    Check(Check),
    /// Try to prove certificates wrong
    Audit(Audit),
    /// Tell what is in a model, certificate, mesh or solid file
    Info(Info),
    /// Let the bodies of a scene move, fall and collide, and write their motion
    Simulate(Simulate),
    /// Measure queries by every method, and beside another library
    Bench(Bench),
    /// Show a model on a page: drag its modes, see what collides and how far it is certified
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
    /// Also write the spring, its model, its certificates and the animation into this folder
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
A closed surface is embedded in a lattice of cubes; parts that are close but apart along the shape are not glued. \
Modes of solids are mass-orthonormal, and their metric is strain energy; without a solid (pca, or polynomial modes of \
a surface) it is displacement."
)]
pub struct Modes {
    /// A triangle mesh (.obj, .off, .ply, .stl), or a solid of tetrahedra and cubes (.mesh, .veg, .msh, .node, .ele);
    /// for pca a folder of meshes with the same faces, the frames
    #[arg(value_name = "SOURCE")]
    pub source: PathBuf,
    /// The model file to write: *.model.safetensors
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Where the modes come from
    #[arg(long, value_enum)]
    pub kind: ModesKind,
    /// Number of modes [default: 20 linear, 30 nonlinear, pca as many as explain 99.9% of the
    /// variance]
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(1..=500))]
    pub rank: Option<u32>,
    /// Vertices that do not move: numbers from 0, as in 0,5,7; box:X0,Y0,Z0,X1,Y1,Z1; or a file of numbers (.npy, text)
    /// [default: none, a free body without its rigid motions]
    #[arg(long, value_name = "VERTICES", allow_hyphen_values = true)]
    pub fix: Option<String>,
    /// The material: steel, aluminium, glass, ceramic, wood, plastic, polycarbonate, rubber, or any of
    /// youngs=E,poisson=NU,density=RHO; it overrides what a solid's file states [default: that, else
    /// youngs=1e6,poisson=0.4,density=1000]
    #[arg(long, value_name = "MATERIAL")]
    pub material: Option<String>,
    /// Cubes along the longest side of the lattice around a surface [default: for about 20,000 cubes in all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub resolution: Option<u32>,
    #[command(flatten)]
    pub json: Json,
}

/// Kinds of modes that `sscc modes` makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModesKind {
    /// The lowest natural vibrations of a solid (linear modal analysis)
    Linear,
    /// A basis for large deformations, with their forces (modal derivatives)
    Nonlinear,
    /// The 24 quadratic polynomials of the rest position, rigid motions taken out; with --resolution or --material also
    /// the stiffness and forces of a solid
    Polynomial,
    /// The mean and the principal components of an animation; q counts standard deviations
    Pca,
}

impl ModesKind {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Nonlinear => "nonlinear",
            Self::Polynomial => "polynomial",
            Self::Pca => "pca",
        }
    }
}

/// A model by its files.
#[derive(Debug, Args)]
pub struct Model {
    /// The model: *.model.safetensors, a .glb or .gltf with morph targets, a complete .npz (mean, components,
    /// faces), or a mesh (.obj, .off, .ply, .stl) with --modes
    #[arg(value_name = "MODEL")]
    pub path: PathBuf,
    /// The modes U of a mesh: .npy (3V x r, V x 3 x r, r x V x 3), .npz, a VegaFEM modal matrix (.U, .float, ...), or
    /// a folder of target meshes
    #[arg(long, value_name = "FILE")]
    pub modes: Option<PathBuf>,
    /// The mesh of a glTF file with several (sscc info lists them)
    #[arg(long, value_name = "NAME")]
    pub mesh_name: Option<String>,
}

/// How certificates are computed. All optional, so that contradictions to given certificates can be told.
#[derive(Debug, Args)]
pub struct Options {
    /// Relative error allowed for the root's radius and others not much larger, between 0 and 1 [default: 0.1]
    #[arg(long, value_name = "E", value_parser = parse_epsilon)]
    pub epsilon: Option<f64>,
    /// The metric: energy (of models that know their stiffness), displacement, mass, identity, or a file with M: its
    /// diagonal, one weight for each mode (.npy or text), or a dense symmetric one (.npy of shape r x r) [default: the
    /// model's]
    #[arg(long, value_name = "METRIC")]
    pub metric: Option<PathBuf>,
    /// The q from which radii are measured: r numbers, or a file (.npy or text) [default: 0, the rest pose]
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub center: Option<String>,
    /// What is asked of triangles that share a vertex [default: exclude]
    #[arg(long, value_enum, value_name = "RULE")]
    pub neighbours: Option<Neighbours>,
    /// Leave out, for good, the pairs that collide at rest
    #[arg(long)]
    pub ignore_rest: bool,
    /// Whether vertices of equal position and modes count as one, for adjacency only [default: on for STL and glTF]
    #[arg(long, value_enum, value_name = "SWITCH", num_args = 0..=1, require_equals = true, default_missing_value = "on")]
    pub weld: Option<Switch>,
    /// How many pairs that collide at the centre may be exceptions: left out of all radii and tested in every
    /// query [default: half the number of triangles]
    #[arg(long, value_name = "N")]
    pub max_exceptions: Option<usize>,
    /// Which certificates are stored [default: full; paper where check computes them for itself]
    #[arg(long, value_enum, value_name = "SCHEME")]
    pub scheme: Option<Scheme>,
    /// Memory for the pairs of nodes that the scheme full stores, in bytes for each triangle; a pair takes 8 [default:
    /// 16]
    #[arg(long, value_name = "BYTES", value_parser = clap::value_parser!(u32).range(1..))]
    pub budget: Option<u32>,
    #[command(flatten)]
    pub threads: Threads,
}

/// On or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Yes
    On,
    /// No
    Off,
}

/// Rules for triangles that share a vertex. Those that share an edge never count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Neighbours {
    /// They do not count
    Exclude,
    /// Those that share just one vertex count where they meet beside it
    IncludeOneVertex,
}

/// How much the program may use of the machine.
#[derive(Debug, Args)]
pub struct Threads {
    /// Number of threads [default: all cores]; the result is the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

/// Schemes of certificates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Scheme {
    /// A radius for every node of the hierarchy, and for each pair of the root's children
    Paper,
    /// Also the pairs of nodes that collide first, as many as the budget holds: queries are faster where the root's
    /// certificate fails, the file is larger and takes longer to compute
    Full,
}

/// `sscc certify`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc certify bunny.model.safetensors -o bunny.sscc.safetensors"
        "sscc certify bunny.model.safetensors -o small.sscc.safetensors --budget 64"
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
    /// Also draw what is certified (.png): the shape at the centre, and as far along each of the first four modes as
    /// the root's radius reaches
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
        "sscc check spring.model.safetensors --trajectory q.npy --json | grep '\"colliding\":true'"
    ),
    after_help = "\
The metric and the other options come from the certificates; a flag that contradicts them is refused.\n\
Exit codes: 0 every q is free, 1 some q collides, 2 error."
)]
pub struct Check {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    #[command(flatten)]
    pub at: At,
    /// Ask about the way from each q of the trajectory to the next, every vertex on a straight line: which pairs meet,
    /// and when (0: at the first q, 1: at the next). None is missed; one listed without need has come within 1e-12 of
    /// its size
    #[arg(long, conflicts_with_all = ["q", "pose"])]
    pub continuous: bool,
    /// How to look for collisions; the answer is the same
    #[arg(long, value_enum, default_value_t = Method::Certified)]
    pub method: Method,
    /// List just one colliding pair of each q (with --continuous: the first to meet)
    #[arg(long, conflicts_with = "limit")]
    pub first: bool,
    /// List at most so many colliding pairs of each q (with --continuous: the first to meet); then count is a lower
    /// bound
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Also write the shape at --q, with its colliding triangles marked: .ply (red) or .obj (in groups)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["trajectory", "first", "limit"])]
    pub pose: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

/// Where to look.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
pub struct At {
    /// Reduced coordinates, one q in each row: .npy of shape (T, r), or (r)
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// One q: r numbers
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', allow_hyphen_values = true)]
    pub q: Option<Vec<f64>>,
}

/// Methods of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Certificates, then lazily updated boxes
    Certified,
    /// Lazily updated boxes without certificates
    #[value(name = "bdtree")]
    BdTree,
    /// All boxes refitted
    Traditional,
    /// The same with normal cones and the contour test
    NormalCones,
    /// Every pair of triangles
    BruteForce,
}

/// `sscc audit`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc audit spring.model.safetensors --certificates spring.sscc.safetensors --samples 2000"
    ),
    after_help = "\
Exit codes: 0 nothing found, 1 a certificate promises too much, 2 error."
)]
pub struct Audit {
    #[command(flatten)]
    pub model: Model,
    /// The certificates to attack
    #[arg(long, value_name = "FILE")]
    pub certificates: PathBuf,
    /// Number of configurations to try
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// Start of the pseudo-random numbers: the same seed makes the same attacks
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
    )
)]
pub struct Info {
    /// A model (*.model.safetensors, .glb, .gltf, .npz), certificates (*.sscc.safetensors), a mesh (.obj, .off, .ply,
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
The folder gets trajectories.npz, costs.npz, animation.glb, summary.json, report.html and, of scenes with sound, \
sound.wav and sound_float.wav. A simulation that was stopped or killed goes on by the same command, to the same bits.\n\
Scenes that come with the program: spring, bunny16, bunny128, dragon-nonlinear, dragon-polynomial.\n\
Exit codes: 0 done, 2 error or the motion diverged (what was simulated until then is written), 130 interrupted."
)]
pub struct Simulate {
    /// The scene: a .toml file, or the name of one that comes with the program
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The folder to write to, made where it is missing [default: the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How many steps to make from the beginning [default: those of the scene]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,
    /// Begin again, whatever the folder holds
    #[arg(long)]
    pub restart: bool,
    /// The folder of bunny_14964_closed.obj and dragon_77202_closed.ply [default: SSCC_MODELS; without it embedded
    /// shapes stand in]
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// Where models and certificates are kept from one run to the next [default: sscc in the system's cache folder]
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
All methods answer the same questions by turns, on one thread, and must list the same pairs.\n\
Exit codes: 0 done, 2 error, or two exact methods differ."
)]
pub struct Bench {
    /// What to measure; --list tells what there is
    #[arg(value_name = "SCENARIO", required_unless_present = "list")]
    pub scenario: Option<String>,
    /// List the scenarios
    #[arg(long)]
    pub list: bool,
    /// The folder of bunny_14964_closed.obj and dragon_77202_closed.ply [default: SSCC_MODELS; without it embedded
    /// shapes stand in]
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// Of scenes and kinetic: steps to measure, in 10 blocks spread evenly [default: 100, kinetic 20,000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,
    /// Of amplitudes and growth: samples at each amplitude [default: 64, growth 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: Option<u32>,
    /// Of amplitudes and growth: this model alone
    #[arg(long, value_name = "MODEL")]
    pub only: Option<String>,
    /// Take a spring of 4,000 triangles for every model: whether all works, in seconds
    #[arg(long)]
    pub quick: bool,
    /// Of growth: also draw it
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Also write what was measured as a page, in one file; of scenes, amplitudes and growth
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Where models and certificates are kept from one run to the next [default: sscc in the system's cache folder]
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
The page is on this machine alone, at an address that nobody can guess, and works offline. It is there until Ctrl-C or SIGTERM.\n\
The metric and the other options come from the certificates; a flag that contradicts them is refused."
)]
pub struct View {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    /// The port of the address [default: any that is free]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub port: Option<u16>,
    /// Only print the address, and open no browser
    #[arg(long)]
    pub no_open: bool,
    /// Of models that know their stiffness: also draw how far the root's certificate reaches under the energy and the
    /// displacement metric, with ever more modes; certificates are computed for each of them first
    #[arg(long)]
    pub compare_metrics: bool,
    #[command(flatten)]
    pub options: Options,
}

/// The form of the result.
#[derive(Clone, Copy, Debug, Args)]
pub struct Json {
    /// Print the result alone, as JSON
    #[arg(long)]
    pub json: bool,
}

fn parse_epsilon(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(epsilon) if epsilon > 0.0 && epsilon < 1.0 => Ok(epsilon),
        _ => Err("a number between 0 and 1 was expected".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    /// The examples of every page of help are commands that there are, with flags that there are.
    #[test]
    fn examples_are_parsed() {
        let mut command = Cli::command();
        command.build();
        let mut pages = vec![command.render_long_help().to_string()];
        pages.extend(command.get_subcommands_mut().map(|page| page.render_long_help().to_string()));
        let mut count = 0;
        for example in
            pages.iter().flat_map(|page| page.lines()).filter_map(|line| line.strip_prefix("  sscc "))
        {
            let words = example.split(" | ").next().unwrap_or_default().split_whitespace();
            let parsed = Cli::try_parse_from(["sscc"].into_iter().chain(words));
            assert!(parsed.is_ok(), "sscc {example}: {}", parsed.unwrap_err());
            count += 1;
        }
        assert!(count >= 30, "{count} examples");
    }

    #[test]
    fn a_q_may_begin_with_a_minus() {
        let cli = Cli::try_parse_from(["sscc", "check", "m", "--q=-1,2.5e-3"]).unwrap();
        let Command::Check(check) = cli.command else { panic!("{cli:?}") };
        assert_eq!(check.at.q.unwrap(), [-1.0, 2.5e-3]);
        assert!(Cli::try_parse_from(["sscc", "check", "m"]).is_err());
        assert!(Cli::try_parse_from(["sscc", "check", "m", "--q=1", "--trajectory", "q.npy"]).is_err());
    }
}
