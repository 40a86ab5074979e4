//! Precomputation of all certificates, bottom-up: `R_n = min(R_global, R of the children, R_nm of the children's
//! pairs)` (paper, section 5.2). Small nodes are searched as wholes, and what lies in them gets their radius: no
//! discrete or continuous query looks into them.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::global::global_radius;
use super::grow::Grove;
use super::pair_tree::Entry;
use super::search::{Precision, Search};
use super::{CertificateParts, CertifyOptions, Digest, Scope};
use crate::bounds::{ClusterBounds, ScaledModel};
use crate::hierarchy::{Hierarchy, Node};
use crate::metric::check_scaled_modes;
use crate::pairs::PairFilter;
use crate::query::colliding_pairs;
use crate::threads::on_threads;
use crate::{Error, Pair, Progress, ReducedModel};

pub(super) fn compute(
    model: &ReducedModel,
    options: &CertifyOptions,
    progress: &dyn Progress,
) -> Result<CertificateParts, Error> {
    on_threads(options.threads, || compute_here(model, options, progress))
}

/// On the threads of the current pool.
fn compute_here(
    model: &ReducedModel,
    options: &CertifyOptions,
    progress: &dyn Progress,
) -> Result<CertificateParts, Error> {
    if !(options.epsilon > 0.0 && options.epsilon < 1.0) {
        return Err(Error::Option { name: "epsilon", value: options.epsilon, wanted: "between 0 and 1" });
    }
    let metric = options.metric.clone().unwrap_or_else(|| model.metric().clone());
    check_scaled_modes(model.mesh(), model.modes(), &metric)?;
    let rest = vec![0.0; model.rank()];
    let center = options.center.clone().unwrap_or_else(|| rest.clone());
    model.check_coordinates(&center)?;
    let hierarchy = Hierarchy::build(model, &metric);
    let mut rule = options.rule.clone();
    let at_rest = colliding_pairs(model, &hierarchy, &rule, &rest, progress)?;
    let rest_collisions = at_rest.len() as u64;
    let at_center = if center == rest {
        at_rest.clone()
    } else {
        colliding_pairs(model, &hierarchy, &rule, &center, progress)?
    };
    if options.ignore_rest {
        rule = rule.ignoring(at_rest);
    }
    let counts = |pair: &Pair| rule.ignored().binary_search(pair).is_err();
    let mut exceptions: Vec<Pair> = at_center.into_iter().filter(counts).collect();
    let triangles = model.mesh().faces().len();
    if exceptions.len() > options.max_exceptions.unwrap_or(CertifyOptions::default_exceptions(triangles)) {
        exceptions.clear();
    }
    let scope = Scope { metric, center, rule, exceptions };
    let scaled = ScaledModel::new(model, &scope.metric, &scope.center);
    let filter = PairFilter::new(model, &scope.rule).leaving_out(&scope.exceptions);
    let clusters = ClusterBounds::new(&scaled, &hierarchy);
    let global_radius = global_radius(model, &scope.metric, &scope.center);
    let work = Work {
        scaled: &scaled,
        filter: &filter,
        hierarchy: &hierarchy,
        clusters: &clusters,
        options,
        global_radius,
        progress,
    };
    let budget = options.budget.saturating_mul(triangles) / size_of::<Entry>();
    let grove = Grove::grow(&hierarchy, global_radius, budget, || work.search(), progress)?;
    let (node_radii, root_pair_radii) = work.run(&grove)?;
    let pair_tree = grove.harvest(&hierarchy, &node_radii);
    Ok(CertificateParts {
        digest: Digest::of(model, &scope),
        scope,
        rest_collisions,
        hierarchy,
        epsilon: options.epsilon,
        global_radius,
        node_radii,
        root_pair_radii,
        pair_tree,
    })
}

struct Work<'a> {
    scaled: &'a ScaledModel,
    filter: &'a PairFilter,
    hierarchy: &'a Hierarchy,
    clusters: &'a ClusterBounds,
    options: &'a CertifyOptions,
    global_radius: f64,
    progress: &'a dyn Progress,
}

impl Work<'_> {
    /// All radii: first roughly, then precisely those that may be below what was learnt of the root's.
    fn run(&self, grove: &Grove) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let nodes = self.hierarchy.nodes();
        let mut radii = vec![0.0; nodes.len()];
        let mut root_pairs = vec![0.0; child_pairs(&nodes[0]).count()];
        let tally = Tally::new(self.progress, 2 * (nodes.len() + root_pairs.len()));
        let upper = self.pass(Precision::Rough, f64::INFINITY, &mut radii, &mut root_pairs, grove, &tally);
        self.pass(Precision::Full, upper, &mut radii, &mut root_pairs, grove, &tally);
        tally.finish()?;
        Ok((radii, root_pairs))
    }

    /// Computes the radii of all nodes that are below a limit, which also gives an upper bound of the root's.
    ///
    /// Nodes of one level are independent of each other: level by level from the leaves, each result
    /// depends only on the model, whatever the number of threads.
    fn pass(
        &self,
        precision: Precision,
        below: f64,
        radii: &mut [f64],
        root_pairs: &mut [f64],
        grove: &Grove,
        tally: &Tally<'_>,
    ) -> f64 {
        let nodes = self.hierarchy.nodes();
        let within_small = within_small(self.hierarchy);
        let search = || {
            let mut search = self.search();
            search.set_precision(precision);
            search
        };
        let mut upper = f64::INFINITY;
        let mut take = |known: &mut [f64], computed: Vec<(f64, f64)>| {
            for (radius, (better, met)) in known.iter_mut().zip(computed) {
                *radius = radius.max(better);
                upper = upper.min(met);
            }
        };
        for level in self.hierarchy.levels().into_iter().rev().filter(|level| level.start != 0) {
            let one = |search: &mut Search<'_>, n: usize| {
                tally.step(|| {
                    if radii[n] < below && !within_small[n] {
                        (self.node(search, n as u32, &nodes[n], radii, grove), search.upper())
                    } else {
                        (radii[n], f64::INFINITY)
                    }
                })
            };
            let computed = level.clone().into_par_iter().map_init(search, one).collect();
            take(&mut radii[level], computed);
        }
        let root = &nodes[0];
        if root.is_leaf() {
            let mut search = search();
            let radius = tally.step(|| (self.node(&mut search, 0, root, radii, grove), search.upper()));
            take(&mut radii[..1], vec![radius]);
        } else {
            // Between the children of the root each pair has a radius of its own.
            let pairs: Vec<(u32, u32)> = child_pairs(root).collect();
            let one = |search: &mut Search<'_>, at: usize| {
                tally.step(|| {
                    if root_pairs[at] < below {
                        let pair = [pairs[at]];
                        let radius = self.between(search, 0, at..at + 1, pair, self.global_radius, grove);
                        (radius, search.upper())
                    } else {
                        (root_pairs[at], f64::INFINITY)
                    }
                })
            };
            let computed = (0..pairs.len()).into_par_iter().map_init(search, one).collect();
            take(root_pairs, computed);
            radii[0] = self.least_child(root, radii);
            radii[0] = root_pairs.iter().copied().fold(radii[0], f64::min);
        }
        // Parents come before their children.
        for (n, node) in nodes.iter().enumerate() {
            for child in node.children().filter(|child| within_small[*child as usize]) {
                radii[child as usize] = radii[n];
            }
        }
        upper
    }

    fn search(&self) -> Search<'_> {
        let epsilon = self.options.epsilon;
        Search::new(self.scaled, self.filter, self.hierarchy, self.clusters, epsilon, self.progress)
    }

    fn least_child(&self, node: &Node, radii: &[f64]) -> f64 {
        node.children().map(|child| radii[child as usize]).fold(self.global_radius, f64::min)
    }

    fn node(&self, search: &mut Search<'_>, n: u32, node: &Node, radii: &[f64], grove: &Grove) -> f64 {
        if node.is_leaf() || node.is_small() && n != 0 {
            return search.within(n, self.global_radius);
        }
        let cap = self.least_child(node, radii);
        if cap <= 0.0 {
            return 0.0;
        }
        self.between(search, n, 0..child_pairs(node).count(), child_pairs(node), cap, grove)
    }

    /// The radius, at most `cap`, of some pairs of children of a node, given with their places.
    fn between(
        &self,
        search: &mut Search<'_>,
        n: u32,
        which: Range<usize>,
        pairs: impl IntoIterator<Item = (u32, u32)>,
        cap: f64,
        grove: &Grove,
    ) -> f64 {
        // Pairs that the grove does not know are at least what it has reached.
        let known = cap.min(grove.reached());
        let radius = search.among(grove.small(self.hierarchy, n, which, known), known);
        if radius < known || known == cap { radius } else { search.between(pairs, cap) }
    }
}

/// For each node whether it lies in a small one. The root's children never do: they have radii as pairs.
pub(crate) fn within_small(hierarchy: &Hierarchy) -> Vec<bool> {
    let mut within = vec![false; hierarchy.nodes().len()];
    for node in hierarchy.nodes().iter().skip(1).filter(|node| node.is_small()) {
        node.children().for_each(|child| within[child as usize] = true);
    }
    within
}

/// All pairs of children, in the order (0,1), (0,2), ..., (2,3).
pub(crate) fn child_pairs(node: &Node) -> impl Iterator<Item = (u32, u32)> {
    let children = node.children();
    children.clone().flat_map(move |n| (n + 1..children.end).map(move |m| (n, m)))
}

/// Counts finished steps, reports them, and skips the rest once the caller has cancelled.
struct Tally<'a> {
    progress: &'a dyn Progress,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Tally<'a> {
    fn new(progress: &'a dyn Progress, total: usize) -> Self {
        Self { progress, done: AtomicUsize::new(0), total }
    }

    fn step(&self, work: impl FnOnce() -> (f64, f64)) -> (f64, f64) {
        if self.progress.is_cancelled() {
            return (0.0, 0.0);
        }
        let result = work();
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(64) || done == self.total {
            self.progress.report(done, self.total);
        }
        result
    }

    fn finish(&self) -> Result<(), Error> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        self.progress.report(self.total, self.total);
        Ok(())
    }
}
