//! Precomputation of all certificates, bottom-up: `R_n = min(R_global, R of the children, R_nm of the children's
//! pairs)` (paper, section 5.2). Small nodes are searched as wholes, and what lies in them gets their radius: no
//! discrete or continuous query looks into them.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::certificates::build::pair_tree_builder::{Frontier, Grove};
use crate::certificates::build::search::Precision;
use crate::certificates::build::task::{Here, NodeTask, Prepared, Solver};
use crate::certificates::pair_tree::Entry;
use crate::certificates::{CertificateParts, CertifyOptions, PairTree};
use crate::hierarchy::Node;
use crate::threads::on_threads;
use crate::{Error, Progress, ReducedModel};

pub(in crate::certificates) fn compute(
    model: &ReducedModel,
    options: &CertifyOptions,
    progress: &dyn Progress,
) -> Result<CertificateParts, Error> {
    on_threads(options.threads, || {
        let prepared = Prepared::new(model, options, progress)?;
        let mut here = Here { prepared: &prepared, progress };
        let radii = Radii::compute(&prepared, options.budget, &mut here, progress)?;
        Ok(radii.of(prepared))
    })
}

/// What is computed, stage by stage.
pub(in crate::certificates) struct Radii {
    nodes: Vec<f64>,
    root_pairs: Vec<f64>,
    pair_tree: PairTree,
}

impl Radii {
    /// All radii, and a pair tree of so many bytes a triangle.
    pub(in crate::certificates) fn compute(
        prepared: &Prepared,
        budget: usize,
        solver: &mut dyn Solver,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let hierarchy = &prepared.hierarchy;
        let budget = budget.saturating_mul(hierarchy.order().len()) / size_of::<Entry>();
        let grove = Grove::grow(hierarchy, prepared.global_radius, budget, solver)?;
        let mut work = Work::new(prepared, &grove, progress);
        let upper = work.pass(Precision::Rough, f64::INFINITY, solver)?;
        let upper = upper.min(work.upper_of_root(solver)?);
        // Then precisely those that may be below what was learnt of the root's.
        work.pass(Precision::Full, upper, solver)?;
        work.tally.finish()?;
        let Work { nodes, root_pairs, .. } = work;
        let pair_tree = grove.harvest(hierarchy, &nodes);
        Ok(Self { nodes, root_pairs, pair_tree })
    }

    /// The certificates of the model that was prepared.
    pub(in crate::certificates) fn of(self, prepared: Prepared) -> CertificateParts {
        let Prepared { digest, scope, hierarchy, global_radius, rest_collisions, epsilon, .. } = prepared;
        CertificateParts {
            digest,
            scope,
            rest_collisions,
            hierarchy,
            epsilon,
            global_radius,
            node_radii: self.nodes,
            root_pair_radii: self.root_pairs,
            pair_tree: self.pair_tree,
        }
    }
}

/// The radii so far.
struct Work<'a> {
    prepared: &'a Prepared,
    grove: &'a Grove,
    tally: Tally<'a>,
    nodes: Vec<f64>,
    root_pairs: Vec<f64>,
}

impl<'a> Work<'a> {
    fn new(prepared: &'a Prepared, grove: &'a Grove, progress: &'a dyn Progress) -> Self {
        let nodes = prepared.hierarchy.nodes();
        let (count, pairs) = (nodes.len(), nodes[0].child_pairs().count());
        let tally = Tally::new(progress, 2 * (count + pairs));
        Self { prepared, grove, tally, nodes: vec![0.0; count], root_pairs: vec![0.0; pairs] }
    }

    /// Computes the radii of all nodes that are below a limit; roughly, growing has told some of them. Gives the smallest
    /// upper bound that was met of any, if one was.
    ///
    /// Nodes of one level are independent of each other: level by level from the leaves, each result
    /// depends only on the model, whoever solves the tasks.
    fn pass(&mut self, precision: Precision, below: f64, solver: &mut dyn Solver) -> Result<f64, Error> {
        let hierarchy = &self.prepared.hierarchy;
        let nodes = hierarchy.nodes();
        let within_small = hierarchy.nodes_within_buckets();
        let mut upper = f64::INFINITY;
        let mut take = |radius: &mut f64, (better, met): (f64, f64)| {
            *radius = radius.max(better);
            upper = upper.min(met);
        };
        for level in hierarchy.levels().into_iter().rev() {
            if level.start == 0 && !nodes[0].is_leaf() {
                continue;
            }
            let wanted = |n: &usize| self.nodes[*n] < below && !within_small[*n];
            let wanted: Vec<usize> = level.clone().filter(wanted).collect();
            self.tally.add(level.len() - wanted.len());
            let task = |at: usize| {
                let node = &nodes[wanted[at]];
                self.task(precision, wanted[at], 0..node.child_pairs().count(), self.least_child(node))
            };
            let found = solver.radii(precision, wanted.len(), &task, &self.tally)?;
            wanted.into_iter().zip(found).for_each(|(n, found)| take(&mut self.nodes[n], found));
        }
        if !nodes[0].is_leaf() {
            // Between the children of the root each pair has a radius of its own.
            let wanted = |at: &usize| self.root_pairs[*at] < below;
            let wanted: Vec<usize> = (0..self.root_pairs.len()).filter(wanted).collect();
            self.tally.add(self.root_pairs.len() - wanted.len() + 1);
            let all = self.prepared.global_radius;
            let task = |at: usize| self.task(precision, 0, wanted[at]..wanted[at] + 1, all);
            let found = solver.radii(precision, wanted.len(), &task, &self.tally)?;
            wanted.into_iter().zip(found).for_each(|(at, found)| take(&mut self.root_pairs[at], found));
            self.nodes[0] = self.root_pairs.iter().copied().fold(self.least_child(&nodes[0]), f64::min);
        }
        // Parents come before their children.
        for (n, node) in nodes.iter().enumerate() {
            for child in node.children().filter(|child| within_small[*child as usize]) {
                self.nodes[child as usize] = self.nodes[n];
            }
        }
        Ok(upper)
    }

    /// An upper bound of the root's radius where that is known from growing alone: as a rule one is met by searching the
    /// pairs of children that it comes from. Infinite if not.
    fn upper_of_root(&self, solver: &mut dyn Solver) -> Result<f64, Error> {
        let nodes = self.prepared.hierarchy.nodes();
        let mut at = 0;
        while let Some(child) = nodes[at].children().find(|n| self.nodes[*n as usize] == self.nodes[0]) {
            at = child as usize;
        }
        if self.grove.is_empty()
            || nodes[at].is_leaf()
            || self.prepared.hierarchy.is_bucket_below_root(at as u32)
        {
            // It was searched, not grown: what upper bounds that met are known.
            return Ok(f64::INFINITY);
        }
        let which = match self.root_pairs.iter().position(|radius| *radius == self.nodes[0]) {
            Some(pair) if at == 0 => pair..pair + 1,
            _ => 0..nodes[at].child_pairs().count(),
        };
        // Farther away than that there is hardly any.
        let cap = self.prepared.global_radius.min(4.0 * self.nodes[0]);
        let task = |_| self.task(Precision::Full, at, which.clone(), cap);
        let found = solver.radii(Precision::Rough, 1, &task, &Tally::new(&(), 1))?;
        Ok(found.into_iter().map(|(_, upper)| upper).fold(f64::INFINITY, f64::min))
    }

    fn least_child(&self, node: &Node) -> f64 {
        let radii = node.children().map(|child| self.nodes[child as usize]);
        radii.fold(self.prepared.global_radius, f64::min)
    }

    /// To find the radius, at most `cap`, of a node or of some pairs of its children. Roughly, what growing has bounded is
    /// known.
    fn task(&self, precision: Precision, node: usize, which: Range<usize>, cap: f64) -> NodeTask {
        let hierarchy = &self.prepared.hierarchy;
        let parent = &hierarchy.nodes()[node];
        let node = node as u32;
        if hierarchy.is_bucket_below_root(node) || parent.is_leaf() {
            // It is searched within, whatever its parts have: they were not.
            let cap = self.prepared.global_radius;
            return NodeTask { node, cap, enough: cap, pairs: Vec::new() };
        }
        let Some(frontier) = self.grove.frontier(hierarchy, node, which.clone(), cap) else {
            let pairs = parent.child_pairs().skip(which.start).take(which.len());
            return NodeTask { node, cap, enough: cap, pairs: pairs.map(|pair| (pair, 0.0)).collect() };
        };
        let Frontier { radius, open, bounded } = frontier;
        match precision {
            Precision::Rough => {
                let pairs = open.into_iter().filter(|(_, lower)| *lower < radius).collect();
                // Without a tree these radii are all that queries have.
                let enough = if self.grove.is_empty() { cap } else { self.prepared.rough_limit() };
                NodeTask { node, cap: radius, enough, pairs }
            }
            Precision::Full => NodeTask { node, cap, enough: cap, pairs: [open, bounded].concat() },
        }
    }
}

/// Steps between two reports.
const REPORT: usize = 64;

/// Counts finished steps, reports them, and skips the rest once the caller has cancelled.
pub(in crate::certificates) struct Tally<'a> {
    progress: &'a dyn Progress,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Tally<'a> {
    fn new(progress: &'a dyn Progress, total: usize) -> Self {
        Self { progress, done: AtomicUsize::new(0), total }
    }

    /// One step, and its results: the radius that promises nothing once the caller has cancelled.
    pub(in crate::certificates) fn step(&self, work: impl FnOnce() -> (f64, f64)) -> (f64, f64) {
        if self.progress.is_cancelled() {
            return (0.0, 0.0);
        }
        let result = work();
        self.add(1);
        result
    }

    /// So many steps are finished.
    pub(in crate::certificates) fn add(&self, count: usize) {
        let before = self.done.fetch_add(count, Ordering::Relaxed);
        if before / REPORT != (before + count) / REPORT {
            self.progress.report(before + count, self.total);
        }
    }

    fn finish(&self) -> Result<(), Error> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        self.progress.report(self.total, self.total);
        Ok(())
    }
}
