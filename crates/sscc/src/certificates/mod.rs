//! Certificates: radii in q-space within which parts of a model provably do not collide with themselves
//! (paper, sections 4 and 5).

mod build;
mod digest;
mod pair_tree;
mod remote;
mod scope;

use crate::hierarchy::Hierarchy;
use crate::{Error, Metric, Pair, PairRule, Progress, ReducedModel};

pub(crate) use build::search::{ROUGH, Search};
pub use digest::Digest;
pub use pair_tree::PairTree;
pub(crate) use pair_tree::{Entry as PairEntry, roots_of};
pub use remote::{BUILD, RunJobs, ShardWorker};
pub use scope::Scope;

/// How certificates are computed.
#[derive(Clone, Debug)]
pub struct CertifyOptions {
    /// Relative error allowed, in (0, 1): the root's radius is at least `1 - epsilon` times the exact one. So is each
    /// other radius outside the pair tree that may be as small. Larger ones come from growing the pair tree, as far as
    /// that went: with an error of at least a quarter, or more where only subdivision would tell. Beyond it they are
    /// searched with an error of at least 0.4 and few subdivisions, because queries so far out open many nodes anyway.
    /// Unless a radius is capped or a limit of the search (subdivisions, candidates waiting) is reached. Paper, section
    /// 5.1: 0.1.
    pub epsilon: f64,
    /// The metric; none: the model's default.
    pub metric: Option<Metric>,
    /// The configuration about which radii are measured (r); none: q = 0, the rest pose.
    pub center: Option<Vec<f64>>,
    /// Which pairs of triangles count.
    pub rule: PairRule,
    /// Whether the rule is to ignore the pairs that collide at rest (q = 0), too: they are never listed.
    pub ignore_rest: bool,
    /// How many exceptions there may be: pairs that collide at the centre, left out of every radius and tested
    /// in every query. Where more pairs collide there are none, and radii of parts that contain such
    /// a pair are 0. None: [`CertifyOptions::default_exceptions`].
    pub max_exceptions: Option<usize>,
    /// Memory for the pair tree ([`PairTree`]), in bytes for each triangle of the mesh; a pair takes 8. The pairs of
    /// the smallest radii are stored, so a budget is a choice of the tree's limit ([`PairTree::limit`]): queries with
    /// `|z|` below it never open what only touches. 0: no tree, which is the paper's scheme of one radius for each node
    /// and each pair of the root's children; right where certificates serve a few queries only, since the tree takes
    /// most of the time of computing them.
    pub budget: usize,
    /// Number of threads; none: all cores. The result is the same for any number.
    pub threads: Option<usize>,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self {
            epsilon: 0.1,
            metric: None,
            center: None,
            rule: PairRule::default(),
            ignore_rest: false,
            max_exceptions: None,
            budget: Self::DEFAULT_BUDGET,
            threads: None,
        }
    }
}

impl CertifyOptions {
    /// Bytes for each triangle, if nothing is said.
    pub const DEFAULT_BUDGET: usize = 16;

    /// How many exceptions a mesh may have if nothing is said: half the number of its triangles. Testing more costs
    /// as much as radii can save.
    pub fn default_exceptions(triangles: usize) -> usize {
        triangles.div_ceil(2)
    }
}

/// Everything that a query needs to know about a model to skip work that provably finds nothing.
///
/// All radii are norms `|z| = |S (q - center)|` in the metric of the certificates. A radius R of a set of triangle
/// pairs promises: at any q with `|z| < R` no pair of the set that counts under the rule has a point in common,
/// exceptions apart.
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
    /// What they speak of beside the model: metric, centre, rule, exceptions.
    pub scope: Scope,
    /// Relative error that was allowed of the root's radius; see [`CertifyOptions::epsilon`].
    pub epsilon: f64,
    /// `R_global`: radii are resolved up to here (paper, section 5.2); infinite when no mode moves anything.
    pub global_radius: f64,
    /// `R_n` of each node: no two non-adjacent triangles of the node meet. At most that of any child. Nodes below a
    /// bucket ([`Node::is_bucket`](crate::hierarchy::Node::is_bucket)) have its radius.
    pub node_radii: Vec<f64>,
    /// `R_nm` of each pair of children of the root, in the order (0,1), (0,2), ..., (2,3).
    pub root_pair_radii: Vec<f64>,
    /// Radii of pairs of nodes, all below its limit.
    pub pair_tree: PairTree,
    /// Number of colliding pairs at rest (q = 0), ignored ones included.
    pub rest_collisions: u64,
}

impl Certificates {
    /// Computes the hierarchy and all certificates of a model: every `R_n`, `R_nm` for the children of the
    /// root (paper, section 5.2), and the pair tree within [`CertifyOptions::budget`].
    ///
    /// # Errors
    /// When an option is out of range, the metric does not fit the model, or `progress` cancels.
    pub fn compute(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        build::node_radii::compute(model, options, progress).map(|parts| Self { parts })
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
        if parts.scope.center.len() != parts.scope.metric.rank() {
            return damaged("centre and metric are of different ranks");
        }
        if parts.scope.center.iter().any(|x| !x.is_finite()) {
            return damaged("the centre is not finite");
        }
        let (exceptions, ignored) = (&parts.scope.exceptions, parts.scope.rule.ignored());
        if !exceptions.is_sorted_by(|a, b| a < b) || exceptions.iter().any(|(i, j)| i >= j) {
            return damaged("exceptions are not sorted pairs");
        }
        if exceptions.iter().any(|pair| ignored.binary_search(pair).is_ok()) {
            return damaged("a pair is an exception and ignored");
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
        if let Err(what) = parts.pair_tree.pairs(&parts.hierarchy) {
            return damaged(&format!("pair tree: {what}"));
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
        &self.parts.scope.metric
    }

    /// The configuration from which radii are measured (r).
    pub fn center(&self) -> &[f64] {
        &self.parts.scope.center
    }

    /// Which pairs of triangles count.
    pub fn rule(&self) -> &PairRule {
        &self.parts.scope.rule
    }

    /// Pairs that no radius speaks of and every query tests, sorted.
    pub fn exceptions(&self) -> &[Pair] {
        &self.parts.scope.exceptions
    }

    /// The radius of the root: at any q with `|S (q - center)|` below it the whole model is free, exceptions apart.
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
        let found = Digest::of(model, &self.parts.scope);
        if found != self.parts.digest {
            return Err(Error::OtherModel { certificates: self.parts.digest.short(), model: found.short() });
        }
        let damaged = |what: &str| Err(Error::Certificates(what.to_owned()));
        let triangles = model.mesh().faces().len();
        if self.parts.hierarchy.order().len() != triangles {
            return damaged("the hierarchy is of another mesh");
        }
        if self.metric().rank() != model.rank() {
            return damaged("the metric is of another rank");
        }
        if self.exceptions().iter().chain(self.rule().ignored()).any(|(_, j)| *j as usize >= triangles) {
            return damaged("a pair names a triangle that does not exist");
        }
        model.check_coordinates(self.center()).map(|_| ())
    }

    /// Refuses another rule of what counts than the one that was certified.
    ///
    /// # Errors
    /// When neighbours, weld or ignored pairs differ.
    pub fn check_rule(&self, rule: &PairRule) -> Result<(), Error> {
        let known = self.rule();
        let what = if known.neighbours != rule.neighbours {
            format!(
                "they were made with the neighbour rule {}, not {}",
                known.neighbours.name(),
                rule.neighbours.name()
            )
        } else if known.weld != rule.weld {
            format!("they were made with{} welding", if known.weld { "" } else { "out" })
        } else if known.ignored() != rule.ignored() {
            format!("they ignore {} pairs, not {}, or others", known.ignored().len(), rule.ignored().len())
        } else {
            return Ok(());
        };
        Err(Error::OtherPairs { what })
    }

    /// `|z| = |S (q - center)|`, rounded up: what radii are compared with.
    ///
    /// # Panics
    /// When q has not one entry for each mode.
    pub fn norm(&self, q: &[f64]) -> f64 {
        self.parts.scope.norm(q)
    }

    /// q itself where it is inside the root's ellipsoid, else the last point inside on the straight way from the centre
    /// to q: free by the root's certificate. None where the root's radius is 0, or there are exceptions (the radius
    /// says nothing of them).
    ///
    /// # Errors
    /// As [`ReducedModel::check_coordinates`] for a model of this rank: length and finite entries.
    pub fn clamp(&self, q: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let center = self.center();
        if q.len() != center.len() {
            return Err(Error::CoordinatesLength { found: q.len(), rank: center.len() });
        }
        if let Some(index) = q.iter().position(|x| !x.is_finite()) {
            return Err(Error::CoordinatesValue { index, value: q[index] });
        }
        let root = self.root_radius();
        if root <= 0.0 || !self.exceptions().is_empty() {
            return Ok(None);
        }
        let mut offset = vec![0.0; q.len()];
        let mut inside = |q: &[f64]| self.metric().norm_from(q, center, &mut offset);
        let mut clamped = q.to_vec();
        let norm = inside(&clamped);
        let mut scale = if norm.is_finite() { root / norm } else { 0.5 };
        // A few roundings away at most; far away where the norm overflows.
        for _ in 0..4096 {
            if inside(&clamped) < root {
                return Ok(Some(clamped));
            }
            for ((x, q), c) in clamped.iter_mut().zip(q).zip(center) {
                *x = c + (q - c) * scale;
            }
            scale *= 1.0 - 4.0 * f64::EPSILON;
            if norm.is_infinite() {
                scale *= 0.5;
            }
        }
        Ok(Some(center.to_vec()))
    }
}
