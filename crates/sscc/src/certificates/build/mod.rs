//! The computation of certificates, on the threads of this process or by any other executor.
//!
//! `prepare` makes what all tasks read; `pair_tree_builder` and `node_radii` make the tasks, stage by stage; an `executor`
//! runs them with `task::run_task`, which searches radii with `search`.

mod bvtt;
mod certify;
mod context;
mod executor;
mod frontier;
mod global_radius;
mod goal;
mod leaf_bounds;
mod limit_schedule;
mod node_radii;
mod pair_tree_builder;
mod pair_tree_layout;
mod prepare;
mod progress_counter;
mod radius_bound;
mod search;
mod split;
mod task;

pub(crate) use bvtt::{BvttPair, PairState};
pub(crate) use certify::CertifiedRadii;
pub(crate) use context::SearchContext;
pub(crate) use executor::{Executor, Room, Stage};
pub(crate) use goal::{Precision, SearchGoal, coarse_cap};
pub(crate) use prepare::Prepared;
pub(crate) use radius_bound::{KnownPair, RadiusBound};
pub(crate) use search::RadiusSearch;
pub(crate) use split::SplitTask;
pub(crate) use task::{NodeRadiusTask, Task, TaskResult, run_task};
