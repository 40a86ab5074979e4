//! State shared by all queries on one model: detector context, certificates, scope. Its methods return which certificates hold
//! at a norm.

use std::sync::Arc;

use super::local_tables::LocalTables;
use super::method::Method;
use super::pair_hulls::PairHulls;
use crate::certificates::{CertificateParts, FactorScales, PairTree, PatchModel, Scope};
use crate::detect::context::Context;
use crate::detect::normal_cones::NormalCones;
use crate::hierarchy::Hierarchy;
use crate::{Certificates, ReducedModel};

/// The detector's context, and which certificates hold at a norm.
#[derive(Clone)]
pub(super) struct QueryContext {
    pub(super) model: ReducedModel,
    pub(super) detect: Context,
    pub(super) certificates: Option<Certificates>,
    pub(super) scope: Arc<Scope>,
    pub(super) method: Method,
    /// Hulls for the pair tree, if the method uses the tree.
    pub(super) hulls: Option<Arc<PairHulls>>,
    /// Local certificates, if the method uses them.
    pub(super) locals: Option<Arc<LocalTables>>,
    /// From this `|z|` on, local certificates are evaluated.
    pub(super) local_norm: f64,
    /// From this `|z|` on, the radii of all pairs are reached, for a tree that has nearly all pairs of nodes; infinite for other trees.
    all_reached_norm: f64,
    /// The root's radius where the root's certificate alone answers a query: the method uses certificates and there are
    /// no exceptions. Otherwise 0.
    proven_radius: f64,
}

impl QueryContext {
    pub(super) fn new(
        model: &ReducedModel,
        certificates: Option<&Certificates>,
        scope: Arc<Scope>,
        hierarchy: Arc<Hierarchy>,
        method: Method,
    ) -> Self {
        let used = certificates.filter(|_| method == Method::Certified);
        let exceptions = used.map_or(&[][..], Certificates::exceptions);
        let detect = Context::new(model, hierarchy, &scope.filter, exceptions, method.needs());
        let hulls = used.and_then(|used| {
            let tree = &used.parts().pair_tree;
            PairHulls::new(model, &detect.hierarchy, &detect.layout, tree, &scope.center).map(Arc::new)
        });
        let locals = used.and_then(|used| {
            let (scales, center) = (FactorScales::new(model, used.center())?, used.center());
            let mut tables = LocalTables::new(&used.parts().local, used.hierarchy(), center, scales)?;
            // Where few modes move each vertex, most parts are moved by one bone alone, and their own modes are affine.
            if !detect.layout.vertices.moving_modes().are_listed()
                && let Some(model) = PatchModel::new(model, center)
            {
                tables.add_affine_modes(&model);
            }
            Some(Arc::new(tables))
        });
        let proven = used.filter(|_| with_mutant!(exceptions.is_empty(), ExceptionsProvenFree, true));
        let proven_radius = proven.map_or(0.0, Certificates::root_radius);
        let [mut local_norm, mut all_reached_norm] = [f64::INFINITY; 2];
        if let Some(CertificateParts { node_radii, pair_tree, .. }) = used.map(Certificates::parts) {
            let buckets = &detect.layout.buckets;
            let radius = |n: u32| node_radii[n as usize];
            let visited = (0..node_radii.len() as u32)
                .filter(|n| buckets.of_node(*n).is_none_or(|bucket| buckets.node(bucket) == *n));
            local_norm = norm_at(LOCAL_SHARE, visited.map(radius).collect()).min(LOCAL_ROOTS * node_radii[0]);
            all_reached_norm = self::all_reached_norm(pair_tree, buckets.count());
        }
        Self {
            model: model.clone(),
            detect,
            certificates: certificates.cloned(),
            scope,
            method,
            hulls,
            locals,
            local_norm,
            all_reached_norm,
            proven_radius,
        }
    }

    /// Returns the context of queries of clearances, from that of queries of collisions: certificates with a clearance cull their
    /// searches; moving hulls and local certificates are not used.
    pub(super) fn of_clearance(&self, certificates: &Certificates) -> Self {
        let exceptions = certificates.exceptions();
        let buckets = self.detect.layout.buckets.count();
        let tested =
            with_mutant!(exceptions.into(), NearExceptionsOfContacts, Arc::clone(&self.detect.exceptions));
        Self {
            detect: Context { exceptions: tested, ..self.detect.clone() },
            certificates: Some(certificates.clone()),
            method: Method::Certified,
            hulls: None,
            locals: None,
            local_norm: f64::INFINITY,
            all_reached_norm: all_reached_norm(&certificates.parts().pair_tree, buckets),
            proven_radius: if with_mutant!(exceptions.is_empty(), NearExceptionsProvenFree, true) {
                certificates.root_radius()
            } else {
                0.0
            },
            ..self.clone()
        }
    }

    /// Returns the normal cones of the method, if it uses any.
    pub(super) fn cones(&self) -> Option<NormalCones> {
        let nodes = self.detect.layout.buckets.node_count();
        (self.method == Method::NormalCones).then(|| NormalCones::new(nodes))
    }

    /// Returns the certificates, if the method uses them.
    #[inline]
    pub(super) fn used_certificates(&self) -> Option<&CertificateParts> {
        self.certificates.as_ref().filter(|_| self.method == Method::Certified).map(Certificates::parts)
    }

    /// Returns the pair tree, if the method uses it, and it is complete at this norm and some pairs are not reached: then a pair that
    /// the tree does not contain is certified.
    pub(super) fn complete_pair_tree(&self, norm: f64) -> Option<&PairTree> {
        let tree = self.used_certificates().map(|parts| &parts.pair_tree);
        let tree = tree.filter(|_| norm < self.all_reached_norm);
        with_mutant!(
            tree.filter(|tree| norm < tree.limit()),
            TreeLimitReached,
            tree.filter(|tree| norm <= tree.limit())
        )
    }

    /// Returns the norm from which on [`Self::complete_pair_tree`] is `None`; infinite for a larger norm.
    pub(super) fn pair_tree_end(&self, norm: f64) -> f64 {
        self.complete_pair_tree(norm).map_or(f64::INFINITY, |tree| tree.limit().min(self.all_reached_norm))
    }

    /// Whether the root's certificate proves the shape free at this norm, and there are no exceptions to test.
    #[inline]
    pub(super) fn is_proven_free(&self, norm: f64) -> bool {
        with_mutant!(norm < self.proven_radius, RootRadiusReached, norm <= self.proven_radius)
    }

    /// Whether the root's certificate holds at this norm (it does not cover exceptions). It does not hold at a norm equal to the
    /// radius: with radius 0 the shape may collide at the centre.
    #[inline]
    pub(super) fn is_root_certified(&self, norm: f64) -> bool {
        let parts = self.used_certificates();
        with_mutant!(
            parts.is_some_and(|parts| norm < parts.node_radii[0]),
            RootRadiusReached,
            parts.is_some_and(|parts| norm <= parts.node_radii[0])
        )
    }
}

/// In a search that opens a smaller share of all nodes, evaluating the root's local certificate costs more than it
/// saves.
const LOCAL_SHARE: f64 = 1.0 / 32.0;

/// From this many times the root's radius on, local certificates are always evaluated: on a shape whose parts rotate, few radii of nodes
/// may be reached there, but those of many pairs of nodes. With 2 in place of 6, queries of the dragon at 5% of its size, most of which
/// are culled by radii, took 1.08 times as long, and continuous ones 1.13 times.
const LOCAL_ROOTS: f64 = 6.0;

/// Returns the `|z|` at which this share of some radii, and one more, is reached; infinite without radii.
fn norm_at(share: f64, mut radii: Vec<f64>) -> f64 {
    radii.sort_unstable_by(f64::total_cmp);
    let rank = (share * radii.len() as f64) as usize;
    radii.get(rank).copied().unwrap_or(f64::INFINITY)
}

/// Returns the largest radius of a pair tree that has at least as many entries as there are pairs of buckets: the tree of a small mesh
/// has nearly all pairs of nodes. Infinite for other trees.
fn all_reached_norm(tree: &PairTree, buckets: usize) -> f64 {
    if tree.len() < buckets * buckets.saturating_sub(1) / 2 {
        return f64::INFINITY;
    }
    tree.entries().map(|(radius, _)| f64::from(radius)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::{LOCAL_SHARE, all_reached_norm, norm_at};
    use crate::certificates::PairTree;

    #[test]
    fn norm_at_reaches_the_share_of_radii() {
        let ten: Vec<f64> = (0..10).rev().map(f64::from).collect();
        for (radii, norm) in [
            (ten, 0.0),
            (vec![3.0], 3.0),
            (vec![], f64::INFINITY),
            (vec![f64::INFINITY, 1.0], 1.0),
            ((0..64).map(f64::from).collect(), 2.0),
        ] {
            assert_eq!(norm_at(LOCAL_SHARE, radii), norm);
        }
    }

    #[test]
    fn trees_of_fewer_pairs_than_pairs_of_buckets_leave_pairs_out() {
        let tree = PairTree::from_parts(9.0, vec![0], [(1.0, 0), (3.0, 1), (2.0, 2)]);
        assert_eq!([1, 2, 3].map(|buckets| all_reached_norm(&tree, buckets)), [3.0; 3]);
        assert_eq!(all_reached_norm(&tree, 4), f64::INFINITY);
        assert_eq!(all_reached_norm(&PairTree::default(), 2), f64::INFINITY);
    }
}
