//! Arguments of `sscc modes`.

use std::path::PathBuf;

use super::values::Json;
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use sscc_tasks::UNITS;

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
    /// A triangle mesh (.obj, .off, .ply, .stl), or a solid of tetrahedra and cubes (.mesh, .veg, .msh, .node, .ele,
    /// .vtu, .vtk); for pca a folder of meshes with the same faces (the frames: at most 4,096, or any number of at most 1,365 vertices)
    #[arg(value_name = "SOURCE")]
    pub source: PathBuf,
    /// The model file to write: *.model.safetensors
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How to compute the modes
    #[arg(long, value_enum)]
    pub kind: ModesKind,
    /// Number of modes [default: 20 for linear, 30 for nonlinear; for pca as many as explain 99.9% of the variance; not
    /// for polynomial]
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
    /// box:X0,Y0,Z0,X1,Y1,Z1 in the units of the file; or a file of numbers (.npy, text; VegaFEM's .bou counts from 1)
    /// [default: none; the modes are those of a free body, without its rigid motions; not for polynomial]
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
    factor.ok_or_else(|| "a finite number above 0 was expected".into())
}

/// Kinds of modes that `sscc modes` makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModesKind {
    /// The lowest natural vibrations of a solid (linear modal analysis)
    Linear,
    /// A basis for large deformations (modal derivatives), with the reduced forces of the solid
    Nonlinear,
    /// The 24 quadratic polynomials of the rest position without rigid motions (fewer for special shapes, such as a
    /// sphere); for a solid, or with --solid, --resolution or --material, also the stiffness and reduced forces of the
    /// solid
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
