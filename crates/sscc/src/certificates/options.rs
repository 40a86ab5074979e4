//! Options of the computation of certificates.

use crate::{Clearance, ContactFilter, Metric};

/// Options of the computation of certificates. Each method sets one option: `CertifyOptions::default().budget(0).threads(2)`.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CertifyOptions {
    pub(crate) epsilon: f64,
    pub(crate) metric: Option<Metric>,
    pub(crate) center: Option<Vec<f64>>,
    pub(crate) filter: Option<ContactFilter>,
    pub(crate) ignore_rest: Option<u32>,
    pub(crate) max_exceptions: Option<usize>,
    pub(crate) clearance: Option<Clearance>,
    pub(crate) budget: usize,
    pub(crate) local_budget: usize,
    pub(crate) reach: f64,
    pub(crate) threads: Option<usize>,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self {
            epsilon: DEFAULT_EPSILON,
            metric: None,
            center: None,
            filter: None,
            ignore_rest: None,
            max_exceptions: None,
            clearance: None,
            budget: DEFAULT_BUDGET,
            local_budget: DEFAULT_LOCAL_BUDGET,
            reach: DEFAULT_REACH,
            threads: None,
        }
    }
}

impl CertifyOptions {
    setters! {
        /// Relative tolerance, in (0, 1). The root's radius is at least `1 - epsilon` times the exact one, and so is every
        /// radius that may be as small. The tolerance of other radii depends on their kind:
        ///
        /// - the smallest radii of buckets and of pairs of buckets: tolerance `min(epsilon, 0.03)`, as far as a limited number of
        ///   subdivisions and triangle pairs suffices;
        /// - other pairs of buckets in the pair tree, which is built in rounds up to increasing limits, except those of the last,
        ///   *outer* round: `max(epsilon, 0.25)`, as far as no subdivision is needed;
        /// - pairs of buckets that the outer round adds, up to 1.5 times the limit before it: lower bounds without a tolerance;
        /// - radii of nodes that are searched on their own: `max(epsilon, 0.4)`.
        ///
        /// A radius at the cap may be smaller, and so may one whose search ran out of subdivisions or of memory for its queue.
        /// The paper (section 5.1) and the default have 0.1.
        epsilon: f64,
        /// The metric. None for the model's default.
        metric: impl Into<Option<Metric>>,
        /// The configuration from which radii are measured (r entries). None for q = 0, the rest pose.
        center: impl Into<Option<Vec<f64>>>,
        /// The contact filter: which pairs of triangles count. None for the default of the model's mesh ([`ContactFilter::of`]).
        filter: impl Into<Option<ContactFilter>>,
        /// The contact filter also ignores the pairs that collide at rest (q = 0) and those within this many rings of them, 0 for
        /// these pairs alone: queries never list them. Where lips rest on each other, their neighbours touch at the smallest
        /// weight: one or two rings leave these out. None ignores no pair for that reason.
        ignore_rest: impl Into<Option<u32>>,
        /// The largest number of exceptions: pairs that collide at the centre, are left out of every radius, and are tested
        /// in every query. If more pairs collide there, none of them is an exception, and the radius of each node that
        /// contains one is 0. None for half the number of the triangles, because testing more in every query costs as much as
        /// radii can save.
        max_exceptions: impl Into<Option<usize>>,
        /// Certifies the radii at which two triangles come nearer than a clearance, in place of those at which they collide. Only
        /// [`Query::within`](crate::Query::within) uses them, with at most this clearance and at least as many rings. They prove nothing about
        /// collisions, because triangles within the rings may collide, so other queries do not use them. Exceptions are then the
        /// pairs that are nearer than the clearance at the centre, or farther by less than a millionth of it. There are
        /// no local certificates. None for radii of collisions.
        clearance: impl Into<Option<Clearance>>,
        /// Memory for the pair tree ([`PairTree`](crate::parts::PairTree)), in bytes for each triangle of the mesh; a node pair
        /// takes 8. The tree stores the node pairs with the smallest radii, so the budget decides its limit
        /// ([`PairTree::limit`](crate::parts::PairTree::limit)). Below the limit a query opens two nodes only if it has reached the
        /// radius of their pair, even if their AABBs touch; if the tree has nearly all pairs and all are reached, queries do not use
        /// it. The rounds before the outer one may use a
        /// quarter of the budget, and search the radii of their pairs. Pairs of the outer round mostly have the bound of the two
        /// nodes alone. 0 for no tree, which is the paper's scheme of one radius for each node and each pair of the root's
        /// children; this suits certificates that serve a few queries only, since the tree takes most of the time. 64 by default.
        budget: usize,
        /// Memory for local certificates ([`LocalCertificates`](crate::parts::LocalCertificates)), in bytes for each triangle of
        /// the mesh. Together with [`budget`](Self::budget) it also covers the hierarchy and its radii (10 to 14 bytes a
        /// triangle), so by default certificates take at most 128 bytes a triangle; memory that the pair tree does not need is
        /// used here. Nodes that few modes move come first, and at equal numbers of modes the largest. There are no
        /// local certificates if they would cover less than 0.6 of all triangles. 0 for none, which suits certificates
        /// that serve a few queries only, because local certificates take about as long as the radii. 64 by default.
        local_budget: usize,
        /// The farthest radius, in units of `R_global` (paper, section 5.2): finite, at least 1. The pair tree ends at that
        /// radius, or before it if its budget is used up; beyond `R_global` the rounds before the outer one may use an eighth of
        /// the budget. That takes longer than local certificates, which prove most shapes there free, so the default is 1. Radii
        /// of nodes are capped at the radius up to which the tree was built, but not below `R_global`
        /// ([`Certificates::global_radius`](crate::Certificates::global_radius)). If the budget ends below `R_global`, the
        /// certificates are the same for any reach. Without a tree all radii end at `R_global`.
        reach: f64,
        /// Number of threads, `None` for all cores. The result is the same for any number.
        threads: impl Into<Option<usize>>,
    }
}

/// The default of [`CertifyOptions::epsilon`].
pub const DEFAULT_EPSILON: f64 = 0.1;

/// The default of [`CertifyOptions::budget`], in bytes for each triangle.
pub const DEFAULT_BUDGET: usize = 64;

/// The default of [`CertifyOptions::local_budget`], in bytes for each triangle.
pub const DEFAULT_LOCAL_BUDGET: usize = 64;

/// The default of [`CertifyOptions::reach`].
pub const DEFAULT_REACH: f64 = 1.0;

/// Whether a number can be a [`CertifyOptions::reach`]: finite and at least 1.
pub fn is_reach(reach: f64) -> bool {
    (1.0..f64::INFINITY).contains(&reach)
}

/// Returns the default of [`CertifyOptions::max_exceptions`] for a mesh of this many triangles.
pub fn default_exceptions(triangles: usize) -> usize {
    triangles.div_ceil(2)
}
