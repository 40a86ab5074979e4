//! Arguments of `sscc demo`.

use std::path::PathBuf;

use super::values::Json;
use clap::Args;

/// `sscc demo`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc demo"
        "sscc demo --out demo"
    ),
    after_help = "Exit codes: 0 done, 2 error or two exact methods differ, 130 interrupted."
)]
pub struct Demo {
    /// Also write the spring, its model, its certificates, the animation and a report to this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub json: Json,
}
