//! Queries: which non-adjacent triangle pairs collide at q (paper, Algorithm 1).

mod bd_tree;
mod boxes;
mod brute_force;
mod traversal;

use std::borrow::Cow;

use crate::hierarchy::Hierarchy;
use crate::{Certificates, Error, Metric, ReducedModel};
use boxes::Boxes;

/// How a query finds the colliding pairs. All methods give the same pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Certificates, then lazily updated boxes (paper, Algorithm 1): BD-tree boxes for large nodes, tight
    /// ones for nodes of at most 64 triangles.
    Certified,
    /// The same boxes without certificates (James and Pai 2004).
    BdTree,
    /// All boxes refitted, no certificates: the paper's "traditional" method.
    Traditional,
    /// Every pair of triangles. The oracle: quadratic.
    BruteForce,
}

/// What the last query cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Whether the root's certificate alone proved the shape free.
    pub root_certified: bool,
    /// Nodes and pairs of nodes that had to be opened.
    pub opened: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles tested exactly.
    pub triangle_tests: u64,
}

/// Answers self-collision queries for one model; owns the memory for it, so that repeated queries allocate
/// nothing (brute force and the rare exact signs of extreme numbers aside). One query serves one thread; make as many as there are threads.
///
/// "Free" (no pairs) is exact, and so are the pairs: two triangles are listed exactly when they share no vertex
/// and their closed hulls, at the positions given by [`deformed_position`](crate::deformed_position), have a point
/// in common.
pub struct Query<'a> {
    model: &'a ReducedModel,
    certificates: Option<&'a Certificates>,
    hierarchy: Cow<'a, Hierarchy>,
    method: Method,
    boxes: Boxes,
    stack: Vec<(u32, u32)>,
    pairs: Vec<(u32, u32)>,
    statistics: Statistics,
    norm: f64,
}

impl<'a> Query<'a> {
    /// A query by certificates.
    ///
    /// # Errors
    /// When the certificates are of another model.
    pub fn new(model: &'a ReducedModel, certificates: &'a Certificates) -> Result<Self, Error> {
        Self::with_method(model, certificates, Method::Certified)
    }

    /// A query by the given method, on the hierarchy of the certificates.
    ///
    /// # Errors
    /// When the certificates are of another model.
    pub fn with_method(
        model: &'a ReducedModel,
        certificates: &'a Certificates,
        method: Method,
    ) -> Result<Self, Error> {
        certificates.check_model(model)?;
        Ok(Self::build(model, Some(certificates), Cow::Borrowed(certificates.hierarchy()), method))
    }

    /// A query that uses no certificates; [`Method::Certified`] becomes [`Method::BdTree`].
    pub fn without_certificates(model: &'a ReducedModel, method: Method) -> Self {
        let hierarchy = Hierarchy::build(model, model.metric());
        Self::on_hierarchy(model, Cow::Owned(hierarchy), method)
    }

    pub(crate) fn on_hierarchy(
        model: &'a ReducedModel,
        hierarchy: Cow<'a, Hierarchy>,
        method: Method,
    ) -> Self {
        let method = if method == Method::Certified { Method::BdTree } else { method };
        Self::build(model, None, hierarchy, method)
    }

    fn build(
        model: &'a ReducedModel,
        certificates: Option<&'a Certificates>,
        hierarchy: Cow<'a, Hierarchy>,
        method: Method,
    ) -> Self {
        let boxes = Boxes::new(model, &hierarchy, method);
        Self {
            model,
            certificates,
            hierarchy,
            method,
            boxes,
            stack: Vec::new(),
            pairs: Vec::new(),
            statistics: Statistics::default(),
            norm: 0.0,
        }
    }

    /// All colliding pairs at q: triangle indices `i < j` of the file's order, sorted.
    ///
    /// # Errors
    /// When q has the wrong length, an entry is not finite, or q moves vertices beyond
    /// [`limits::LARGEST`](crate::limits::LARGEST).
    pub fn discrete(&mut self, q: &[f64]) -> Result<&[(u32, u32)], Error> {
        let reach = self.model.check_coordinates(q)?;
        self.pairs.clear();
        self.statistics = Statistics::default();
        self.norm = self.metric().norm(q);
        if self.method == Method::Certified
            && self.certificates.is_some_and(|certificates| self.norm < certificates.root_radius())
        {
            self.statistics.root_certified = true;
            return Ok(&self.pairs);
        }
        if self.method == Method::BruteForce {
            brute_force::collide(self.model, q, &mut self.pairs, &mut self.statistics);
        } else {
            self.boxes.update(self.model, &self.hierarchy, q, reach);
            self.traverse((0, 0), q);
        }
        self.pairs.sort_unstable();
        Ok(&self.pairs)
    }

    /// The colliding pairs between the triangles of two nodes without common triangles, or within one node
    /// (n = m), found without certificates: for audits.
    pub(crate) fn discrete_between(&mut self, n: u32, m: u32, q: &[f64]) -> Result<&[(u32, u32)], Error> {
        let reach = self.model.check_coordinates(q)?;
        self.pairs.clear();
        self.norm = self.metric().norm(q);
        self.boxes.update(self.model, &self.hierarchy, q, reach);
        self.traverse((n, m), q);
        self.pairs.sort_unstable();
        Ok(&self.pairs)
    }

    /// What the last query cost.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// `|z| = |S q|` of the last query, rounded up, in the metric of the certificates (else the model's).
    pub fn norm(&self) -> f64 {
        self.norm
    }

    /// The metric in which [`Query::norm`] measures.
    pub fn metric(&self) -> &Metric {
        self.certificates.map_or(self.model.metric(), Certificates::metric)
    }
}
