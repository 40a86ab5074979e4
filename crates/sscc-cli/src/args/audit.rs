//! Arguments of `sscc audit`.

use std::path::PathBuf;

use super::model::{Model, Options};
use super::values::Json;
use clap::Args;

/// `sscc audit`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc audit spring.model.safetensors --certificates spring.sscc.safetensors --samples 2000"
        "sscc audit spring.model.safetensors --certificates spring.sscc.safetensors --exact --samples 2000"
    ),
    after_help = "\
Exit codes: 0 no violation, 1 a certificate is refuted (--exact: a proof does not hold), 2 error."
)]
pub struct Audit {
    #[command(flatten)]
    pub model: Model,
    /// The certificates to attack
    #[arg(long, value_name = "FILE")]
    pub certificates: PathBuf,
    /// Number of configurations to test; with --exact, number of entries to prove
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// Seed of the pseudo-random numbers; the same seed gives the same configurations, or with --exact the same entries
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Instead of attacks, prove --samples of the entries into which all pairs of triangles are divided. A checker that
    /// shares no code with the computation of certificates checks the proof in exact arithmetic
    #[arg(long)]
    pub exact: bool,
    #[command(flatten)]
    pub options: Options,
    #[command(flatten)]
    pub json: Json,
}
