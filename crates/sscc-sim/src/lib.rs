//! Scenes as a library: models from files and recipes, simulations that continue from checkpoints, and their files;
//! collisions of meshes, frames and animations from files ([`detect`]); certificates with options of which some may be absent
//! ([`CertificateRequest`]).
//!
//! Long work takes a [`sscc::Progress`], or a [`Watch`] if it has several stages. Both can cancel it. The crate prints
//! nothing. One simulation:
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

mod certification;
mod configuration;
mod detection;
mod error;
mod files;
mod groups;
mod left_out;
mod machine;
mod models;
mod named_meshes;
mod nearest;
mod outputs;
mod recipes;
mod resize;
mod resolve;
mod run;
mod scenes;
mod simulate;
mod statics;
mod sweeps;
pub mod text;
mod watch;
mod zero_radius;

pub use certification::{CertificateRequest, Scheme};
pub use configuration::read_configuration;
pub use detection::{
    AnimationMotion, ContactOptions, Detection, DetectionAnswer, MeshMotion, Near, OtherMesh, RowQueries,
    ShapeInMotion, Times, check_rows, detect,
};
pub use error::SimError;
pub use groups::GroupRules;
pub use left_out::{FreeProof, LeftOut, free_sentence};
pub use machine::{PeakMemory, available_threads, machine_description};
pub use models::{
    Components, Fix, MaterialOrigin, ModesKind, NewModel, POLYNOMIAL_MODES_ERROR, SolidFacts, SolidSource,
    elastic_model, has_equal_vertices, is_solid, pca_model, polynomial_model, read_surface,
};
pub use nearest::{did_you_mean, nearest};
pub use outputs::{Outputs, SoundTrack};
pub use recipes::{
    Cache, CertificateCost, CertifiedModel, LoadedRecipe, ModelFiles, ModesSpec, Recipe, SPRING_RINGS, Shape,
    TimedCertificates, models_folder,
};
pub use resize::{Resize, UNITS, longest_side, scaled};
pub use resolve::{ResolveReport, resolve_rows};
pub use run::{
    BodyRecord, FinishedRun, History, ModelSummary, PreparedModel, PreparedScene, RunOutcome, STEP_PARTS,
    StateLayout, StateLog, StepRecord, Summary, TraditionalCost, run,
};
pub use scenes::{
    BodySpec, ModelSpec, OWN_AMPLITUDE_SCENES, SHIPPED, Scene, Shake, ShakeUnit, Sound, read_scene,
};
pub use simulate::{Request, make_folder, simulate};
pub use statics::{StaticAnswer, static_answer};
pub use sweeps::{
    CombinationRow, Combinations, Interval, IntervalRow, SweepRange, SweepRequest, SweepRow,
    combination_table, interval_table, sweep_model, sweep_model_combinations, sweep_model_intervals,
    sweep_table,
};
pub use watch::{Stage, Watch};
pub use zero_radius::ZeroRadius;
