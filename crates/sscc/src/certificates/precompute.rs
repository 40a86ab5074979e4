//! Precomputation of all certificates, bottom-up: `R_n = min(R_global, R of the children, R_nm of the children's
//! pairs)` (paper, section 5.2).

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::global::global_radius;
use super::grow::Grove;
use super::pair_tree::Entry;
use super::search::Search;
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
    /// Nodes of one level are independent of each other: level by level from the leaves, each result
    /// depends only on the model, whatever the number of threads.
    fn run(&self, grove: &Grove) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let nodes = self.hierarchy.nodes();
        let mut radii = vec![self.global_radius; nodes.len()];
        let tally = Tally::new(self.progress, nodes.len() + child_pairs(&nodes[0]).count());
        for level in self.hierarchy.levels().into_iter().rev() {
            if level.start == 0 {
                break;
            }
            let computed: Vec<f64> = level
                .clone()
                .into_par_iter()
                .map_init(
                    || self.search(),
                    |search, n| tally.step(|| self.node(search, n as u32, &nodes[n], &radii, grove)),
                )
                .collect();
            radii[level].copy_from_slice(&computed);
        }
        let root = &nodes[0];
        let mut pair_radii = Vec::new();
        if root.is_leaf() {
            radii[0] = self.node(&mut self.search(), 0, root, &radii, grove);
        } else {
            // Between the children of the root each pair has a radius of its own.
            pair_radii = child_pairs(root)
                .collect::<Vec<_>>()
                .into_par_iter()
                .enumerate()
                .map(|(which, pair)| {
                    let which = which..which + 1;
                    tally.step(|| {
                        self.between(&mut self.search(), 0, which, [pair], self.global_radius, grove)
                    })
                })
                .collect();
            radii[0] = self.least_child(root, &radii);
            radii[0] = pair_radii.iter().copied().fold(radii[0], f64::min);
        }
        tally.finish()?;
        Ok((radii, pair_radii))
    }

    fn search(&self) -> Search<'_> {
        let epsilon = self.options.epsilon;
        Search::new(self.scaled, self.filter, self.hierarchy, self.clusters, epsilon, self.progress)
    }

    fn least_child(&self, node: &Node, radii: &[f64]) -> f64 {
        node.children().map(|child| radii[child as usize]).fold(self.global_radius, f64::min)
    }

    fn node(&self, search: &mut Search<'_>, n: u32, node: &Node, radii: &[f64], grove: &Grove) -> f64 {
        let cap = self.least_child(node, radii);
        if cap <= 0.0 {
            return 0.0;
        }
        if node.is_leaf() {
            return search.within_leaf(n, cap);
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

    fn step(&self, work: impl FnOnce() -> f64) -> f64 {
        if self.progress.is_cancelled() {
            return 0.0;
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
