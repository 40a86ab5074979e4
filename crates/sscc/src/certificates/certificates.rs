//! The certificates of a model: their contents, and the type whose contents are checked to fit together.
//!
//! `build/` and `remote/` compute them. `validation.rs` checks that parts fit together. `compatibility.rs` checks that
//! they belong to a model.

use std::sync::Arc;

use super::{Digest, LocalCertificates, PairTree, Scope};
use crate::hierarchy::Hierarchy;
use crate::{Clearance, ContactFilter, Error, Metric, Pair};

/// The proof of which parts of a model are free of collisions near the centre: a hierarchy with a radius for each node
/// and for pairs of nodes.
///
/// All radii are norms `|z| = |S (q - center)|` in the metric of the certificates. A set of triangle pairs with radius
/// R is certified: at any q with `|z| < R` no pair that counts has a point in common, except for the exceptions; with a
/// [clearance](Certificates::clearance) none is nearer than that.
///
/// Clones share one memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificates(Arc<CertificateParts>);

/// The contents of [`Certificates`], for reading and writing files.
#[derive(Clone, Debug, PartialEq)]
pub struct CertificateParts {
    /// Hash of the model and the scope for which the certificates hold.
    pub digest: Digest,
    /// The hierarchy over the triangles.
    pub hierarchy: Arc<Hierarchy>,
    /// Metric, centre, contact filter and exceptions for which the certificates hold.
    pub scope: Arc<Scope>,
    /// The allowed relative error of the root's radius; see [`CertifyOptions::epsilon`](crate::CertifyOptions::epsilon).
    pub epsilon: f64,
    /// The radius at which radii are capped: the paper's `R_global` (section 5.2), or the radius up to which the pair tree
    /// was built, if that is larger ([`CertifyOptions::reach`](crate::CertifyOptions::reach)); infinite if no mode moves a
    /// vertex, or all vertices are at one point at the centre, or within about 1e-162 of it.
    pub global_radius: f64,
    /// `R_n` of each node: below it no two triangles of the node collide. It is at most that of any child. A node inside a bucket
    /// ([`Node::fits_in_bucket`](crate::parts::Node::fits_in_bucket)) has the bucket's radius.
    pub node_radii: Vec<f64>,
    /// `R_nm` of each pair of children of the root, in the order (0,1), (0,2), ..., (2,3).
    pub root_pair_radii: Vec<f64>,
    /// Radii of node pairs, all below the tree's limit.
    pub pair_tree: PairTree,
    /// Certificates that follow from the strain of nodes, and hold far from the centre, too.
    pub local: Arc<LocalCertificates>,
    /// Number of colliding pairs at rest (q = 0), ignored ones included.
    pub rest_collisions: u64,
}

impl Certificates {
    /// Creates certificates from parts that fit together.
    pub(super) fn new(parts: CertificateParts) -> Self {
        Self(Arc::new(parts))
    }

    /// Returns the contents, for writing.
    pub fn parts(&self) -> &CertificateParts {
        &self.0
    }

    /// Returns the hierarchy over the triangles.
    pub(crate) fn hierarchy(&self) -> &Hierarchy {
        &self.0.hierarchy
    }

    /// Returns the metric in which radii are measured.
    pub fn metric(&self) -> &Metric {
        &self.0.scope.metric
    }

    /// Returns the configuration from which radii are measured (r entries).
    pub fn center(&self) -> &[f64] {
        &self.0.scope.center
    }

    /// Returns the contact filter: which pairs of triangles count.
    pub fn filter(&self) -> &ContactFilter {
        &self.0.scope.filter
    }

    /// Returns the clearance that triangles keep below the radii
    /// ([`CertifyOptions::clearance`](crate::CertifyOptions::clearance)). None if the radii only prove that they do not collide.
    pub fn clearance(&self) -> Option<Clearance> {
        self.0.scope.clearance
    }

    /// Whether the certificates prove that triangles keep a clearance: that of the certificates is at least as large, beyond no
    /// more rings.
    pub(crate) fn is_within_clearance(&self, clearance: &Clearance) -> bool {
        self.clearance().is_some_and(|certified| {
            let is_as_far = certified.distance() >= clearance.distance();
            with_mutant!(is_as_far, SmallerClearanceUsed, true)
                && with_mutant!(certified.rings() <= clearance.rings(), MoreRingsUsed, true)
        })
    }

    /// Returns the pairs that no radius covers and every query tests, sorted.
    pub fn exceptions(&self) -> &[Pair] {
        &self.0.scope.exceptions
    }

    /// Returns the radius of the root: at any q with `|S (q - center)|` below it the whole model is free, except for the
    /// exceptions. If the certificates have a [`clearance`](Self::clearance), no triangles that count and are beyond its
    /// rings are nearer than it, but triangles within the rings may collide.
    pub fn root_radius(&self) -> f64 {
        self.0.node_radii[0]
    }

    /// Returns the radius at which radii are capped: the paper's `R_global`, or the radius up to which the pair tree was built,
    /// if that is larger ([`CertifyOptions::reach`](crate::CertifyOptions::reach)).
    pub fn global_radius(&self) -> f64 {
        self.0.global_radius
    }

    /// Returns `R_n` of a node.
    pub(crate) fn node_radius(&self, node: u32) -> f64 {
        self.0.node_radii[node as usize]
    }

    /// Returns the number of colliding pairs at rest.
    pub fn rest_collisions(&self) -> u64 {
        self.0.rest_collisions
    }

    /// Returns `|z| = |S (q - center)|`, rounded up: the number that is compared with radii.
    ///
    /// # Errors
    /// If the length of q is not the number of modes.
    pub fn norm(&self, q: &[f64]) -> Result<f64, Error> {
        self.0.scope.metric.check_len(q)?;
        Ok(self.0.scope.norm(q))
    }
}
