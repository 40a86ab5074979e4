//! `Query`: collisions of one reduced model with itself at q.

use std::fmt;
use std::sync::Arc;

use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::configuration_search::{DiscreteSearch, SweptSearch};
use super::context::QueryContext;
use super::method::Method;
use super::near_search::NearSearch;
use crate::arithmetic::check_arithmetic;
use crate::certificates::CertificateParts;
use crate::certificates::Scope;
use crate::detect::answer::Statistics;
use crate::detect::narrow_phase::{AabbHits, SweptHits};
use crate::hierarchy::Hierarchy;
use crate::model::check_scaled_modes;
use crate::{CancelToken, Certificates, Detector, Error, Pair, ReducedModel};

/// Answers self-collision queries for one model. It owns its memory, so that repeated queries of collisions at q or
/// between two q allocate nothing (brute force and the rare exact signs of extreme numbers aside), and shares model and
/// certificates. One query serves one thread; clone it for another, or use [`Query::batch`].
///
/// Two triangles are listed exactly when they count under the contact filter ([`ContactFilter`](crate::ContactFilter); by default
/// when they share no vertex) and have a point in common at the positions given by
/// [`deformed_position`](crate::deformed_position); see `docs/guarantees.md`.
#[derive(Clone)]
pub struct Query {
    pub(super) context: QueryContext,
    /// Contains the last answer; after a continuous query only its pairs.
    pub(super) discrete: DiscreteSearch,
    /// Created by the first continuous query.
    pub(super) swept: Option<Box<SweptSearch<SweptHits>>>,
    /// Created by the first sweep.
    pub(super) candidates: Option<Box<SweptSearch<AabbHits>>>,
    /// Created by the first query of distances that certificates do not answer.
    pub(super) detector: Option<Box<Detector>>,
    /// The search for near triangles, if the certificates have a clearance.
    pub(super) near: Option<Box<NearSearch>>,
    pub(super) norm: f64,
    pub(super) statistics: Statistics,
    pub(super) check: ConfigurationCheck,
}

/// Shows the last answer only.
impl fmt::Debug for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Query")
            .field("pairs", &self.pairs())
            .field("norm", &self.norm)
            .field("statistics", &self.statistics)
            .finish_non_exhaustive()
    }
}

impl Query {
    /// Creates a query that uses certificates. Those with a [clearance](Certificates::clearance) are used by [`Query::within`] only; all
    /// other queries are then answered without certificates. This function fits the moving hulls of nodes, in less than a fifth of the
    /// time that the certificates took. Clones share the hulls.
    ///
    /// # Errors
    /// As [`Query::with_method`].
    pub fn new(model: &ReducedModel, certificates: &Certificates) -> Result<Self, Error> {
        Self::with_method(model, certificates, Method::Certified)
    }

    /// Creates a query by the given method, with the hierarchy and the scope of the certificates.
    ///
    /// # Errors
    /// When the certificates were computed for another model ([`Certificates::check_model`]), or this thread's
    /// arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    pub fn with_method(
        model: &ReducedModel,
        certificates: &Certificates,
        method: Method,
    ) -> Result<Self, Error> {
        check_arithmetic()?;
        certificates.check_model(model)?;
        let CertificateParts { hierarchy, scope, .. } = certificates.parts();
        Ok(Self::build(model, Some(certificates), Arc::clone(scope), Arc::clone(hierarchy), method))
    }

    /// Creates a query without certificates, for the pairs that count in that scope ([`Scope::of`] is the default).
    /// [`Method::Certified`] is replaced by [`Method::BdTree`].
    ///
    /// # Errors
    /// When the scope's metric or centre is of another rank than the model or out of the range in which the proofs
    /// hold, its groups are of another mesh, it includes folded neighbours ([`Error::FoldedNeighbours`]), or this
    /// thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    pub fn without_certificates(
        model: &ReducedModel,
        scope: impl Into<Arc<Scope>>,
        method: Method,
    ) -> Result<Self, Error> {
        check_arithmetic()?;
        let scope = scope.into();
        check_scaled_modes(model.mesh(), model.modes(), &scope.metric)?;
        model.check_coordinates(&scope.center)?;
        scope.filter.check_model(model.mesh().faces().len())?;
        let hierarchy = Arc::new(Hierarchy::build(model, &scope.metric));
        let method = if method == Method::Certified { Method::BdTree } else { method };
        Ok(Self::build(model, None, scope, hierarchy, method))
    }

    fn build(
        model: &ReducedModel,
        certificates: Option<&Certificates>,
        scope: Arc<Scope>,
        hierarchy: Arc<Hierarchy>,
        method: Method,
    ) -> Self {
        // Certificates with a clearance prove nothing about collisions of triangles within their rings.
        let (plain, near): (Option<&Certificates>, Option<&Certificates>) = match certificates {
            Some(certificates)
                if with_mutant!(certificates.clearance().is_some(), ClearanceProvesFree, false) =>
            {
                (None, Some(certificates))
            }
            plain => (plain, None),
        };
        let near = near.filter(|_| method == Method::Certified);
        let plain_method = if near.is_some() { Method::BdTree } else { method };
        let context = QueryContext::new(model, plain, scope, hierarchy, plain_method);
        let near = near.map(|certificates| Box::new(NearSearch::new(&context, certificates)));
        let discrete = DiscreteSearch::new(&context);
        let check = ConfigurationCheck::new(&context);
        let statistics = Statistics::default();
        Self {
            context,
            discrete,
            swept: None,
            candidates: None,
            detector: None,
            near,
            norm: 0.0,
            statistics,
            check,
        }
    }

    /// Returns a clone without the memory of continuous queries, sweeps and distances.
    pub(super) fn discrete_alone(&self) -> Self {
        Self {
            context: self.context.clone(),
            discrete: self.discrete.clone(),
            swept: None,
            candidates: None,
            detector: None,
            near: None,
            norm: self.norm,
            statistics: self.statistics,
            check: self.check.clone(),
        }
    }

    /// Returns the same query, which checks regularly whether the token cancels it; with `None` it no longer checks.
    #[must_use]
    pub fn cancelled_by(mut self, token: impl Into<Option<CancelToken>>) -> Self {
        self.context.detect.cancel = token.into();
        self
    }

    /// Returns all colliding pairs at q, sorted: indices `i < j` of triangles in the order of the mesh.
    ///
    /// # Errors
    /// When q has the wrong length, an entry is not finite, or q moves vertices beyond
    /// [`limits::LARGEST`](crate::limits::LARGEST); when the query was cancelled; when there are more than
    /// [`Detector::MAX_PAIRS`](crate::Detector::MAX_PAIRS) pairs; when this thread's arithmetic is not that of IEEE 754
    /// ([`Error::Arithmetic`]), which a query that the root's radius answers does not check.
    pub fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.discrete_at_most(q, usize::MAX)
    }

    /// Returns at most `limit` colliding pairs at q, sorted; which ones is not fixed. Where the limit stopped the query,
    /// [`Statistics::complete`] is false: there may be more.
    ///
    /// # Errors
    /// As [`Query::discrete`]; more pairs than the maximum are an error only where `limit` is above the maximum.
    pub fn discrete_at_most(&mut self, q: &[f64], limit: usize) -> Result<&[Pair], Error> {
        self.forget();
        let configuration = self.measure(q)?;
        self.find_pairs(configuration, limit)?;
        Ok(self.pairs())
    }

    /// Returns one colliding pair at q, if there is any; which one is not fixed.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn first(&mut self, q: &[f64]) -> Result<Option<Pair>, Error> {
        Ok(self.discrete_at_most(q, 1)?.first().copied())
    }

    /// Returns the number of colliding pairs at q.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn count(&mut self, q: &[f64]) -> Result<usize, Error> {
        Ok(self.discrete(q)?.len())
    }

    /// Clears the last answer and its cost.
    #[inline]
    pub(super) fn forget(&mut self) {
        self.norm = 0.0;
        self.statistics = Statistics::default();
        self.discrete.narrow.0.list.clear();
    }

    /// Checks that q is a configuration of the model, and measures it.
    #[inline(always)]
    pub(super) fn measure<'q>(&mut self, q: &'q [f64]) -> Result<Configuration<'q>, Error> {
        self.check.measure(&self.context, q)
    }

    /// Finds at most `limit` colliding pairs at a configuration, after [`Self::forget`].
    ///
    /// # Errors
    /// When the query was cancelled, there are more pairs than their maximum number, which is below `limit`, or this thread's
    /// arithmetic is not that of IEEE 754.
    #[inline(always)]
    pub(super) fn find_pairs(&mut self, configuration: Configuration<'_>, limit: usize) -> Result<(), Error> {
        self.norm = configuration.norm;
        // Most queries of a simulation end here.
        if self.context.is_proven_free(self.norm) {
            self.statistics = Statistics::PROVEN_FREE;
            return Ok(());
        }
        let Self { context, discrete, statistics, .. } = self;
        discrete.find_pairs(context, configuration, limit.min(Detector::MAX_PAIRS), statistics)?;
        Detector::check_limit(limit, statistics.complete)
    }

    /// Returns the pairs that the last query found; after [`Query::continuous`] those of its impacts.
    pub fn pairs(&self) -> &[Pair] {
        &self.discrete.narrow.0.list
    }

    /// Returns the cost of the last query, also of one that ended with an error.
    pub fn statistics(&self) -> Statistics {
        Statistics { norm: self.norm, ..self.statistics }
    }

    /// Returns `|z| = |S (q - center)|` of the last query, rounded up, in the metric and about the centre of its scope; for a
    /// continuous query the larger norm of start and end.
    pub(crate) fn norm(&self) -> f64 {
        self.norm
    }
}

impl Scope {
    /// Returns the scope of a query: metric and centre of its norms ([`Statistics::norm`]), and which pairs count.
    pub fn of_query(query: &Query) -> &Self {
        &query.context.scope
    }
}
