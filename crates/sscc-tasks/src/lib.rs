//! Tasks on files as a library: collisions of meshes, frames and animations from files ([`detect`]) and of rows of a
//! model ([`check_rows`]), sweeps ([`sweep_model`]), free configurations near colliding ones ([`resolve_rows`]),
//! certificates by options that may be absent ([`CertificateRequest`]), modes of solids ([`elastic_model`]) and of
//! frames ([`pca_model`]), and models from recipes with a cache ([`CertifiedModel`]).
//!
//! Long work takes a [`sscc::Progress`], or a [`Watch`] where it has several stages, and is cancelled by it. Nothing is
//! printed.

mod certification;
mod configuration;
mod detection;
mod error;
mod folder;
mod groups;
mod left_out;
mod machine;
mod models;
mod named_meshes;
mod nearest;
mod recipes;
mod resize;
mod resolve;
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
pub use error::TaskError;
pub use folder::make_folder;
pub use groups::GroupRules;
pub use left_out::{FreeProof, LeftOut, free_sentence};
pub use machine::{PeakMemory, available_threads, machine_description};
pub use models::{
    Components, Fix, MaterialOrigin, ModesKind, NewModel, POLYNOMIAL_MODES_ERROR, SolidFacts, SolidSource,
    elastic_model, has_equal_vertices, is_solid, pca_model, polynomial_model, read_surface,
};
pub use nearest::{did_you_mean, nearest};
pub use recipes::{
    Cache, CertificateCost, CertifiedModel, LoadedRecipe, ModelFiles, ModesSpec, Recipe, SPRING_RINGS, Shape,
    TimedCertificates, models_folder, vibrations,
};
pub use resize::{Resize, UNITS, longest_side, scaled};
pub use resolve::{ResolveReport, resolve_rows};
pub use statics::{StaticAnswer, static_answer};
pub use sweeps::{
    CombinationRow, Combinations, Interval, IntervalRow, SweepRange, SweepRequest, SweepRow,
    combination_table, interval_table, sweep_model, sweep_model_combinations, sweep_model_intervals,
    sweep_table,
};
pub use watch::{Stage, Watch, check_cancelled};
pub use zero_radius::ZeroRadius;
