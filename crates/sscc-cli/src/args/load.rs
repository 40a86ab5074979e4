//! Arguments of `sscc load`.

use std::path::PathBuf;

use super::model::Model;
use super::values::Json;
use clap::Args;
use glam::DVec3;

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
    /// Add the weight of the body under this acceleration of gravity [without a value: 0,0,-9.81 m/s^2]
    #[arg(long, value_name = "GX,GY,GZ", num_args = 0..=1, require_equals = true, default_missing_value = "0,0,-9.81",
        allow_hyphen_values = true, value_parser = vector)]
    pub gravity: Option<DVec3>,
    /// The q to write: *.npy of shape (r)
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
