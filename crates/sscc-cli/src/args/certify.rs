//! Arguments of `sscc certify`.

use std::path::PathBuf;

use super::model::{Model, Options};
use super::values::Json;
use clap::Args;

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
