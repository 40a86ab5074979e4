//! What a query is asked of: all that stays the same from one q to the next.

use std::borrow::Cow;
use std::sync::Arc;

use super::Method;
use crate::detect::ball::Ball;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::posed::Placement;
use crate::{CertificateParts, Certificates, Pair, PairTree, Progress, ReducedModel, Scope};

#[derive(Clone)]
pub(crate) struct Asked<'a> {
    pub(crate) model: &'a ReducedModel,
    pub(crate) certificates: Option<&'a Certificates>,
    pub(crate) scope: Cow<'a, Scope>,
    pub(crate) hierarchy: Cow<'a, Hierarchy>,
    pub(crate) filter: Arc<PairFilter>,
    pub(crate) method: Method,
    pub(crate) progress: &'a dyn Progress,
}

impl Asked<'_> {
    /// The certificates, if this method uses them.
    #[inline]
    pub(crate) fn used_certificates(&self) -> Option<&CertificateParts> {
        self.certificates.filter(|_| self.method == Method::Certified).map(Certificates::parts)
    }

    /// The pair tree, if this method uses it and it is complete at this norm: then a pair that it does not hold is
    /// certified.
    pub(crate) fn complete_pair_tree(&self, norm: f64) -> Option<&PairTree> {
        let tree = self.used_certificates().map(|parts| &parts.pair_tree);
        right_or!(
            tree.filter(|tree| norm < tree.limit()),
            TreeLimitReached,
            tree.filter(|tree| norm <= tree.limit())
        )
    }

    /// Whether the root's certificate alone proves that nothing collides at this norm, exceptions apart. Like all radii
    /// this one is no proof where it is reached: where it is 0, the shape may collide at the centre. (Other norms have been
    /// rounded up by more than nothing, so that equality would do no harm.)
    #[inline]
    pub(crate) fn root_certifies(&self, norm: f64) -> bool {
        let parts = self.used_certificates();
        right_or!(
            parts.is_some_and(|parts| norm < parts.node_radii[0]),
            RootRadiusReached,
            parts.is_some_and(|parts| norm <= parts.node_radii[0])
        )
    }

    /// The pairs that this query must test by itself: those of the certificates it uses.
    #[inline]
    pub(crate) fn exceptions(&self) -> &[Pair] {
        self.used_certificates().map_or(&[], |parts| &parts.scope.exceptions)
    }

    /// Whether a pair has been tested as an exception.
    #[inline]
    pub(crate) fn is_exception(&self, pair: Pair) -> bool {
        let exceptions = self.exceptions();
        !exceptions.is_empty() && exceptions.binary_search(&pair).is_ok()
    }
}

/// One configuration, or the two ends of a motion.
#[derive(Clone, Copy)]
pub(crate) struct Ends<'t, const E: usize> {
    pub(crate) q: [&'t [f64]; E],
    /// The larger one of the norms at both ends: a certificate holds on the way when it holds at both, because its
    /// region is convex.
    pub(crate) norm: f64,
    /// The larger one of the reaches.
    pub(crate) reach: f64,
    /// With two ends that are the same: instead of the way between them, all z in a ball around it count. Then `norm`
    /// and `reach` are the largest ones there.
    pub(crate) ball: Option<&'t Ball>,
    /// Where the shape is in the world; its own axes if there is none. The reach is that in the world then.
    pub(crate) pose: Option<&'t Placement>,
}
