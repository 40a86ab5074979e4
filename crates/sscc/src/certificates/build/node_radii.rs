//! Radii of nodes, bottom-up: `R_n = min(cap, R of the children, R_nm of the children's pairs)` (paper, section
//! 5.2).
//!
//! There are two passes. The first is coarse: it uses the bounds from building the pair tree and searches the rest with
//! few subdivisions, the smallest radii of buckets finely (`fine_radii.rs`); it also yields an upper bound of the root's
//! radius. The second searches every radius that may be below this bound, with the tolerance of the options. A bucket is
//! searched as a whole, and the nodes within it get its radius, because traversals end at buckets.

use std::ops::Range;

use super::executor::{Executor, Stage};
use super::fine_radii::choose_buckets;
use super::frontier::Frontier;
use super::node_stages::{BUCKETS, node_stages};
use super::pair_tree_builder::PairTreeBuilder;
use super::preparation::Preparation;
use super::progress_counter::ProgressCounter;
use super::radius_bound::{BoundedNodePair, RadiusBound};
use super::search_goal::{Precision, SearchGoal, coarse_cap};
use super::task::{NodeRadiusTask, Task, TaskResult};
use crate::hierarchy::Node;
use crate::{Error, Progress};

/// The number of radii that a thread takes at once: each takes long.
const RADIUS_GRAIN: usize = 1;

/// An upper bound of the root's radius is searched up to this many times the coarse radius; farther away there is hardly
/// ever one.
const UPPER_BOUND_REACH: f64 = 4.0;

/// Certified radii of all nodes and of the pairs of the root's children.
pub(super) struct NodeRadii {
    pub(super) nodes: Vec<f64>,
    pub(super) root_pairs: Vec<f64>,
    /// The cap of all radii: the global radius, or the radius up to which the pair tree was built, if that is larger.
    pub(super) cap: f64,
}

impl NodeRadii {
    /// Computes all radii, given the bounds from building the pair tree.
    pub(super) fn compute(
        preparation: &Preparation,
        builder: &PairTreeBuilder,
        executor: &mut dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let nodes = preparation.hierarchy.nodes();
        let (count, pairs) = (nodes.len(), nodes[0].child_pairs().count());
        let counter = ProgressCounter::new(progress, 2 * (count + pairs));
        let global_radius = preparation.global_radius;
        let cap =
            with_mutant!(builder.complete_below.max(global_radius), RadiiCappedBelowTheTree, global_radius);
        let radii = Self { nodes: vec![0.0; count], root_pairs: vec![0.0; pairs], cap };
        let mut passes = Passes { preparation, builder, counter, radii };
        let upper = passes.run(Precision::Coarse, f64::INFINITY, executor)?;
        let upper = upper.min(passes.root_upper_bound(executor)?);
        passes.run(Precision::Full, upper, executor)?;
        passes.counter.finish()?;
        Ok(passes.radii)
    }
}

/// The radii so far, and the input from which they are computed.
struct Passes<'a> {
    preparation: &'a Preparation,
    builder: &'a PairTreeBuilder,
    counter: ProgressCounter<'a>,
    radii: NodeRadii,
}

impl Passes<'_> {
    /// Computes all radii that are below a limit. Returns the smallest upper bound found of any radius.
    ///
    /// The stages are the buckets, then the larger nodes of each level ([`node_stages`]), then the pairs of the root's children.
    fn run(&mut self, precision: Precision, below: f64, executor: &mut dyn Executor) -> Result<f64, Error> {
        let hierarchy = &self.preparation.hierarchy;
        let nodes = hierarchy.nodes();
        let is_in_bucket = hierarchy.nodes_within_buckets();
        self.counter.add(is_in_bucket.iter().filter(|is_in_bucket| **is_in_bucket).count());
        let mut upper = f64::INFINITY;
        let mut take = |radius: &mut f64, bound: RadiusBound| {
            *radius = radius.max(bound.radius);
            upper = upper.min(bound.upper);
        };
        for (index, stage) in node_stages(hierarchy, &is_in_bucket).into_iter().enumerate() {
            let wanted: Vec<usize> = stage.iter().copied().filter(|n| self.radii.nodes[*n] < below).collect();
            self.counter.add(stage.len() - wanted.len());
            let task = |index: usize| {
                let node = &nodes[wanted[index]];
                self.task(precision, wanted[index], 0..node.child_pairs().count(), self.smallest_child(node))
            };
            let bounds = search(executor, wanted.len(), &task, &|count| self.counter.add(count))?;
            wanted.into_iter().zip(bounds).for_each(|(n, bound)| take(&mut self.radii.nodes[n], bound));
            if index == BUCKETS && precision == Precision::Coarse {
                let limit = self.builder.complete_below;
                let chosen = choose_buckets(limit, &stage, &self.radii.nodes, hierarchy);
                let task =
                    |index: usize| NodeRadiusTask::within(chosen[index] as u32, Precision::Fine, limit);
                let bounds = search(executor, chosen.len(), &task, &|_| {})?;
                chosen.iter().zip(bounds).for_each(|(n, bound)| take(&mut self.radii.nodes[*n], bound));
            }
        }
        if !nodes[0].is_leaf() {
            let wanted: Vec<usize> =
                (0..self.radii.root_pairs.len()).filter(|i| self.radii.root_pairs[*i] < below).collect();
            self.counter.add(self.radii.root_pairs.len() - wanted.len() + 1);
            let cap = self.radii.cap;
            let task = |index: usize| self.task(precision, 0, wanted[index]..wanted[index] + 1, cap);
            let bounds = search(executor, wanted.len(), &task, &|count| self.counter.add(count))?;
            wanted.into_iter().zip(bounds).for_each(|(i, bound)| take(&mut self.radii.root_pairs[i], bound));
            let smallest = self.smallest_child(&nodes[0]);
            self.radii.nodes[0] = self.radii.root_pairs.iter().copied().fold(smallest, f64::min);
        }
        // Parents come before their children.
        for (n, node) in nodes.iter().enumerate() {
            for child in node.children().filter(|child| is_in_bucket[*child as usize]) {
                self.radii.nodes[child as usize] = self.radii.nodes[n];
            }
        }
        Ok(upper)
    }

    /// Returns an upper bound of the root's radius, if that radius comes from pairs bounded while building the pair tree:
    /// searching these pairs again usually finds one. Infinite otherwise; then the first pass has found one.
    fn root_upper_bound(&self, executor: &mut dyn Executor) -> Result<f64, Error> {
        let hierarchy = &self.preparation.hierarchy;
        let (nodes, radii) = (hierarchy.nodes(), &self.radii);
        let mut n = 0;
        while let Some(child) = nodes[n].children().find(|n| radii.nodes[*n as usize] == radii.nodes[0]) {
            n = child as usize;
        }
        if self.builder.is_empty() || nodes[n].is_leaf() || hierarchy.is_bucket_below_root(n as u32) {
            return Ok(f64::INFINITY);
        }
        let siblings = match radii.root_pairs.iter().position(|radius| *radius == radii.nodes[0]) {
            Some(pair) if n == 0 => pair..pair + 1,
            _ => 0..nodes[n].child_pairs().count(),
        };
        let cap = self.radii.cap.min(UPPER_BOUND_REACH * radii.nodes[0]);
        let task = |_| {
            // The task includes the bounded pairs, but has the precision of the first pass.
            let mut task = self.task(Precision::Full, n, siblings.clone(), cap);
            task.goal.precision = Precision::Coarse;
            task
        };
        let bounds = search(executor, 1, &task, &|_| {})?;
        Ok(bounds.into_iter().map(|bound| bound.upper).fold(f64::INFINITY, f64::min))
    }

    /// Returns the smallest radius of a node's children, at most the cap.
    fn smallest_child(&self, node: &Node) -> f64 {
        let radii = node.children().map(|child| self.radii.nodes[child as usize]);
        with_mutant!(radii.fold(self.radii.cap, f64::min), RadiusOfPairsAlone, self.radii.cap)
    }

    /// Returns the task to search the radius, at most `cap`, of a node or of some pairs of its children; `siblings` are their
    /// indices among these pairs.
    fn task(&self, precision: Precision, n: usize, siblings: Range<usize>, cap: f64) -> NodeRadiusTask {
        let hierarchy = &self.preparation.hierarchy;
        let node = n as u32;
        if hierarchy.is_bucket_below_root(node) || hierarchy.nodes()[n].is_leaf() {
            // The radii of its parts are not known: they were not searched.
            return NodeRadiusTask::within(node, precision, self.radii.cap);
        }
        let goal = SearchGoal::new(cap, precision);
        let Some(frontier) = self.builder.frontier(hierarchy, n, siblings.clone(), cap) else {
            let pairs = hierarchy.nodes()[n].child_pairs().skip(siblings.start).take(siblings.len());
            return NodeRadiusTask { node, pairs: pairs.map(BoundedNodePair::unbounded).collect(), goal };
        };
        let Frontier { radius, open, bounded } = frontier;
        match precision {
            Precision::Coarse => {
                // Without a pair tree queries have no other radii than these.
                let refine_up_to = if self.builder.is_empty() {
                    cap
                } else {
                    coarse_cap(self.radii.cap, self.preparation.epsilon)
                };
                let pairs = open.into_iter().filter(|pair| pair.lower < radius).collect();
                NodeRadiusTask { node, pairs, goal: SearchGoal { cap: radius, refine_up_to, precision } }
            }
            Precision::Fine | Precision::Full => {
                NodeRadiusTask { node, pairs: [open, bounded].concat(), goal }
            }
        }
    }
}

/// Searches radii as one stage.
fn search(
    executor: &mut dyn Executor,
    count: usize,
    task: &(dyn Fn(usize) -> NodeRadiusTask + Sync),
    on_finished: &(dyn Fn(usize) + Sync),
) -> Result<Vec<RadiusBound>, Error> {
    let task = |index: usize| Task::NodeRadius(task(index));
    let stage = Stage { count, task: &task, grain: RADIUS_GRAIN, max_added_pairs: usize::MAX, on_finished };
    let results = executor.run(&stage)?.unwrap_or_default();
    results.into_iter().map(TaskResult::into_bound).collect()
}
