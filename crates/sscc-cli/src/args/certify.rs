//! Arguments of `sscc certify`.

use std::path::PathBuf;

use super::model::{Model, Options};
use super::values::Json;
use clap::Args;
use sscc::Clearance;
use sscc::parts::short_number;

/// `sscc certify`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc certify bunny.model.safetensors -o bunny.sscc.safetensors"
        "sscc certify bunny.model.safetensors -o large.sscc.safetensors --budget 256 --reach 32"
        "sscc certify face.obj --modes face.U.float -o face.sscc.safetensors --metric mass --scheme paper"
        "sscc certify spring.model.safetensors -o near.sscc.safetensors --clearance 0.01 --rings 3"
        "sscc certify spring.model.safetensors -o spring.sscc.safetensors --proof spring.proof --proof-sample 1000"
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
    /// Also write a proof of each radius (.proof): `sscc-checker MODEL CERTIFICATES FILE` checks it in exact arithmetic. Not with
    /// --clearance
    #[arg(long, value_name = "FILE", conflicts_with = "clearance")]
    pub proof: Option<PathBuf>,
    /// With --proof: prove N of the entries into which all pairs of triangles are divided, spread over all [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub proof_sample: Option<u32>,
    #[command(flatten)]
    pub clearance: CertifiedClearance,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}

/// The clearance of certificates.
#[derive(Debug, Args)]
pub struct CertifiedClearance {
    /// Certify the |z| below which no triangles are nearer than this distance (in units of the mesh), in place of the |z| below
    /// which none collide: for check --clearance up to D. Such certificates prove nothing about collisions
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    pub clearance: Option<f64>,
    /// With --clearance: leave out triangles within N rings of each other on the surface: 1 for a common vertex, 2 for a common
    /// neighbour of this kind, and so on [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rings: Option<u32>,
}

impl CertifiedClearance {
    /// Returns the clearance of these arguments.
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub fn of(&self) -> anyhow::Result<Option<Clearance>> {
        clearance(self.clearance, self.rings)
    }
}

/// Returns the clearance of `--clearance` and `--rings`.
///
/// # Errors
/// When it is not positive and finite.
pub fn clearance(distance: Option<f64>, rings: Option<u32>) -> anyhow::Result<Option<Clearance>> {
    let of = |distance: f64| match Clearance::new(distance) {
        Ok(clearance) => Ok(clearance.beyond_rings(rings.unwrap_or(1))),
        Err(_) => {
            anyhow::bail!("--clearance is {}: it must be positive and finite", short_number(distance))
        }
    };
    distance.map(of).transpose()
}
