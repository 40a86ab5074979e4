//! Best-first search for the smallest radius among many triangle pairs (paper, section 5.2).

use std::collections::BinaryHeap;

use crate::Progress;
use crate::bounds::{LeafPair, NodePairBounds, NodePairScratch, PairRefiner, RefinementTarget};
use crate::filter::{Hulls, PairFilter};
use crate::heap::MinFirst;
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;

/// Candidates waiting at the most, beside those of the pair at hand. Beyond it the search goes on depth
/// first, in constant memory.
const WAITING: usize = 1 << 20;

/// How closely radii are searched.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// To [`ROUGH`], where [`FEW`] subdivisions do for that.
    Rough,
    /// To the relative error asked for.
    Full,
}

/// The relative error of rough searches.
pub(crate) const ROUGH: f64 = 0.4;

/// Subdivisions of one triangle pair in rough searches. With none at all the dragon's certificates take 0.8 of the
/// time, and queries by node certificates open 1.2 times as many nodes.
const FEW: usize = 4;

/// Subdivisions of one triangle pair at the most. When they are used up the best lower bound so far
/// stands: still certified, only less tight. Hit in practice only by modes of rank 1 and 2.
const SUBDIVISIONS: usize = 500;

/// The relative error of pairs in the pair tree, as far as it needs no subdivision: there are many, each of little
/// weight.
const ROUGH_PAIR: f64 = 0.25;

/// Directions that all triangle pairs of two leaves are looked at along, beside the first one.
const LOOKS: usize = 3;

/// Two sets of triangles whose pairs are still to be looked at, or one triangle pair. Of two with the same lower bound a
/// triangle pair is taken before nodes, then the one with the smaller index.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Candidate {
    Triangles(u32, u32),
    Nodes(u32, u32),
}

/// Two hulls, at least one pair of which meets where two triangles do, and a lower bound.
struct HullPair {
    triangles: (u32, u32),
    x: [u32; 3],
    y: [u32; 3],
    lower: f64,
    /// Whether the bound is made any better by subdivision only.
    refined: bool,
}

/// Searches triangle pairs of one model; owns its scratch memory.
pub(crate) struct Search<'a> {
    model: &'a ScaledModel,
    filter: &'a PairFilter,
    hierarchy: &'a Hierarchy,
    clusters: &'a NodePairBounds,
    refiner: PairRefiner<'a>,
    scratch: NodePairScratch,
    waiting: BinaryHeap<MinFirst<Candidate>>,
    leaves: LeafPair<'a>,
    pairs: Vec<HullPair>,
    epsilon: f64,
    precision: Precision,
    target: RefinementTarget,
    /// The smallest upper bound of all searches before.
    upper: f64,
    /// The smallest certified radius among the pairs that are settled.
    settled: f64,
    /// The pair for which the smallest upper bound was found.
    hottest: Option<(u32, u32)>,
    progress: &'a dyn Progress,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        model: &'a ScaledModel,
        filter: &'a PairFilter,
        hierarchy: &'a Hierarchy,
        clusters: &'a NodePairBounds,
        epsilon: f64,
        progress: &'a dyn Progress,
    ) -> Self {
        Self {
            model,
            filter,
            hierarchy,
            clusters,
            refiner: PairRefiner::new(model),
            scratch: NodePairScratch::new(model.row),
            waiting: BinaryHeap::new(),
            leaves: LeafPair::new(model),
            pairs: Vec::new(),
            epsilon,
            precision: Precision::Full,
            target: RefinementTarget { cap: 0.0, upper: f64::INFINITY, epsilon, subdivisions: 0 },
            upper: f64::INFINITY,
            settled: 0.0,
            hottest: None,
            progress,
        }
    }

    /// The pair of triangles for which the last search found its smallest upper bound.
    pub(crate) fn hottest(&self) -> Option<(u32, u32)> {
        self.hottest
    }

    /// A certified lower bound for all triangle pairs between two nodes; from `enough` on it is not made better.
    pub(crate) fn bound(&mut self, n: u32, m: u32, enough: f64) -> f64 {
        self.clusters.bound(self.model, n, m, enough, &mut self.scratch)
    }

    /// A certified radius, at most `cap`, for all triangle pairs between the two nodes of each given pair.
    pub(crate) fn between(&mut self, pairs: impl IntoIterator<Item = (u32, u32)>, cap: f64) -> f64 {
        self.among(pairs.into_iter().map(|pair| (pair, 0.0)).collect(), cap, cap)
    }

    /// The same for pairs of which a lower bound is known; 0: not looked at yet. From `enough` on the radius is made no
    /// better.
    pub(crate) fn among(&mut self, pairs: Vec<((u32, u32), f64)>, cap: f64, enough: f64) -> f64 {
        self.start(cap);
        self.target.cap = cap.min(enough);
        let mut waiting = std::mem::take(&mut self.waiting).into_vec();
        let known = pairs.iter().filter(|(_, lower)| *lower > 0.0);
        waiting.extend(known.map(|&((n, m), lower)| MinFirst::new(lower, Candidate::Nodes(n, m))));
        self.waiting = waiting.into();
        for ((n, m), _) in pairs.into_iter().filter(|(_, lower)| *lower <= 0.0) {
            self.consider(n, m, 0.0);
        }
        self.run()
    }

    /// A certified radius, at most `cap`, for all triangle pairs between two nodes, with a larger relative error.
    pub(crate) fn roughly(&mut self, n: u32, m: u32, cap: f64) -> f64 {
        self.start(cap);
        self.target =
            RefinementTarget { epsilon: self.epsilon.max(ROUGH_PAIR), subdivisions: 0, ..self.target };
        self.consider(n, m, 0.0);
        self.run()
    }

    /// Bounds all triangle pairs between two leaves, or within one, without subdivision, as far as they matter.
    fn bound_leaves(&mut self, n: u32, m: u32) {
        let hierarchy = self.hierarchy;
        let [x, y] = [n, m].map(|n| hierarchy.triangles(&hierarchy.nodes()[n as usize]));
        self.leaves.load(x, y);
        let direction = if n == m { None } else { self.clusters.direction(n, m, &mut self.scratch) };
        if let Some(direction) = direction {
            self.leaves.set_direction(direction);
        }
        self.pairs.clear();
        for (i, &a) in x.iter().enumerate() {
            for &b in if n == m { &y[i + 1..] } else { y } {
                for Hulls { a: x, b: y } in self.filter.hulls(a, b) {
                    let lower = direction.map_or(0.0, |_| self.leaves.bound_along_direction(x, y));
                    if lower < self.settled && !self.filter.is_excluded(a, b) {
                        self.pairs.push(HullPair { triangles: (a, b), x, y, lower, refined: false });
                    }
                }
            }
        }
        self.refine_worst();
    }

    /// Refines the pair with the smallest bound until that of a refined one is the smallest.
    fn refine_worst(&mut self) {
        let Self { pairs, leaves, refiner, target, hottest, .. } = self;
        let mut looks = 0;
        let mut least = self.settled;
        loop {
            let enough = target.sufficient().min(least);
            let waiting = pairs.iter_mut().filter(|pair| !pair.refined && pair.lower < enough);
            let Some(worst) = waiting.reduce(|a, b| if b.lower < a.lower { b } else { a }) else { break };
            worst.refined = true;
            let upper = target.upper;
            worst.lower = worst.lower.max(refiner.bound(worst.x, worst.y, target));
            if target.upper < upper {
                *hottest = Some(worst.triangles);
            }
            least = least.min(worst.lower);
            // What it needed may do for the others, too: the direction, or an affine map of all.
            let enough = target.sufficient().min(least);
            let open = |pair: &HullPair| !pair.refined && pair.lower < enough;
            if looks < LOOKS
                && pairs.iter().any(open)
                && let Some(n) = refiner.best_direction()
            {
                leaves.set_direction(n);
                pairs.iter_mut().for_each(|pair| {
                    pair.lower = pair.lower.max(leaves.bound_along_direction(pair.x, pair.y))
                });
            }
            if looks == 0 {
                for pair in pairs.iter_mut().filter(|pair| open(pair)) {
                    pair.lower = pair.lower.max(leaves.bound_by_affine_map(pair.x, pair.y, enough));
                }
            }
            looks += 1;
        }
    }

    /// Takes the triangle pairs between two leaves, or within one, as candidates.
    fn open_leaves(&mut self, n: u32, m: u32, inherited: f64) {
        self.bound_leaves(n, m);
        let pairs = std::mem::take(&mut self.pairs);
        // A bound of two triangles holds for all of their hulls.
        for hulls in pairs.chunk_by(|a, b| a.triangles == b.triangles) {
            let (x, y) = hulls[0].triangles;
            let lower = hulls.iter().map(|hull| hull.lower).fold(f64::INFINITY, f64::min);
            self.keep(Candidate::Triangles(x, y), lower.max(inherited));
        }
        self.pairs = pairs;
    }

    /// A certified radius, at most `cap`, for all triangle pairs within a node.
    ///
    /// Part by part, so that what one gives is all that is asked of the next.
    pub(crate) fn within(&mut self, n: u32, cap: f64) -> f64 {
        let node = &self.hierarchy.nodes()[n as usize];
        let (mut least, mut hottest) = (cap, None);
        for child in node.children() {
            let radius = self.within(child, least);
            if radius < least {
                (least, hottest) = (radius, self.hottest);
            }
        }
        self.start(least);
        if node.is_leaf() {
            self.open_leaves(n, n, 0.0);
        } else {
            node.child_pairs().for_each(|(a, b)| self.consider(a, b, 0.0));
        }
        let radius = self.run();
        if radius >= least {
            self.hottest = hottest;
        }
        radius
    }

    /// Searches nodes, and pairs of them, like this from now on.
    pub(crate) fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
    }

    /// An upper bound of the radius of the whole shape: the smallest that was met so far; infinite if none was.
    pub(crate) fn upper(&self) -> f64 {
        self.upper.min(self.target.upper)
    }

    fn start(&mut self, cap: f64) {
        self.upper = self.upper();
        self.waiting.clear();
        let (epsilon, subdivisions) = match self.precision {
            Precision::Rough => (self.epsilon.max(ROUGH), FEW),
            Precision::Full => (self.epsilon, SUBDIVISIONS),
        };
        self.target = RefinementTarget { cap, upper: f64::INFINITY, epsilon, subdivisions };
        self.settled = cap;
        self.hottest = None;
    }

    /// Takes the candidate with the smallest lower bound until none can lower the result by more than epsilon.
    /// A cancelled search gives 0, the radius that promises nothing.
    fn run(&mut self) -> f64 {
        while let Some(entry) = self.waiting.pop() {
            if self.progress.is_cancelled() {
                return 0.0;
            }
            if entry.key >= self.enough() {
                return entry.key.min(self.settled);
            }
            self.open(entry.tie, entry.key);
            if self.settled <= 0.0 {
                return 0.0;
            }
        }
        self.settled
    }

    /// Candidates whose radius is at least this cannot change the result beyond epsilon.
    fn enough(&self) -> f64 {
        self.target.sufficient().min(self.settled)
    }

    /// Bounds two nodes, part of two with the bound `inherited`, and keeps them if they matter.
    fn consider(&mut self, n: u32, m: u32, inherited: f64) {
        let lower = self.bound(n, m, self.enough()).max(inherited);
        self.keep(Candidate::Nodes(n, m), lower);
    }

    fn keep(&mut self, candidate: Candidate, lower: f64) {
        if lower >= self.settled {
            return;
        }
        if self.waiting.len() < WAITING {
            self.waiting.push(MinFirst::new(lower, candidate));
        } else if lower < self.enough() {
            self.open(candidate, lower);
        } else {
            self.settled = lower;
        }
    }

    fn open(&mut self, candidate: Candidate, lower: f64) {
        match candidate {
            Candidate::Triangles(x, y) => {
                let upper = self.target.upper;
                for Hulls { a: x, b: y } in self.filter.hulls(x, y) {
                    let refined = self.refiner.refine(x, y, &mut self.target);
                    self.settled = self.settled.min(refined.max(lower));
                }
                if self.target.upper < upper {
                    self.hottest = Some((x, y));
                }
            }
            Candidate::Nodes(n, m) => self.open_nodes(n, m, lower),
        }
    }

    /// Splits the larger of two nodes, or two leaves into their triangle pairs.
    fn open_nodes(&mut self, n: u32, m: u32, lower: f64) {
        let hierarchy = self.hierarchy;
        let (node_n, node_m) = (&hierarchy.nodes()[n as usize], &hierarchy.nodes()[m as usize]);
        if node_n.is_leaf() && node_m.is_leaf() {
            return self.open_leaves(n, m, lower);
        }
        let larger = self.clusters.size(n) >= self.clusters.size(m);
        if node_m.is_leaf() || (!node_n.is_leaf() && larger) {
            node_n.children().for_each(|child| self.consider(child, m, lower));
        } else {
            node_m.children().for_each(|child| self.consider(n, child, lower));
        }
    }
}
