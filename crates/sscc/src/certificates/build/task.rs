//! The tasks that precomputation consists of, and who solves them.
//!
//! Certificates are computed in stages (`precompute.rs`, `grow.rs`): the tasks of one stage are independent of each
//! other, the next stage depends on their results. A result depends on the task alone, so that it does not matter who
//! solves it: the threads of this process ([`Here`]) or other processes (`shards.rs`).

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::bounds::NodePairBounds;
use crate::certificates::build::node_radii::Tally;
use crate::certificates::build::pair_tree_builder::{Grown, Round, expand};
use crate::certificates::build::search::{Precision, ROUGH, Search};
use crate::certificates::{CertifyOptions, Digest, Scope, build::global_radius::global_radius};
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;
use crate::model::check_scaled_modes;
use crate::query::colliding_pairs;
use crate::{Error, Pair, Progress, ReducedModel};

/// What every task needs to know. Made of the model and the options alone: the same in every process.
pub(in crate::certificates) struct Prepared {
    pub(in crate::certificates) digest: Digest,
    pub(in crate::certificates) scope: Scope,
    pub(in crate::certificates) hierarchy: Hierarchy,
    pub(in crate::certificates) global_radius: f64,
    pub(in crate::certificates) rest_collisions: u64,
    pub(in crate::certificates) epsilon: f64,
    scaled: ScaledModel,
    filter: PairFilter,
    clusters: NodePairBounds,
}

impl Prepared {
    /// On the threads of the current pool.
    pub(in crate::certificates) fn new(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        if !(options.epsilon > 0.0 && options.epsilon < 1.0) {
            return Err(Error::Option { name: "epsilon", value: options.epsilon, wanted: "between 0 and 1" });
        }
        let metric = options.metric.clone().unwrap_or_else(|| model.metric().clone());
        check_scaled_modes(model.mesh(), model.modes(), &metric)?;
        let rest = vec![0.0; model.rank()];
        let center = options.center.clone().unwrap_or_else(|| rest.clone());
        model.check_coordinates(&center)?;
        let mut rule = options.rule.clone();
        let found_at_rest = || {
            let hierarchy = Hierarchy::build(model, &metric);
            let at_rest = colliding_pairs(model, &hierarchy, &rule, &rest, progress);
            (hierarchy, at_rest)
        };
        let ((hierarchy, at_rest), scaled) =
            rayon::join(found_at_rest, || ScaledModel::new(model, &metric, &center));
        let at_rest = at_rest?;
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
        if exceptions.len() > options.max_exceptions.unwrap_or(CertifyOptions::default_exceptions(triangles))
        {
            exceptions.clear();
        }
        let scope = Scope { metric, center, rule, exceptions };
        let (digest, clusters) =
            rayon::join(|| Digest::of(model, &scope), || NodePairBounds::new(&scaled, &hierarchy));
        Ok(Self {
            digest,
            filter: PairFilter::new(model, &scope.rule).excluding(&scope.exceptions),
            clusters,
            global_radius: global_radius(model, &scope.metric, &scope.center),
            rest_collisions,
            epsilon: options.epsilon,
            scope,
            hierarchy,
            scaled,
        })
    }

    /// What is enough of the largest radius of interest beyond what growing the pair tree has bounded: as close as rough
    /// searches come to any other. Most nodes can hardly collide at all; to prove that up to the largest radius took a
    /// sixth of the time of all certificates of the spring.
    pub(in crate::certificates) fn rough_limit(&self) -> f64 {
        self.global_radius * (1.0 - ROUGH.max(self.epsilon))
    }

    pub(in crate::certificates) fn search<'a>(&'a self, progress: &'a dyn Progress) -> Search<'a> {
        Search::new(&self.scaled, &self.filter, &self.hierarchy, &self.clusters, self.epsilon, progress)
    }
}

/// The radius of a node, or of one pair of its children.
pub(in crate::certificates) struct NodeTask {
    /// Searched within, if it is searched as a whole.
    pub(in crate::certificates) node: u32,
    /// More is not asked for.
    pub(in crate::certificates) cap: f64,
    /// From this on, of pairs of nodes, it need not be any closer.
    pub(in crate::certificates) enough: f64,
    /// Otherwise the pairs of nodes whose radius is wanted.
    pub(in crate::certificates) pairs: Vec<KnownPair>,
}

/// Two nodes and a lower bound of their radius; 0: not looked at yet.
pub(in crate::certificates) type KnownPair = ((u32, u32), f64);

impl NodeTask {
    /// The radius, and the smallest upper bound of any radius that the searcher has met.
    pub(in crate::certificates) fn solve(self, prepared: &Prepared, search: &mut Search<'_>) -> (f64, f64) {
        let Self { node, cap, enough, pairs } = self;
        let hierarchy = &prepared.hierarchy;
        let radius = if hierarchy.nodes()[node as usize].is_leaf() || hierarchy.is_bucket_below_root(node) {
            search.within(node, cap)
        } else {
            search.among(pairs, cap, enough)
        };
        (radius, search.upper())
    }
}

/// Solves the tasks of one stage after the other.
pub(in crate::certificates) trait Solver {
    /// What becomes of each open pair ([`expand`]); none where that would be more pairs than there is room for.
    fn grow(&mut self, open: &[Grown], round: Round) -> Result<Option<Vec<Vec<Grown>>>, Error>;

    /// The results of `count` tasks ([`NodeTask::solve`]), which are made when their turn comes.
    fn radii(
        &mut self,
        precision: Precision,
        count: usize,
        task: &(dyn Fn(usize) -> NodeTask + Sync),
        tally: &Tally<'_>,
    ) -> Result<Vec<(f64, f64)>, Error>;
}

/// Pairs that a thread takes at once.
const TOGETHER: usize = 8;

/// The threads of the current pool.
pub(in crate::certificates) struct Here<'a> {
    pub(in crate::certificates) prepared: &'a Prepared,
    pub(in crate::certificates) progress: &'a dyn Progress,
}

impl Solver for Here<'_> {
    fn grow(&mut self, open: &[Grown], round: Round) -> Result<Option<Vec<Vec<Grown>>>, Error> {
        let Self { prepared, progress } = *self;
        let used = AtomicUsize::new(0);
        let one = |search: &mut Search<'_>, pair: &Grown| {
            expand(*pair, round, &prepared.hierarchy, search, &used, progress)
        };
        // Tasks are unequal, so that each thread takes few: what was begun cannot be shared any more.
        let open = open.par_iter().with_max_len(TOGETHER);
        let lists = open.map_init(|| prepared.search(progress), one).collect();
        if progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        Ok((used.load(Ordering::Relaxed) <= round.room).then_some(lists))
    }

    fn radii(
        &mut self,
        precision: Precision,
        count: usize,
        task: &(dyn Fn(usize) -> NodeTask + Sync),
        tally: &Tally<'_>,
    ) -> Result<Vec<(f64, f64)>, Error> {
        let Self { prepared, progress } = *self;
        let search = || {
            let mut search = prepared.search(progress);
            search.set_precision(precision);
            search
        };
        let one = |search: &mut Search<'_>, at| tally.step(|| task(at).solve(prepared, search));
        // These take longer.
        Ok((0..count).into_par_iter().with_max_len(1).map_init(search, one).collect())
    }
}
