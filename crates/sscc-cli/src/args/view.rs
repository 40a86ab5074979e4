//! Arguments of `sscc view`.

use std::path::PathBuf;

use super::model::{Model, Options};
use clap::Args;

/// `sscc view`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc view spring.model.safetensors --certificates spring.sscc.safetensors"
        "sscc view head.glb --no-open --port 8080"
        "sscc view demo/"
        "sscc view spring.model.safetensors --compare-metrics"
        "sscc view spring.model.safetensors --report spring.html --wasm target/npm/sscc"
    ),
    after_help = "\
The server listens on this machine only, and its address contains a random token. The page works offline. Ctrl-C or \
SIGTERM stops the server.\n\
A report is the page as one file, which can be mailed. With --wasm its sliders check every shape, with the network off.\n\
MODEL may be a folder with a report, as written by sscc simulate or sscc demo --out: the page then shows the report, \
and takes no options of models.\n\
The certificates contain the metric, the centre, the neighbours, welding and ignored pairs; a flag that contradicts \
them is refused."
)]
pub struct View {
    #[command(flatten)]
    pub model: Model,
    /// Certificates of this model, from `sscc certify`; without them they are computed first
    #[arg(long, value_name = "FILE")]
    pub certificates: Option<PathBuf>,
    /// Port of the address [default: a free port]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub port: Option<u16>,
    /// Print the address only, and open no browser
    #[arg(long)]
    pub no_open: bool,
    /// Models whose own metric is a diagonal energy metric (sscc modes --kind linear or nonlinear): also plot the largest
    /// deformation that the root certifies under the energy and the displacement metric, over the number of modes;
    /// certificates for each number are computed first
    #[arg(long)]
    pub compare_metrics: bool,
    /// Write the page to this file (.html), and start no server
    #[arg(long, value_name = "FILE", conflicts_with_all = ["port", "no_open"])]
    pub report: Option<PathBuf>,
    /// Folder of the npm package `sscc`: the report checks shapes itself, without a server
    #[arg(long, value_name = "DIR")]
    pub wasm: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
}
