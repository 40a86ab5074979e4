//! Arguments of `sscc fit`.

use std::path::PathBuf;

use super::model::Model;
use super::values::Json;
use clap::Args;

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
    /// Positions of all vertices: .npy of shape (V, 3) or (T, V, 3), a .pc2 point cache, deformed .vtu, .vtk or .pvd, or a folder of meshes with the same faces
    #[arg(value_name = "POSITIONS")]
    pub positions: PathBuf,
    /// The q to write: *.npy of shape (r), for several frames (T, r)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub json: Json,
}
