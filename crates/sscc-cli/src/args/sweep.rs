//! Arguments of `sscc sweep`.

use std::path::PathBuf;

use super::model::{Model, Options};
use super::values::Json;
use clap::Args;

/// `sscc sweep`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc sweep head.glb"
        "sscc sweep spring.model.safetensors --certificates spring.sscc.safetensors --range=-1,1 --json"
        "sscc sweep face.obj --modes targets/ --ignore-rest --pose poses/"
        "sscc sweep head.glb --ignore-rest=1 --intervals"
        "sscc sweep head.glb --ignore-rest=1 --intervals --report intervals.html"
        "sscc sweep head.glb --combinations"
    ),
    after_help = "\
Each weight goes up and down from its value in --q; the others stay. Free is proven at every weight, not at samples.\n\
Exit codes: 0 every sweep is free to its end (--intervals: no weight has an interval; --combinations: no combination \
has new pairs), 1 otherwise, 2 error."
)]
pub struct Sweep {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    /// The range of every weight [default: 0,1 for morph targets; 3 standard deviations to both sides for principal
    /// components; else the change, to both sides of its start, that moves a vertex by half the AABB's diagonal]
    #[arg(long, value_name = "A,B", allow_hyphen_values = true)]
    pub range: Option<String>,
    /// The weights at the start: r numbers, by name, as in jawOpen=0.5, or a file [default: the centre]
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub q: Option<String>,
    /// Also write the shape at each hit (.ply), its colliding triangles red, to this folder
    #[arg(long, value_name = "DIR")]
    pub pose: Option<PathBuf>,
    /// Find all intervals of each weight over which the shape collides, from the low end of its range to the high one,
    /// with the number of pairs and the largest penetration depth of N samples
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "101", conflicts_with = "pose",
        value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub intervals: Option<u32>,
    /// List the pairs of modes that cause new collisions together: with both at the upper end of their ranges, triangle
    /// pairs collide that are free with each of the two alone
    #[arg(long, conflicts_with_all = ["pose", "intervals"])]
    pub combinations: bool,
    /// Also write a page (.html) with the model, its intervals marked along the sliders, and for each weight that has
    /// intervals the curve of the depth
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}
