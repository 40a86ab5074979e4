//! Queries: which pairs of triangles collide at q (paper, Algorithm 1).

mod batch;
pub(crate) mod context;
mod continuous;
mod exceptions;
pub(crate) mod kinetic;
mod node_pair;
mod pair_tree_traversal;
pub(crate) mod root_region;
mod safe_scale;
mod traversal;

use std::borrow::Cow;
use std::sync::Arc;

use crate::detect::search::Finder;
use crate::detect::tables::Tables;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::model::check_scaled_modes;
use crate::{Certificates, Error, Pair, PairRule, Progress, ReducedModel, Scope};
use context::{Asked, Ends};
use root_region::Near;

pub use batch::Answer;
pub use continuous::Impact;
pub use kinetic::KineticQuery;

/// How a query finds the colliding pairs. All methods but [`Method::NormalConesApprox`] give the same pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Certificates of nodes and pairs of nodes, then lazily updated boxes (paper, Algorithm 1): BD-tree boxes
    /// for nodes down to about 64 triangles, tight ones below.
    Certified,
    /// The same boxes without certificates (James and Pai 2004).
    BdTree,
    /// All boxes refitted, no certificates: the paper's "traditional" method.
    Traditional,
    /// The traditional method that does not look into a node whose normals and boundary prove that it is free (normal
    /// cones with the contour test, Volino and Magnenat-Thalmann 1994). Normals at both ends prove nothing about the
    /// way between them: continuous queries are traditional.
    NormalCones,
    /// Normal cones as the paper's section 7 compares with them, without the contour test: **may miss collisions**. For
    /// measurements only.
    NormalConesApprox,
    /// Every pair of triangles. The oracle: quadratic.
    BruteForce,
}

/// What the last query cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Whether the root's certificate alone proved the shape free, exceptions apart.
    pub root_certified: bool,
    /// Whether everything was looked at: the pairs listed are all. False where a limit stopped the query, or an
    /// error.
    pub complete: bool,
    /// Nodes and pairs of nodes that had to be opened.
    pub opened: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles tested exactly.
    pub triangle_tests: u64,
}

/// Answers self-collision queries for one model; owns the memory for it, so that repeated queries allocate
/// nothing (brute force and the rare exact signs of extreme numbers aside). One query serves one thread; make as many
/// as there are threads by cloning it, or ask [`Query::batch`].
///
/// "Free" (no pairs) is exact, and so are the pairs: two triangles are listed exactly when they count under the
/// [`PairRule`] (by default: when they share no vertex) and their closed hulls, at the positions given by
/// [`deformed_position`](crate::deformed_position), have a point in common.
#[derive(Clone)]
pub struct Query<'a> {
    pub(crate) asked: Asked<'a>,
    /// Holds the last answer, of continuous queries the pairs.
    pub(crate) discrete: Finder<Pair, 1>,
    /// Made by the first continuous query.
    continuous: Option<Box<Finder<Impact, 2>>>,
    norm: f64,
    pub(crate) near: Near,
    /// Scratch for `q - center`; empty where the centre is 0.
    offset: Vec<f64>,
}

impl<'a> Query<'a> {
    /// A query by certificates.
    ///
    /// # Errors
    /// When the certificates are of another model.
    pub fn new(model: &'a ReducedModel, certificates: &'a Certificates) -> Result<Self, Error> {
        Self::with_method(model, certificates, Method::Certified)
    }

    /// A query by the given method, on the hierarchy of the certificates and by their rule.
    ///
    /// # Errors
    /// When the certificates are of another model.
    pub fn with_method(
        model: &'a ReducedModel,
        certificates: &'a Certificates,
        method: Method,
    ) -> Result<Self, Error> {
        certificates.check_model(model)?;
        let hierarchy = Cow::Borrowed(certificates.hierarchy());
        let scope = Cow::Borrowed(&certificates.parts().scope);
        Ok(Self::build(model, Some(certificates), scope, hierarchy, method))
    }

    /// A query that uses no certificates, for the pairs that count in that scope ([`Scope::of`] is the default);
    /// [`Method::Certified`] becomes [`Method::BdTree`].
    ///
    /// # Errors
    /// When the scope's metric or centre is of another rank than the model.
    pub fn without_certificates(
        model: &'a ReducedModel,
        scope: Scope,
        method: Method,
    ) -> Result<Self, Error> {
        check_scaled_modes(model.mesh(), model.modes(), &scope.metric)?;
        model.check_coordinates(&scope.center)?;
        let hierarchy = Cow::Owned(Hierarchy::build(model, &scope.metric));
        let method = if method == Method::Certified { Method::BdTree } else { method };
        Ok(Self::build(model, None, Cow::Owned(scope), hierarchy, method))
    }

    fn build(
        model: &'a ReducedModel,
        certificates: Option<&'a Certificates>,
        scope: Cow<'a, Scope>,
        hierarchy: Cow<'a, Hierarchy>,
        method: Method,
    ) -> Self {
        let is_centered = scope.center.iter().all(|x| *x == 0.0);
        let offset = vec![0.0; if is_centered { 0 } else { model.rank() }];
        let filter = Arc::new(PairFilter::new(model, &scope.rule));
        let asked = Asked { model, certificates, scope, hierarchy, filter, method, progress: &() };
        let discrete = Finder::new(&Arc::new(Tables::new(&asked)), method);
        let near = Near::new(&asked);
        Self { asked, discrete, continuous: None, norm: 0.0, near, offset }
    }

    /// The same query, which looks now and then whether it was cancelled. Nothing is reported.
    #[must_use]
    pub fn cancelled_by(mut self, progress: &'a dyn Progress) -> Self {
        self.asked.progress = progress;
        self
    }

    /// All colliding pairs at q: triangle indices `i < j` of the file's order, sorted.
    ///
    /// # Errors
    /// When q has the wrong length, an entry is not finite, or q moves vertices beyond
    /// [`limits::LARGEST`](crate::limits::LARGEST); when it was cancelled.
    pub fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.discrete_at_most(q, usize::MAX)
    }

    /// At most `limit` colliding pairs at q, sorted; which ones is not fixed. Where the limit stopped the query,
    /// [`Statistics::complete`] is false: there may be more.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn discrete_at_most(&mut self, q: &[f64], limit: usize) -> Result<&[Pair], Error> {
        let ends = self.begin([q], limit)?;
        self.discrete.find(&self.asked, &ends)?;
        Ok(&self.discrete.found)
    }

    /// One colliding pair at q, if there is any; which one is not fixed.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn first(&mut self, q: &[f64]) -> Result<Option<Pair>, Error> {
        Ok(self.discrete_at_most(q, 1)?.first().copied())
    }

    /// The number of colliding pairs at q.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn count(&mut self, q: &[f64]) -> Result<usize, Error> {
        Ok(self.discrete(q)?.len())
    }

    /// Forgets the last answer; checks what is asked, and measures it.
    #[inline]
    fn begin<'t, const E: usize>(&mut self, q: [&'t [f64]; E], limit: usize) -> Result<Ends<'t, E>, Error> {
        self.discrete.begin(limit);
        let mut ends = Ends { q, norm: 0.0, reach: 0.0, ball: None, pose: None };
        for q in q {
            let scope = &self.asked.scope;
            let norm = if q.len() != scope.center.len() {
                f64::INFINITY
            } else if self.offset.is_empty() {
                scope.metric.norm(q)
            } else {
                scope.metric.norm_from(q, &scope.center, &mut self.offset)
            };
            let near = norm < self.near.radius;
            let reach = if near { self.near.reach } else { self.asked.model.check_coordinates(q)? };
            let norm = right_or!(ends.norm.max(norm), SweptNormAtOneEnd, norm);
            (ends.norm, ends.reach) = (norm, ends.reach.max(reach));
        }
        self.norm = ends.norm;
        Ok(ends)
    }

    /// What the last query found, as [`Query::discrete`] or [`Query::discrete_at_most`] gave it; the pairs of
    /// [`Query::continuous`].
    pub fn pairs(&self) -> &[Pair] {
        &self.discrete.found
    }

    /// What the last query cost.
    pub fn statistics(&self) -> Statistics {
        self.discrete.statistics
    }

    /// `|z| = |S (q - center)|` of the last query, rounded up, in the metric and about the centre of its scope; of a
    /// continuous query the larger one of both ends.
    pub fn norm(&self) -> f64 {
        self.norm
    }

    /// What is asked: metric and centre of [`Query::norm`], and which pairs count.
    pub fn scope(&self) -> &Scope {
        &self.asked.scope
    }
}

/// The pairs that collide at q; an error where they are more than [`MOST_PAIRS`].
pub(crate) fn colliding_pairs(
    model: &ReducedModel,
    hierarchy: &Hierarchy,
    rule: &PairRule,
    q: &[f64],
    progress: &dyn Progress,
) -> Result<Vec<Pair>, Error> {
    let scope = Cow::Owned(Scope { rule: rule.clone(), ..Scope::of(model) });
    let query = Query::build(model, None, scope, Cow::Borrowed(hierarchy), Method::Traditional);
    let mut query = query.cancelled_by(progress);
    query.discrete_at_most(q, MOST_PAIRS)?;
    if query.statistics().complete {
        Ok(query.discrete.found)
    } else {
        Err(Error::TooManyCollisions { most: MOST_PAIRS })
    }
}

/// A mesh with more colliding pairs than this at rest (128 MiB of them) is no surface that anybody would deform.
const MOST_PAIRS: usize = 1 << 24;
