//! Certificates: radii in q-space within which parts of a model provably do not collide with themselves
//! (paper, sections 4 and 5).

mod digest;
mod global;
mod precompute;
mod search;

use crate::hierarchy::Hierarchy;
use crate::{Error, Metric, MetricKind, Progress, ReducedModel};

pub use digest::Digest;
pub(crate) use precompute::child_pairs;
pub(crate) use search::Search;

/// How certificates are computed.
#[derive(Clone, Debug)]
pub struct CertifyOptions {
    /// Relative error allowed for each radius, in (0, 1): a radius is at least `1 - epsilon` times the exact
    /// one, unless it is capped or a subdivision limit is reached. Paper, section 5.1: 0.1.
    pub epsilon: f64,
    /// The metric; none: the model's default.
    pub metric: Option<Metric>,
    /// Number of threads; none: all cores. The result is the same for any number.
    pub threads: Option<usize>,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self { epsilon: 0.1, metric: None, threads: None }
    }
}

/// Everything that a query needs to know about a model to skip work that provably finds nothing.
///
/// All radii are norms `|z| = |S q|` in the metric of the certificates. A radius R of a set of triangle pairs
/// promises: at any q with `|S q| < R` no pair of the set that is not adjacent has a point in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificates {
    parts: CertificateParts,
}

/// The contents of [`Certificates`], for reading and writing files.
#[derive(Clone, Debug, PartialEq)]
pub struct CertificateParts {
    /// What the certificates speak of.
    pub digest: Digest,
    /// The hierarchy over the triangles.
    pub hierarchy: Hierarchy,
    /// The metric in which radii are measured.
    pub metric: Metric,
    /// Relative error that was allowed.
    pub epsilon: f64,
    /// `R_global`: radii are resolved up to here (paper, section 5.2); infinite when no mode moves anything.
    pub global_radius: f64,
    /// `R_n` of each node: no two non-adjacent triangles of the node meet. At most that of any child.
    pub node_radii: Vec<f64>,
    /// `R_nm` of each pair of children of the root, in the order (0,1), (0,2), ..., (2,3).
    pub root_pair_radii: Vec<f64>,
    /// Number of colliding pairs at rest (q = 0).
    pub rest_collisions: u64,
}

impl Certificates {
    /// Computes the hierarchy and all certificates of a model: every `R_n`, and `R_nm` for the children of the
    /// root (paper, section 5.2).
    ///
    /// # Errors
    /// When an option is out of range, the metric does not fit the model, or `progress` cancels.
    pub fn compute(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        precompute::compute(model, options, progress).map(|parts| Self { parts })
    }

    /// Takes certificates from their parts, as read from a file whose integrity has been checked.
    ///
    /// # Errors
    /// When the parts do not fit together.
    pub fn from_parts(parts: CertificateParts) -> Result<Self, Error> {
        let damaged = |what: &str| Err(Error::Certificates(what.to_owned()));
        let nodes = parts.hierarchy.nodes();
        if parts.node_radii.len() != nodes.len() {
            return damaged("there is not one radius for each node");
        }
        let children = nodes[0].child_count as usize;
        if parts.root_pair_radii.len() != children * children.saturating_sub(1) / 2 {
            return damaged("there is not one radius for each pair of the root's children");
        }
        let radii = parts.node_radii.iter().chain(&parts.root_pair_radii);
        if radii.clone().any(|r| r.is_nan() || *r < 0.0) {
            return damaged("a radius is negative or not a number");
        }
        if parts.global_radius.is_nan() || parts.global_radius <= 0.0 {
            return damaged("the global radius is not positive");
        }
        if parts.root_pair_radii.iter().any(|r| *r < parts.node_radii[0]) {
            return damaged("the root's radius exceeds that of a pair of its children");
        }
        if !(parts.epsilon > 0.0 && parts.epsilon < 1.0) {
            return damaged("epsilon is not between 0 and 1");
        }
        for (node, radius) in nodes.iter().zip(&parts.node_radii) {
            if node.children().any(|child| parts.node_radii[child as usize] < *radius) {
                return damaged("a node's radius exceeds that of a child");
            }
        }
        Ok(Self { parts })
    }

    /// The contents, for writing.
    pub fn parts(&self) -> &CertificateParts {
        &self.parts
    }

    /// The hierarchy over the triangles.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.parts.hierarchy
    }

    /// The metric in which radii are measured.
    pub fn metric(&self) -> &Metric {
        &self.parts.metric
    }

    /// The radius of the root: at any q with `|S q|` below it the whole model is free.
    pub fn root_radius(&self) -> f64 {
        self.parts.node_radii[0]
    }

    /// `R_global`, up to which radii are resolved.
    pub fn global_radius(&self) -> f64 {
        self.parts.global_radius
    }

    /// `R_n` of a node.
    pub fn node_radius(&self, node: u32) -> f64 {
        self.parts.node_radii[node as usize]
    }

    /// Number of colliding pairs at rest.
    pub fn rest_collisions(&self) -> u64 {
        self.parts.rest_collisions
    }

    /// Refuses a model that the certificates do not speak of.
    ///
    /// # Errors
    /// When faces, positions or modes differ in any bit from those that were certified, or the hierarchy is not
    /// over as many triangles.
    pub fn check_model(&self, model: &ReducedModel) -> Result<(), Error> {
        let found = Digest::of(model, &self.parts.metric);
        if found == self.parts.digest {
            return if self.parts.hierarchy.order().len() == model.mesh().faces().len() {
                Ok(())
            } else {
                Err(Error::Certificates("the hierarchy is of another mesh".to_owned()))
            };
        }
        Err(Error::OtherModel { certificates: self.parts.digest.short(), model: found.short() })
    }
}

/// Names of the metric kinds, for messages.
pub fn metric_names() -> Vec<&'static str> {
    [MetricKind::Displacement, MetricKind::Mass, MetricKind::Identity].map(MetricKind::name).to_vec()
}
