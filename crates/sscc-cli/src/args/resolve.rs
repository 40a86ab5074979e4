//! Arguments of `sscc resolve`.

use std::path::PathBuf;

use super::check::{At, Only};
use super::model::{Model, Options};
use super::values::Json;
use clap::Args;

/// `sscc resolve`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc resolve spring.model.safetensors --certificates spring.sscc.safetensors --trajectory q.npy"
        "sscc resolve head.glb --q=1,0,0 --json"
    ),
    after_help = "\
Exit codes: 0 every q is resolved, 1 some q is not, 2 error."
)]
pub struct Resolve {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    #[command(flatten)]
    pub at: At,
    #[command(flatten)]
    pub only: Only,
    /// The free q from which the search begins: r numbers, weights by name, or a file [default: the centre]
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub from: Option<String>,
    /// Exceptions, the pairs that collide at the centre, must be free as well
    #[arg(long)]
    pub all: bool,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}
