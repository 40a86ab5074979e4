//! Scenes as a library: simulations that continue from checkpoints, and their files. The models of scenes, and [`Watch`],
//! which follows and cancels long work, are those of `sscc-tasks`. Nothing is printed. One simulation:
//!
//! ```no_run
//! use sscc_sim::{Outputs, Request, simulate};
//!
//! let request = Request { scene: "spring".into(), ..Request::default() };
//! let run = simulate(&request, &())?;
//! println!("{} steps with self-contact", run.summary.colliding_steps);
//! let outputs = Outputs::write(&run);
//! outputs.finish(run)?;
//! # Ok::<(), sscc_sim::SimError>(())
//! ```
//!
//! [`Watch`]: sscc_tasks::Watch

mod error;
mod files;
mod outputs;
mod run;
mod scenes;
mod simulate;

pub use error::SimError;
pub use outputs::{Outputs, SoundTrack};
pub use run::{
    BodyRecord, FinishedRun, History, ModelSummary, PreparedModel, PreparedScene, RunOutcome, STEP_PARTS,
    StateLayout, StateLog, StepRecord, Summary, TraditionalCost, run,
};
pub use scenes::{
    BodySpec, ModelSpec, OWN_AMPLITUDE_SCENES, SHIPPED, Scene, Shake, ShakeUnit, Sound, read_scene,
};
pub use simulate::{Request, simulate};
