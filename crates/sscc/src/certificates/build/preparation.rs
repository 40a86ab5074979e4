//! The input of all tasks: hierarchy, scope with exceptions, scaled model, bounds of nodes. It depends on the model and
//! the options alone, so every process computes it with the same result.

use std::sync::Arc;

use super::global_radius::{farthest_radius, global_radius};
use super::node_groups::NodeGroups;
use super::radius_search::RadiusSearch;
use super::radius_search_context::RadiusSearchContext;
use crate::arithmetic::check_arithmetic;
use crate::bounds::NodePairBounds;
use crate::certificates::local::compute_local_certificates;
use crate::certificates::{CertifyOptions, Digest, LocalCertificates, Scope, default_exceptions, is_reach};
use crate::detect::{colliding_pairs, near_pairs_of_model};
use crate::filter::{PairFilter, RingPairs};
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::{ScaledModel, check_scaled_modes};
use crate::parallel;
use crate::{Clearance, ContactFilter, DISTANCE_ERROR, Error, Pair, Progress, ReducedModel};

/// The input of all tasks, and the parts of the certificates that need no task.
pub(crate) struct Preparation {
    pub(crate) digest: Digest,
    pub(crate) scope: Scope,
    pub(crate) hierarchy: Arc<Hierarchy>,
    /// The paper's `R_global`.
    pub(crate) global_radius: f64,
    /// The largest radius that the pair tree may reach: [`CertifyOptions::reach`] times the global one.
    pub(crate) farthest: f64,
    pub(crate) rest_collisions: u64,
    pub(crate) epsilon: f64,
    scaled: ScaledModel,
    filter: PairFilter,
    rings: RingPairs,
    nodes: NodePairBounds,
    groups: NodeGroups,
}

impl Preparation {
    /// Prepares a model on the threads of the current pool.
    ///
    /// # Errors
    /// Those of [`Certificates::compute`](crate::Certificates::compute).
    pub(crate) fn new(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        check_arithmetic()?;
        if !(options.epsilon > 0.0 && options.epsilon < 1.0) {
            return Err(Error::Option { name: "epsilon", value: options.epsilon, wanted: "between 0 and 1" });
        }
        if !is_reach(options.reach) {
            return Err(Error::Option {
                name: "reach",
                value: options.reach,
                wanted: "finite and at least 1",
            });
        }
        let metric = options.metric.clone().unwrap_or_else(|| model.metric().clone());
        check_scaled_modes(model.mesh(), model.modes(), &metric)?;
        let rest = vec![0.0; model.rank()];
        let center = options.center.clone().unwrap_or_else(|| rest.clone());
        model.check_coordinates(&center)?;
        let mut filter = options.filter.clone().unwrap_or_else(|| ContactFilter::of(model.mesh()));
        filter.check_model(model.mesh().faces().len())?;
        let collide_at_rest = || {
            let hierarchy = Arc::new(Hierarchy::build(model, &metric));
            let at_rest = colliding_pairs(model, &hierarchy, &filter, &rest, progress);
            (hierarchy, at_rest)
        };
        let ((hierarchy, at_rest), scaled) =
            parallel::join(collide_at_rest, || ScaledModel::new(model, &metric, &center));
        let at_rest = at_rest?;
        let rest_collisions = at_rest.len() as u64;
        let clearance = options.clearance;
        let scaled = match clearance {
            Some(clearance) => scaled.keeping(clearance.distance(), DISTANCE_ERROR),
            None => scaled,
        };
        let at_center = if let Some(clearance) = clearance {
            near_at_center(model, &filter, &center, &clearance, progress)?
        } else if center == rest {
            at_rest.clone()
        } else {
            colliding_pairs(model, &hierarchy, &filter, &center, progress)?
        };
        if let Some(rings) = options.ignore_rest {
            filter = filter.ignoring_around(model, at_rest, rings, progress)?;
        }
        let triangles = model.mesh().faces().len();
        let max_exceptions = options.max_exceptions.unwrap_or_else(|| default_exceptions(triangles));
        let exceptions = exceptions(at_center, &filter, max_exceptions);
        let scope = Scope { metric, center, filter, exceptions, clearance };
        let (digest, nodes) =
            parallel::join(|| Digest::of(model, &scope), || NodePairBounds::new(&scaled, &hierarchy));
        let (filter, rings) = scope.counted_pairs(model)?;
        let global_radius = global_radius(model, &scope.metric, &scope.center);
        Ok(Self {
            digest,
            groups: NodeGroups::new(&filter, &hierarchy),
            filter,
            rings,
            nodes,
            global_radius,
            farthest: farthest_radius(global_radius, options.reach),
            rest_collisions,
            epsilon: options.epsilon,
            scope,
            hierarchy,
            scaled,
        })
    }

    /// Returns the largest radius of interest in a round of the pair tree up to a limit. Rounds up to the global radius do not
    /// search beyond it: if the budget ends there, no time is spent on larger radii, and the certificates are the same as without
    /// a reach.
    pub(crate) fn farthest_in_round(&self, limit: f64) -> f64 {
        if limit > self.global_radius { self.farthest } else { self.global_radius }
    }

    /// Whether the AABBs of two nodes touch or overlap at the centre.
    pub(crate) fn are_touching(&self, nodes: NodePair) -> bool {
        self.nodes.are_touching(nodes)
    }

    /// Computes the local certificates of the model, in at most `most_bytes` bytes.
    ///
    /// # Errors
    /// When `progress` cancels.
    pub(crate) fn local_certificates(
        &self,
        model: &ReducedModel,
        most_bytes: usize,
        progress: &dyn Progress,
    ) -> Result<LocalCertificates, Error> {
        let Self { hierarchy, filter, scope, .. } = self;
        compute_local_certificates(model, hierarchy, filter, &scope.center, most_bytes, progress)
    }

    /// Creates a search for one thread.
    pub(crate) fn search<'a>(&'a self, progress: &'a dyn Progress) -> RadiusSearch<'a> {
        let Self { scaled, filter, rings, hierarchy, nodes, groups, .. } = self;
        RadiusSearch::new(
            RadiusSearchContext { model: scaled, filter, rings, hierarchy, nodes, groups },
            self.epsilon,
            progress,
        )
    }
}

/// Pairs nearer than this many times the clearance are exceptions, too. Parts are often designed exactly as far apart
/// as required, and their radius would be 0.
const NEARLY: f64 = 1.0 + 1.0 / (1 << 20) as f64;

/// Returns the pairs that are nearer than a clearance at the centre, or only slightly farther apart, sorted.
fn near_at_center(
    model: &ReducedModel,
    filter: &ContactFilter,
    center: &[f64],
    clearance: &Clearance,
    progress: &dyn Progress,
) -> Result<Vec<Pair>, Error> {
    let distance = clearance.distance() * NEARLY;
    // If this distance is not finite, the clearance is used: no two triangles are so far apart.
    let nearly = Clearance::new(distance).unwrap_or(*clearance).beyond_rings(clearance.rings());
    near_pairs_of_model(model, filter, center, &nearly, progress)
}

/// Returns the pairs that collide at the centre, or are near there, and are not ignored; no pair if there are more than allowed.
fn exceptions(at_center: Vec<Pair>, filter: &ContactFilter, max_exceptions: usize) -> Vec<Pair> {
    let is_counted = |pair: &Pair| filter.ignored().binary_search(pair).is_err();
    let mut exceptions: Vec<Pair> = at_center.into_iter().filter(is_counted).collect();
    if exceptions.len() > max_exceptions {
        exceptions.clear();
    }
    exceptions
}
