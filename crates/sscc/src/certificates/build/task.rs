//! Tasks: the units of work from which certificates are computed, and the one function that runs them.
//!
//! The tasks of a stage are independent of each other, and a result depends on its task and on the model and options
//! alone. So it does not matter which executor runs a task, or in which order.

use super::bvtt::BvttPair;
use super::preparation::Preparation;
use super::radius_bound::{BoundedNodePair, RadiusBound};
use super::radius_search::RadiusSearch;
use super::search_goal::{Precision, SearchGoal};
use super::split_task::{SplitTask, split};
use crate::{Error, Progress};

/// A unit of work.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Task {
    /// Splits an open pair of the BVTT.
    Split(SplitTask),
    /// Searches the radius of a node, or of some pairs of nodes within it.
    NodeRadius(NodeRadiusTask),
}

/// A radius to search.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NodeRadiusTask {
    /// The node whose radius is searched. A leaf or a bucket is searched as a whole.
    pub(crate) node: u32,
    /// The pairs of nodes to search below any other node. The smallest of their radii is that of the node.
    pub(crate) pairs: Vec<BoundedNodePair>,
    pub(crate) goal: SearchGoal,
}

/// The result of a task.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TaskResult {
    /// The pair itself and the pairs below it; indices refer to this list.
    Split(Vec<BvttPair>),
    NodeRadius(RadiusBound),
}

/// Runs a task in the memory of `search`. None if cancelled.
pub(crate) fn run_task(
    task: Task,
    preparation: &Preparation,
    search: &mut RadiusSearch<'_>,
    progress: &dyn Progress,
) -> Option<TaskResult> {
    match task {
        Task::Split(task) => split(task, preparation, search, progress).map(TaskResult::Split),
        Task::NodeRadius(task) => {
            if progress.is_cancelled() {
                return None;
            }
            task.run(preparation, search).map(TaskResult::NodeRadius)
        }
    }
}

impl NodeRadiusTask {
    /// Creates the task to search all of a leaf or a bucket.
    pub(crate) fn within(node: u32, precision: Precision, cap: f64) -> Self {
        Self { node, pairs: Vec::new(), goal: SearchGoal::new(cap, precision) }
    }

    /// Creates the task to search the pairs between two nodes.
    pub(super) fn between(pair: BoundedNodePair, precision: Precision, cap: f64) -> Self {
        // Both nodes are below the root, which is then no leaf: so `run` searches the pairs.
        Self { node: 0, pairs: vec![pair], goal: SearchGoal::new(cap, precision) }
    }

    fn run(self, preparation: &Preparation, search: &mut RadiusSearch<'_>) -> Option<RadiusBound> {
        let hierarchy = &preparation.hierarchy;
        if hierarchy.nodes()[self.node as usize].is_leaf() || hierarchy.is_bucket_below_root(self.node) {
            search.within(self.node, self.goal)
        } else {
            search.between(self.pairs, self.goal)
        }
    }
}

impl TaskResult {
    /// Returns the number of node pairs that the result adds to the BVTT.
    pub(crate) fn added_pairs(&self) -> usize {
        match self {
            Self::Split(subtree) => subtree.len().saturating_sub(1),
            Self::NodeRadius(_) => 0,
        }
    }

    /// Returns the result of splitting a pair.
    pub(crate) fn into_subtree(self) -> Result<Vec<BvttPair>, Error> {
        match self {
            Self::Split(subtree) => Ok(subtree),
            Self::NodeRadius(_) => Err(other_kind()),
        }
    }

    /// Returns the result of searching a radius.
    pub(crate) fn into_bound(self) -> Result<RadiusBound, Error> {
        match self {
            Self::NodeRadius(bound) => Ok(bound),
            Self::Split(_) => Err(other_kind()),
        }
    }
}

/// Returns the error for an executor that gives results of another kind than its tasks: a defect of this crate.
fn other_kind() -> Error {
    Error::Certificates("a result is of another kind than its task".to_owned())
}
