//! Arguments of `sscc simulate`.

use std::path::PathBuf;

use super::model::Threads;
use super::values::Json;
use clap::Args;

/// `sscc simulate`
#[derive(Debug, Args)]
#[command(
    help_template = with_examples!(
        "sscc simulate spring --out spring"
        "sscc simulate bunny16 --models models/ --out bunnies"
        "sscc simulate bunny16 --models models/ --out bunnies --steps 500"
        "sscc simulate my.toml --json"
    ),
    after_help = "\
The command writes trajectories.npz, costs.npz, animation.glb, summary.json, report.html and, for scenes with sound, \
sound.wav and sound_float.wav. The same command resumes a simulation that was interrupted or killed. The results are \
bit for bit those of an uninterrupted one.\n\
Embedded scenes: spring, spring-gentle, bunny16, bunny16-gentle, bunny128, dragon-nonlinear, dragon-polynomial.\n\
Exit codes: 0 done, 2 error or the motion diverges (the steps before are written), 130 interrupted."
)]
pub struct Simulate {
    /// The scene: a .toml file, or the name of an embedded scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The output folder, created if it is missing [default: the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of steps from the beginning of the scene [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,
    /// Begin again, and remove the files of an earlier simulation from the folder
    #[arg(long)]
    pub restart: bool,
    /// The folder of bunny_14964_closed.obj and dragon_77202_closed.ply [default: SSCC_MODELS; without it embedded
    /// shapes replace them]
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// The folder in which runs share models and certificates [default: sscc in the system's cache folder]
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    #[command(flatten)]
    pub threads: Threads,
    #[command(flatten)]
    pub json: Json,
}
