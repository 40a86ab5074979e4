//! Best-first search for the smallest radius among many triangle pairs (paper, section 5.2).

use std::cmp;
use std::collections::BinaryHeap;

use crate::Progress;
use crate::bounds::{ClusterBounds, ClusterScratch, PairRefiner, ScaledModel, Target, cluster_pair};
use crate::hierarchy::Hierarchy;
use crate::pairs::PairFilter;

/// Candidates waiting at the most, beside those of the pair at hand. Beyond it the search goes on depth
/// first, in constant memory.
const WAITING: usize = 1 << 20;

/// Two sets of triangles whose pairs are still to be looked at, or one triangle pair.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Candidate {
    Triangles(u32, u32),
    Nodes(u32, u32),
}

struct Entry {
    lower: f64,
    candidate: Candidate,
}

/// Smallest lower bound first; triangle pairs before nodes; then by index, so that the order is the same in
/// every run.
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> cmp::Ordering {
        other.lower.total_cmp(&self.lower).then_with(|| other.candidate.cmp(&self.candidate))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == cmp::Ordering::Equal
    }
}

impl Eq for Entry {}

/// Searches triangle pairs of one model; owns its scratch memory.
pub(crate) struct Search<'a> {
    model: &'a ScaledModel,
    filter: &'a PairFilter,
    hierarchy: &'a Hierarchy,
    clusters: &'a ClusterBounds,
    refiner: PairRefiner<'a>,
    scratch: ClusterScratch,
    waiting: BinaryHeap<Entry>,
    epsilon: f64,
    target: Target,
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
        clusters: &'a ClusterBounds,
        epsilon: f64,
        progress: &'a dyn Progress,
    ) -> Self {
        Self {
            model,
            filter,
            hierarchy,
            clusters,
            refiner: PairRefiner::new(model),
            scratch: ClusterScratch::new(model.row),
            waiting: BinaryHeap::new(),
            epsilon,
            target: Target { cap: 0.0, upper: 0.0, epsilon },
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
        cluster_pair(self.clusters, self.model, n, m, enough, &mut self.scratch)
    }

    /// A certified radius, at most `cap`, for all triangle pairs between the two nodes of each given pair.
    pub(crate) fn between(&mut self, pairs: impl IntoIterator<Item = (u32, u32)>, cap: f64) -> f64 {
        self.start(cap);
        for (n, m) in pairs {
            self.consider(Candidate::Nodes(n, m), 0.0);
        }
        self.run()
    }

    /// A certified radius, at most `cap`, for all triangle pairs within a leaf.
    pub(crate) fn within_leaf(&mut self, leaf: u32, cap: f64) -> f64 {
        self.start(cap);
        let triangles = self.hierarchy.triangles(&self.hierarchy.nodes()[leaf as usize]);
        for (i, &x) in triangles.iter().enumerate() {
            for &y in &triangles[i + 1..] {
                self.consider(Candidate::Triangles(x, y), 0.0);
            }
        }
        self.run()
    }

    fn start(&mut self, cap: f64) {
        self.waiting.clear();
        self.target = Target { cap, upper: f64::INFINITY, epsilon: self.epsilon };
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
            if entry.lower >= self.enough() {
                return entry.lower.min(self.settled);
            }
            self.open(entry.candidate, entry.lower);
            if self.settled <= 0.0 {
                return 0.0;
            }
        }
        self.settled
    }

    /// Candidates whose radius is at least this cannot change the result beyond epsilon.
    fn enough(&self) -> f64 {
        self.target.enough().min(self.settled)
    }

    /// Bounds a candidate, part of one with the bound `inherited`, and keeps it if it matters.
    fn consider(&mut self, candidate: Candidate, inherited: f64) {
        let enough = self.enough();
        let lower = match candidate {
            Candidate::Nodes(n, m) => {
                cluster_pair(self.clusters, self.model, n, m, enough, &mut self.scratch)
            }
            Candidate::Triangles(x, y) => {
                let hulls = self.filter.hulls(x, y);
                let least = hulls.map(|(x, y)| self.refiner.estimate(x, y)).fold(f64::INFINITY, f64::min);
                if least < self.settled && self.filter.leaves_out(x, y) {
                    return;
                }
                least // infinite for triangles that never count
            }
        };
        let lower = lower.max(inherited);
        if lower >= self.settled {
            return;
        }
        if self.waiting.len() < WAITING {
            self.waiting.push(Entry { lower, candidate });
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
                for (x, y) in self.filter.hulls(x, y) {
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
            for &x in hierarchy.triangles(node_n) {
                for &y in hierarchy.triangles(node_m) {
                    self.consider(Candidate::Triangles(x, y), lower);
                }
            }
            return;
        }
        let larger = self.clusters.size(n) >= self.clusters.size(m);
        if node_m.is_leaf() || (!node_n.is_leaf() && larger) {
            node_n.children().for_each(|child| self.consider(Candidate::Nodes(child, m), lower));
        } else {
            node_m.children().for_each(|child| self.consider(Candidate::Nodes(n, child), lower));
        }
    }
}
