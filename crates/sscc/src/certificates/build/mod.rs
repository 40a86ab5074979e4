//! The computation of certificates, on the threads of this process or by any other executor.
//!
//! `preparation` computes the input of all tasks. `pair_tree_builder` and `node_radii` create the tasks. An `executor`
//! runs them with `task::run_task`, which searches radii with `radius_search`.

mod bvtt;
mod certify;
mod executor;
mod fine_radii;
mod frontier;
mod global_radius;
mod leaf_bounds;
mod limit_schedule;
mod node_groups;
mod node_radii;
mod node_stages;
mod pair_tree_builder;
mod pair_tree_layout;
mod preparation;
mod progress_counter;
mod radius_bound;
mod radius_search;
mod radius_search_context;
mod search_goal;
mod split_task;
mod task;

pub(crate) use bvtt::{BvttPair, PairState};
pub(crate) use certify::CertifiedRadii;
pub(crate) use executor::{AddedPairLimit, Executor, Stage};
pub use global_radius::is_within_reach;
pub(crate) use node_groups::NodeGroups;
pub(crate) use preparation::Preparation;
pub(crate) use radius_bound::{BoundedNodePair, RadiusBound};
pub(crate) use radius_search::RadiusSearch;
pub(crate) use radius_search_context::RadiusSearchContext;
pub(crate) use search_goal::{Precision, SearchGoal, coarse_cap};
pub(crate) use split_task::SplitTask;
pub(crate) use task::{NodeRadiusTask, Task, TaskResult, run_task};
