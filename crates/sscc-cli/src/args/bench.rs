//! Arguments of `sscc bench`.

use std::path::PathBuf;

use super::values::Json;
use clap::Args;

/// `sscc bench`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc bench --list"
        "sscc bench amplitudes --models models/"
        "sscc bench figure7 --models models/ --plot figure7.svg"
        "sscc bench amplitudes --only spring --samples 4"
        "sscc bench bunny128 --steps 50 --json"
    ),
    after_help = "\
The methods answer the same queries, interleaved on one thread. Where there are many queries, methods without \
certificates answer a sample of them. All exact methods must list the same pairs.\n\
Exit codes: 0 done, 2 error, or two exact methods differ."
)]
pub struct Bench {
    /// The scenario to measure (--list lists all)
    #[arg(value_name = "SCENARIO", required_unless_present = "list")]
    pub scenario: Option<String>,
    /// List the scenarios
    #[arg(long, conflicts_with_all = ["scenario", "steps", "samples", "only", "quick", "plot", "report"])]
    pub list: bool,
    /// The folder of bunny_14964_closed.obj and dragon_77202_closed.ply [default: SSCC_MODELS; without it embedded
    /// shapes replace them]
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// Scenes and kinetic: steps to measure, in 10 blocks spread evenly [default: 100, kinetic 20,000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,
    /// Amplitudes, mixed, norms and growth: samples of each row [default: 64, mixed 200, norms 50, growth 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: Option<u32>,
    /// Amplitudes, mixed, norms and growth: measure this model only
    #[arg(long, value_name = "MODEL")]
    pub only: Option<String>,
    /// Replace every model by a spring of 4,000 triangles, to test the bench in seconds; not for growth
    #[arg(long)]
    pub quick: bool,
    /// Figures, scenes, growth and norms: also plot the results
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Scenes, amplitudes, mixed, norms and growth: also write the results as a page in one file
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// The folder in which runs share models and certificates [default: sscc in the system's cache folder]
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    #[command(flatten)]
    pub json: Json,
}
