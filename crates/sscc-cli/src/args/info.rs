//! Arguments of `sscc info`.

use std::path::PathBuf;

use super::values::Json;
use clap::Args;

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
    /// .stl) or a solid (.mesh, .veg, .msh, .node, .ele, .vtu, .vtk)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub json: Json,
}
