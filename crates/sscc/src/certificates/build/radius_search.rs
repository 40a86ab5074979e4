//! Best-first search for the smallest radius among many triangle pairs (paper, section 5.2).
//!
//! A queue holds node pairs and triangle pairs by their lower bounds. The one with the smallest bound is refined: a
//! node pair is split, two leaves become their triangle pairs, a triangle pair is subdivided. The search ends when the
//! smallest remaining lower bound is within the tolerance of the smallest upper bound found. The result depends on the
//! sets searched and the goal alone, never on earlier searches.

use std::collections::BinaryHeap;

use super::leaf_bounds::{BoundedTriangles, LeafBounds};
use super::radius_bound::{BoundedNodePair, RadiusBound};
use super::radius_search_context::RadiusSearchContext;
use super::search_goal::{
    COARSE_EPSILON, COARSE_SUBDIVISIONS, FINE_EPSILON, FINE_SUBDIVISIONS, FINE_TRIANGLE_PAIRS,
    FULL_SUBDIVISIONS, PAIR_TREE_EPSILON, Precision, SearchGoal,
};
use crate::bounds::{NodePairScratch, PairRefiner, RefinementTarget};
use crate::filter::SimplexPair;
use crate::hierarchy::NodePair;
use crate::min_heap::MinHeapEntry;
use crate::{Pair, Progress};

/// The maximum number of candidates in the queue, beside those of the current pair. Beyond it the search continues depth first,
/// in constant memory.
const MAX_QUEUED: usize = 1 << 20;

/// Two nodes whose triangle pairs have not been listed, or one triangle pair. At equal lower bounds triangle pairs are taken
/// before nodes, and smaller indices before larger ones.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Candidate {
    Triangles(u32, u32),
    Nodes(u32, u32),
}

/// Searches radii of one model; owns the scratch memory for it.
pub(crate) struct RadiusSearch<'a> {
    context: RadiusSearchContext<'a>,
    epsilon: f64,
    refiner: PairRefiner<'a>,
    scratch: NodePairScratch,
    leaves: LeafBounds<'a>,
    triangle_pairs: Vec<BoundedTriangles>,
    queue: BinaryHeap<MinHeapEntry<Candidate>>,
    target: RefinementTarget,
    /// The number of triangle pairs that may still be subdivided.
    triangle_pairs_left: usize,
    /// The smallest certified radius among the pairs that need no more refinement.
    certified: f64,
    /// The triangle pair with the smallest upper bound.
    closest: Option<Pair>,
    progress: &'a dyn Progress,
}

impl<'a> RadiusSearch<'a> {
    pub(crate) fn new(context: RadiusSearchContext<'a>, epsilon: f64, progress: &'a dyn Progress) -> Self {
        Self {
            context,
            epsilon,
            refiner: PairRefiner::new(context.model),
            scratch: NodePairScratch::new(context.model.row_len),
            leaves: LeafBounds::new(context),
            triangle_pairs: Vec::new(),
            queue: BinaryHeap::new(),
            target: RefinementTarget { cap: 0.0, upper: f64::INFINITY, epsilon, subdivisions: 0 },
            triangle_pairs_left: 0,
            certified: 0.0,
            closest: None,
            progress,
        }
    }

    /// Returns the triangle pair for which the last search found its smallest upper bound.
    pub(crate) fn closest(&self) -> Option<Pair> {
        self.closest
    }

    /// Returns a certified lower bound for all triangle pairs between two nodes that count, from the nodes alone; a bound of at
    /// least `refine_up_to` is not improved. Infinite if no pair counts by its groups.
    pub(crate) fn bound_nodes(&mut self, (n, m): NodePair, refine_up_to: f64) -> f64 {
        if !self.context.groups.can_count(self.context.filter, (n, m)) {
            return f64::INFINITY;
        }
        self.context.nodes.bound(self.context.model, n, m, refine_up_to, &mut self.scratch)
    }

    /// Searches the radius of all triangle pairs between the two nodes of each given pair. None if cancelled.
    pub(crate) fn between(&mut self, pairs: Vec<BoundedNodePair>, goal: SearchGoal) -> Option<RadiusBound> {
        self.start(goal);
        // All are added at once, because building a heap takes linear time.
        let mut queued = std::mem::take(&mut self.queue).into_vec();
        let bounded = pairs.iter().filter(|pair| pair.lower > 0.0);
        queued.extend(bounded.map(|pair| {
            let (n, m) = pair.nodes;
            MinHeapEntry::new(pair.lower, Candidate::Nodes(n, m))
        }));
        self.queue = queued.into();
        for pair in pairs.into_iter().filter(|pair| pair.lower <= 0.0) {
            self.add_nodes(pair.nodes, 0.0);
        }
        self.run()
    }

    /// Searches the radius, at most `cap`, of all triangle pairs between two nodes, without subdivision. Its tolerance is
    /// [`PAIR_TREE_EPSILON`], or that of the options if that is larger; it is not that of [`Precision::Coarse`]. None if cancelled.
    pub(crate) fn between_without_subdivision(&mut self, nodes: NodePair, cap: f64) -> Option<RadiusBound> {
        self.start(SearchGoal::new(cap, Precision::Full));
        self.target =
            RefinementTarget { epsilon: self.epsilon.max(PAIR_TREE_EPSILON), subdivisions: 0, ..self.target };
        self.add_nodes(nodes, 0.0);
        self.run()
    }

    /// Searches the radius of all triangle pairs within a node. None if cancelled.
    ///
    /// Each child is searched first: the radius of one is the cap of the next.
    pub(crate) fn within(&mut self, n: u32, goal: SearchGoal) -> Option<RadiusBound> {
        let node = &self.context.hierarchy.nodes()[n as usize];
        let (mut children, mut closest) = (RadiusBound { radius: goal.cap, upper: f64::INFINITY }, None);
        for child in node.children() {
            let bound = self.within(child, SearchGoal { cap: children.radius, ..goal })?;
            if bound.radius < children.radius {
                (children.radius, closest) = (bound.radius, self.closest);
            }
            children.upper = children.upper.min(bound.upper);
        }
        self.start(SearchGoal { cap: children.radius, ..goal });
        if node.is_leaf() {
            self.add_triangles((n, n), 0.0);
        } else {
            node.child_pairs().for_each(|nodes| self.add_nodes(nodes, 0.0));
        }
        let own = self.run()?;
        if own.radius >= children.radius {
            self.closest = closest;
        }
        Some(RadiusBound { radius: own.radius, upper: own.upper.min(children.upper) })
    }

    fn start(&mut self, goal: SearchGoal) {
        self.queue.clear();
        let (epsilon, subdivisions) = match goal.precision {
            Precision::Coarse => (self.epsilon.max(COARSE_EPSILON), COARSE_SUBDIVISIONS),
            Precision::Fine => (self.epsilon.min(FINE_EPSILON), FINE_SUBDIVISIONS),
            Precision::Full => (self.epsilon, FULL_SUBDIVISIONS),
        };
        let cap = goal.cap.min(goal.refine_up_to);
        self.target = RefinementTarget { cap, upper: f64::INFINITY, epsilon, subdivisions };
        self.triangle_pairs_left =
            if goal.precision == Precision::Fine { FINE_TRIANGLE_PAIRS } else { usize::MAX };
        self.certified = goal.cap;
        self.closest = None;
    }

    /// Refines the candidate with the smallest lower bound until none can lower the result by more than epsilon, or the
    /// candidate is a triangle pair and no more of these may be subdivided. None if cancelled.
    fn run(&mut self) -> Option<RadiusBound> {
        let radius = loop {
            let Some(MinHeapEntry { key: lower, order: candidate, .. }) = self.queue.pop() else {
                break self.certified;
            };
            if self.progress.is_cancelled() {
                return None;
            }
            let has_ended = matches!(candidate, Candidate::Triangles(..)) && self.triangle_pairs_left == 0;
            if has_ended || lower >= self.refine_up_to() {
                break with_mutant!(lower.min(self.certified), OpenTrianglesForgotten, self.certified);
            }
            self.refine(candidate, lower);
            if self.certified <= 0.0 {
                break 0.0;
            }
        };
        Some(RadiusBound { radius, upper: self.target.upper })
    }

    /// Returns the lower bound from which on a candidate cannot lower the result by more than epsilon.
    fn refine_up_to(&self) -> f64 {
        self.target.sufficient().min(self.certified)
    }

    /// Bounds two nodes and queues them if they can lower the result. `inherited` is a lower bound of a pair that contains this
    /// one.
    fn add_nodes(&mut self, nodes: NodePair, inherited: f64) {
        let lower = self.bound_nodes(nodes, self.refine_up_to()).max(inherited);
        self.add(Candidate::Nodes(nodes.0, nodes.1), lower);
    }

    /// Bounds the triangle pairs between two leaves, or within one, and queues those that can lower the result.
    fn add_triangles(&mut self, leaves: NodePair, inherited: f64) {
        let (n, m) = leaves;
        let dir = if n == m { None } else { self.context.nodes.direction(n, m, &mut self.scratch) };
        self.leaves.load(leaves, dir, self.certified);
        let closest = self.leaves.refine(&mut self.refiner, &mut self.target, self.certified);
        self.closest = closest.or(self.closest);
        let mut pairs = std::mem::take(&mut self.triangle_pairs);
        pairs.extend(self.leaves.triangle_pairs());
        for BoundedTriangles { triangles: (a, b), lower } in pairs.drain(..) {
            self.add(Candidate::Triangles(a, b), lower.max(inherited));
        }
        self.triangle_pairs = pairs;
    }

    /// Queues a candidate that can lower the result. If the queue is full, refines it at once.
    fn add(&mut self, candidate: Candidate, lower: f64) {
        if lower >= self.certified {
            return;
        }
        if self.queue.len() < MAX_QUEUED {
            self.queue.push(MinHeapEntry::new(lower, candidate));
        } else if lower < self.refine_up_to() {
            self.refine(candidate, lower);
        } else {
            self.certified = lower;
        }
    }

    fn refine(&mut self, candidate: Candidate, lower: f64) {
        match candidate {
            Candidate::Triangles(a, b) => self.refine_triangles((a, b), lower),
            Candidate::Nodes(n, m) => self.split_nodes((n, m), lower),
        }
    }

    /// Refines a triangle pair by subdivision, as far as it can lower the result.
    fn refine_triangles(&mut self, (a, b): Pair, lower: f64) {
        let upper = self.target.upper;
        self.triangle_pairs_left = self.triangle_pairs_left.saturating_sub(1);
        for SimplexPair { a: x, b: y } in self.context.filter.simplex_pairs(a, b) {
            // A larger bound than the certified radius would not change the result.
            let cap = self.target.cap.min(self.certified);
            let mut target = RefinementTarget { cap, ..self.target };
            let refined = self.refiner.refine(x, y, &mut target);
            self.target.upper = target.upper;
            self.certified = self.certified.min(refined.max(lower));
        }
        if self.target.upper < upper {
            self.closest = Some((a, b));
        }
    }

    /// Splits the node with the larger box, or two leaves into their triangle pairs.
    fn split_nodes(&mut self, (n, m): NodePair, lower: f64) {
        let RadiusSearchContext { hierarchy, nodes, .. } = self.context;
        let (node_n, node_m) = (&hierarchy.nodes()[n as usize], &hierarchy.nodes()[m as usize]);
        if node_n.is_leaf() && node_m.is_leaf() {
            return self.add_triangles((n, m), lower);
        }
        let is_larger = nodes.size(n) >= nodes.size(m);
        if node_m.is_leaf() || (!node_n.is_leaf() && is_larger) {
            node_n.children().for_each(|child| self.add_nodes((child, m), lower));
        } else {
            node_m.children().for_each(|child| self.add_nodes((n, child), lower));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::certificates::build::Preparation;
    use crate::test_models::square;
    use crate::{CertifyOptions, Metric, Modes, ReducedModel, TriMesh};

    /// One large triangle above a sheet, which it reaches at |z| = 1: a leaf whose box is larger than those of inner nodes.
    #[test]
    fn pairs_of_a_leaf_and_a_smaller_inner_node_are_searched() {
        let sheet = square(8);
        let n = sheet.rest_positions().len() as u32;
        let corners = [[-50.0, -50.0], [150.0, -50.0], [-50.0, 150.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
        let (positions, large) = ([sheet.rest_positions(), &corners].concat(), sheet.faces().len() as u32);
        let faces = [sheet.faces(), &[[n, n + 1, n + 2]]].concat();
        let modes = (0..n + 3).map(|v| if v < n { DVec3::ZERO } else { DVec3::NEG_Z }).collect();
        let (mesh, modes) = (TriMesh::new(positions, faces).unwrap(), Modes::new(1, modes).unwrap());
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
        let preparation = Preparation::new(&model, &CertifyOptions::default(), &()).unwrap();
        let hierarchy = &preparation.hierarchy;
        let mut search = preparation.search(&());
        let has_large = |n: &u32| hierarchy.triangles(&hierarchy.nodes()[*n as usize]).contains(&large);
        let (leaves, inner): (Vec<u32>, Vec<u32>) =
            (0..hierarchy.nodes().len() as u32).partition(|n| hierarchy.nodes()[*n as usize].is_leaf());
        let leaf = leaves.into_iter().find(has_large).unwrap();
        let mut checked = 0;
        for m in inner.into_iter().filter(|n| !has_large(n)) {
            assert!(search.context.nodes.size(leaf) > search.context.nodes.size(m));
            for nodes in [(leaf, m), (m, leaf)] {
                let goal = SearchGoal::new(10.0, Precision::Full);
                let bound = search.between(vec![BoundedNodePair::unbounded(nodes)], goal).unwrap();
                assert!((0.8..=1.0).contains(&bound.radius), "{nodes:?}: {}", bound.radius);
                checked += 1;
            }
        }
        assert!(checked > 3, "{checked}");
    }
}
