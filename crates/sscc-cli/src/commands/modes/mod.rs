//! `sscc modes`: a mesh, a solid or the frames of an animation become a model.

mod elastic;
mod fix;
mod material;
mod pca;
mod source;

use std::cmp::Ordering;

use anyhow::{Context, Result, bail};
use serde::Serialize;
use sscc::{Metric, Modes, ReducedModel, TriMesh};
use sscc_io::{Elasticity, ModelInfo, read_mesh, write_model};
use sscc_modes::polynomial_modes;

use crate::args::{self, ModesKind};
use crate::output::{Output, counted, grouped, length, note};
use crate::{Outcome, interrupt, load};
pub use elastic::{elasticity, of_solid};
pub use material::AskedMaterial;
use pca::Components;
pub use source::{Source, is_solid};

/// Why polynomial modes take neither.
const POLYNOMIALS_ARE_FREE: &str =
    "--rank and --fix: polynomial modes are always all 24, and move every vertex";

#[derive(Serialize)]
struct Report {
    triangles: usize,
    vertices: usize,
    rank: usize,
    /// Tetrahedra and cubes of the solid, its degrees of freedom; none without a solid.
    #[serde(skip_serializing_if = "Option::is_none")]
    elements: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    degrees_of_freedom: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequencies_hz: Option<Vec<f64>>,
    #[serde(flatten)]
    components: Option<Components>,
}

/// A surface with modes, and what else was found.
pub struct Made {
    /// Whether vertices are known to be split along seams.
    pub is_split: bool,
    mesh: TriMesh,
    modes: Modes,
    /// If not given, displacement.
    metric: Option<Metric>,
    elasticity: Option<Elasticity>,
    elements: Option<usize>,
    degrees_of_freedom: Option<usize>,
    frequencies: Option<Vec<f64>>,
    components: Option<Components>,
    provenance: String,
}

impl Made {
    /// Polynomial modes of a surface of that name, without a solid.
    pub fn polynomial(mesh: TriMesh, modes: Modes, name: &str) -> Self {
        Self {
            is_split: false,
            mesh,
            modes,
            metric: None,
            elasticity: None,
            elements: None,
            degrees_of_freedom: None,
            frequencies: None,
            components: None,
            provenance: format!("mesh {name}, polynomial modes"),
        }
    }

    /// The model, and what its file says beside it.
    pub fn into_model(self) -> Result<(ReducedModel, ModelInfo)> {
        let model = match self.metric {
            Some(metric) => ReducedModel::with_metric(self.mesh, self.modes, metric),
            None => ReducedModel::new(self.mesh, self.modes),
        };
        let info = ModelInfo::new("", self.provenance);
        let info = match self.elasticity {
            Some(elasticity) => info.with_elasticity(elasticity),
            None => info,
        };
        Ok((model?, info))
    }
}

pub fn run(args: &args::Modes) -> Result<Outcome> {
    load::check_output(&args.output, ".model.safetensors", &[&args.source])?;
    let in_source = || args.source.display().to_string();
    let made = match args.kind {
        ModesKind::Polynomial if !asks_for_solid(args) => surface_polynomials(args)?,
        ModesKind::Pca => pca::make(args)?,
        _ => elastic::make(args).map_err(|error| load::in_file(error, &args.source))?,
    };
    let (elements, degrees_of_freedom) = (made.elements, made.degrees_of_freedom);
    let (frequencies, components) = (made.frequencies.clone(), made.components.clone());
    let (model, info) = made.into_model().with_context(in_source)?;
    interrupt::check()?;
    write_model(&args.output, &model, &info)?;

    let report = Report {
        triangles: model.mesh().faces().len(),
        vertices: model.mesh().rest_positions().len(),
        rank: model.rank(),
        elements,
        degrees_of_freedom,
        frequencies_hz: frequencies,
        components,
    };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let kind = args.kind.name();
        let (triangles, vertices) = (grouped(report.triangles as u64), grouped(report.vertices as u64));
        let modes = match &report.components {
            None => format!("{} {kind} modes", report.rank),
            Some(Components { frames, explained, .. }) => format!(
                "{} of {frames} frames ({:.2}% of the variance)",
                counted(report.rank as u64, "principal component"),
                100.0 * explained
            ),
        };
        out.line(format_args!("{triangles} triangles, {vertices} vertices, {modes}"))?;
        if let (Some(elements), Some(freedom)) = (report.elements, report.degrees_of_freedom) {
            let elements = counted(elements as u64, "element");
            out.line(format_args!("solid of {elements}, {} degrees of freedom", grouped(freedom as u64)))?;
        }
        match report.frequencies_hz.as_deref() {
            Some([only]) => out.line(format_args!("frequency {} Hz", length(*only)))?,
            Some([first, .., last]) => {
                out.line(format_args!("frequencies from {} to {} Hz", length(*first), length(*last)))?;
            }
            _ => {}
        }
        out.line(format_args!("written: {}", args.output.display()))?;
    }
    out.finish()?;
    if has_equal_vertices(&model) {
        note("some vertices have equal positions and modes, as along seams: certify it with --weld");
    }
    Ok(Outcome::Done)
}

/// Whether `--weld` would join two vertices that triangles have.
fn has_equal_vertices(model: &ReducedModel) -> bool {
    let of = |v: u32| {
        let position = std::iter::once(&model.mesh().rest_positions()[v as usize]);
        position.chain(model.modes().of_vertex(v)).flat_map(|x| x.to_array())
    };
    let mut used = model.mesh().used_vertices().to_vec();
    // No number of a model is NaN.
    let compare = |a: &u32, b: &u32| of(*a).partial_cmp(of(*b)).unwrap_or(Ordering::Equal);
    used.sort_by(compare);
    used.windows(2).any(|pair| compare(&pair[0], &pair[1]) == Ordering::Equal)
}

/// Whether polynomial modes shall know the stiffness of a solid.
fn asks_for_solid(args: &args::Modes) -> bool {
    args.resolution.is_some() || args.material.is_some() || source::is_solid(&args.source)
}

fn surface_polynomials(args: &args::Modes) -> Result<Made> {
    if args.rank.is_some() || args.fix.is_some() {
        bail!(POLYNOMIALS_ARE_FREE);
    }
    let mesh = read_mesh(&args.source)?;
    let modes = polynomial_modes(&mesh).with_context(|| args.source.display().to_string())?;
    Ok(Made::polynomial(mesh, modes, &name(args)))
}

/// The name of the source, without its folder.
fn name(args: &args::Modes) -> String {
    args.source.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
