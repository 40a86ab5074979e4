//! Proven self-collision detection for reduced deformable models: a triangle mesh that deforms by r modes,
//! `x = p + U q` (blendshapes, PCA components, modal analysis).
//!
//! Once, [`Certificates::compute`] finds radii in q-space within which parts of the model provably cannot hit
//! themselves. From then on a [`Query`] answers "does the shape collide with itself at q?" exactly: by one
//! comparison where the deformation is small, and where certificates fail by a traversal that opens only what they
//! could not rule out. The method is *Subspace Self-Collision Culling* (Barbič and James, SIGGRAPH 2010), with
//! bounds that hold for any modes of any rank and for the floating-point positions themselves.
//!
//! # First use
//!
//! ```
//! use glam::DVec3;
//! use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};
//!
//! # fn main() -> Result<(), sscc::Error> {
//! // Two triangles one unit apart, and one mode that moves the second towards the first.
//! let positions = vec![
//!     DVec3::ZERO, DVec3::X, DVec3::Y,
//!     DVec3::Z, DVec3::X + DVec3::Z, DVec3::Y + DVec3::Z,
//! ];
//! let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
//! let model = ReducedModel::new(mesh, modes)?; // displacement metric
//!
//! let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
//! let mut query = Query::new(&model, &certificates)?; // refuses certificates of another model
//! assert!(query.discrete(&[0.5])?.is_empty());
//! assert!(query.statistics().root_certified); // proven by one comparison
//! assert_eq!(query.discrete(&[1.0])?, [(0, 1)]); // they touch
//! # Ok(())
//! # }
//! ```
//!
//! Data flows one way: [`TriMesh`] and [`Modes`] make a [`ReducedModel`]; that makes a [`hierarchy::Hierarchy`] and
//! [`Certificates`]; a [`Query`] reads both. This crate reads no files, knows no clock and prints nothing.
//!
//! # What is promised
//!
//! - **Free is proven.** No pairs listed means that no two triangles that count (by default: without a common
//!   vertex) have a point in common. There is no tolerance, and no false negative.
//! - **Colliding is exact.** The pairs listed are all those that intersect or touch, and no others, sorted, the
//!   same on every machine and for every number of threads.
//! - Both speak of one shape: the f64 positions given by [`deformed_position`].
//!
//! Continuous queries are about the straight way of every vertex from one q to another: none that meets is missed, and
//! what is listed without need has come within a stated tolerance ([`Query::continuous`]). Certificates hold for the
//! mesh, the modes and the metric they were computed for, to the last bit, and say so: [`Query::new`] refuses any other
//! model.
//!
//! # Which question, which method
//!
//! | question | answer |
//! | --- | --- |
//! | Which triangles collide at q? | [`Query::discrete`] |
//! | Do any? | [`Query::first`], which stops at the first pair |
//! | Some of them, at most n? | [`Query::discrete_at_most`] |
//! | How many? | [`Query::count`] |
//! | The same for many q? | [`Query::batch`], on all cores |
//! | What did that cost, and was it proven by the root alone? | [`Query::statistics`] |
//! | Which meet on the way from one q to another, and when? | [`Query::continuous`], [`Query::time_of_impact`] |
//! | How far towards q is the shape free all the way? | [`Query::safe_scale`] |
//! | The q on the way there at which one comparison is proof? | [`Certificates::clamp`] |
//! | Where are the vertices at q? | [`ReducedModel::positions`] |
//! | The same without certificates, for models that change all the time? | [`Query::without_certificates`] |
//! | The same by another method, to compare? | [`Query::with_method`], [`Method`] |
//! | Can the certificates be trusted, and how tight are they? | [`audit()`] |
//! | Do two triangles meet? | [`intersect_triangle_triangle`] |
//! | Do two moving triangles, and when? | [`impact_triangle_triangle`] |
//!
//! Below the root's radius ([`Certificates::root_radius`]) an answer is one comparison, whatever the size of the
//! mesh. Above it a query costs about as much as refitting all boxes: what is fast is knowing that nothing collides.
//!
//! # Which pairs count
//!
//! Touching counts. Triangles that share a vertex always touch, so a [`PairRule`] says which pairs are asked for:
//!
//! - [`Neighbours`]: triangles that share a vertex do not count, or those that share exactly one count where
//!   they meet beside it.
//! - *Weld*: whether vertices of equal position and modes are one vertex. Files for drawing (STL, glTF) split
//!   vertices along seams; without welding, the triangles on both sides of a seam share none, and always
//!   collide.
//! - *Ignored* pairs never count.
//!
//! [`CertifyOptions`] asks for a rule, the certificates keep it ([`Certificates::rule`]), and their queries answer by
//! it.
//!
//! ```
//! use glam::DVec3;
//! use sscc::{Certificates, CertifyOptions, Error, Modes, Neighbours, PairRule, Query, ReducedModel, TriMesh};
//!
//! # fn main() -> Result<(), Error> {
//! // Two triangles that meet in a corner, each with a vertex of its own there. The mode folds the second onto
//! // the first.
//! let corner = DVec3::ZERO;
//! let positions = vec![
//!     corner, DVec3::new(2.0, -1.0, 0.0), DVec3::new(2.0, 1.0, 0.0),
//!     corner, DVec3::new(1.0, 0.0, 1.0), DVec3::new(2.0, 0.0, 1.0),
//! ];
//! let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 12 && row % 3 == 2 { -1.0 } else { 0.0 })?;
//! let model = ReducedModel::new(mesh, modes)?;
//! let collide = |options: &CertifyOptions, q: f64| -> Result<bool, Error> {
//!     let certificates = Certificates::compute(&model, options, &())?;
//!     Ok(Query::new(&model, &certificates)?.first(&[q])?.is_some())
//! };
//!
//! let plain = CertifyOptions::default();
//! assert!(collide(&plain, 0.0)?); // they touch in the corner
//! let welded = CertifyOptions { rule: PairRule::new(Neighbours::Exclude, true), ..plain };
//! assert!(!collide(&welded, 0.0)? && !collide(&welded, 1.0)?); // neighbours never count
//! let strict = CertifyOptions { rule: PairRule::new(Neighbours::IncludeOneVertex, true), ..welded };
//! assert!(!collide(&strict, 0.0)? && collide(&strict, 1.0)?); // folded, they meet beside the corner
//! # Ok(())
//! # }
//! ```
//!
//! # Contacts at rest
//!
//! Closed lips touch, and many meshes cut through themselves somewhere. One such pair would make the radius of every
//! node that holds it 0. So pairs that collide at rest (at the centre, where another is given) become *exceptions*: no
//! radius speaks of them, every query tests them, and answers stay exact ([`Certificates::exceptions`]). "Proven by
//! the root" then means: apart from the exceptions. There may be half as many as triangles, or
//! [`CertifyOptions::max_exceptions`].
//!
//! Where such pairs are of no interest, [`CertifyOptions::ignore_rest`] leaves them out for good.
//!
//! # Metrics
//!
//! A radius is a length `|z| = |S q|` in q-space, and the [`Metric`] says how the modes weigh. Answers are
//! the same under every metric; how much one comparison can prove is not.
//!
//! | metric | a unit of a mode counts |
//! | --- | --- |
//! | [`Metric::displacement`] (default) | as far as it moves any vertex: `\|z\|` is a length |
//! | [`Metric::mass`] | as much surface as it moves |
//! | [`Metric::identity`] | 1 |
//! | [`Metric::from_weights`], [`Metric::from_scales`] | what you say |
//! | [`Metric::from_matrix`], [`Metric::from_factor`] | what you say, with the other modes: dense `M = S'S`, such as an inverse covariance |
//! | `energy_metric` in the crate `sscc-modes` | its strain energy, for modes in which the stiffness is diagonal (paper, section 6) |
//!
//! A metric belongs to a model ([`ReducedModel::with_metric`]) or to certificates alone:
//!
//! ```
//! # use glam::DVec3;
//! # use sscc::{Certificates, CertifyOptions, Metric, MetricKind, Modes, Query, ReducedModel, TriMesh};
//! # fn main() -> Result<(), sscc::Error> {
//! # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
//! # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! # let modes = Modes::from_matrix(6, 2, |row, mode| f64::from(u8::from(row >= 9 && row % 3 == 2 - mode)))?;
//! # let model = ReducedModel::new(mesh, modes)?;
//! // A model with two modes, which occur together more often than against each other.
//! let inverse_covariance = [2.0, -1.0, -1.0, 2.0];
//! let metric = Metric::from_matrix(MetricKind::Given, 2, &inverse_covariance)?;
//! let options = CertifyOptions { metric: Some(metric), ..CertifyOptions::default() };
//! let certificates = Certificates::compute(&model, &options, &())?;
//! let mut query = Query::new(&model, &certificates)?;
//! query.discrete(&[0.5, 0.5])?;
//! let together = query.norm();
//! query.discrete(&[0.5, -0.5])?;
//! assert!(together < query.norm());
//! # Ok(())
//! # }
//! ```
//!
//! # Centres
//!
//! Radii are measured from the rest pose q = 0, or from any other [`CertifyOptions::center`]: the pose about which
//! a shape really moves. A model can have certificates about several.
//!
//! ```
//! # use glam::DVec3;
//! # use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};
//! # fn main() -> Result<(), sscc::Error> {
//! # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
//! # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
//! # let model = ReducedModel::new(mesh, modes)?;
//! // The two triangles of the beginning, far apart.
//! let q = [-2.0];
//! let options = CertifyOptions { center: Some(vec![-1.0]), ..CertifyOptions::default() };
//! for (options, certified) in [(CertifyOptions::default(), false), (options, true)] {
//!     let certificates = Certificates::compute(&model, &options, &())?;
//!     let mut query = Query::new(&model, &certificates)?;
//!     assert!(query.discrete(&q)?.is_empty());
//!     assert_eq!(query.statistics().root_certified, certified);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Batches, threads, cancelling
//!
//! A query owns its memory and serves one thread; clone it for another, or hand a batch over. Certificates and batches
//! take a number of threads (none: all cores), and are the same for any. Long work tells a [`Progress`] how far it
//! is, and stops when that says so; a single query stops by [`Query::cancelled_by`]. `()` is the `Progress` that does
//! neither.
//!
//! ```
//! # use glam::DVec3;
//! # use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};
//! use std::sync::atomic::{AtomicBool, Ordering};
//!
//! /// Set by another thread.
//! struct Stop(AtomicBool);
//!
//! impl sscc::Progress for Stop {
//!     fn report(&self, _done: usize, _total: usize) {}
//!
//!     fn is_cancelled(&self) -> bool {
//!         self.0.load(Ordering::Relaxed)
//!     }
//! }
//!
//! # fn main() -> Result<(), sscc::Error> {
//! # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
//! # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
//! # let model = ReducedModel::new(mesh, modes)?;
//! # let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
//! let mut query = Query::new(&model, &certificates)?;
//! let stop = Stop(AtomicBool::new(false));
//! let answers = query.batch(&[[0.0], [0.5], [1.0], [2.0]], None, &stop)?;
//! let colliding: Vec<bool> = answers.iter().map(|answer| !answer.pairs.is_empty()).collect();
//! assert_eq!(colliding, [false, false, true, false]); // at 2 the second triangle has passed
//!
//! let scale = query.safe_scale(&[1.5])?; // they touch two thirds of the way
//! assert!(scale > 0.5 && scale <= 2.0 / 3.0);
//!
//! stop.0.store(true, Ordering::Relaxed);
//! assert_eq!(query.batch(&[[0.5]], None, &stop), Err(sscc::Error::Cancelled));
//! # Ok(())
//! # }
//! ```
//!
//! # Files
//!
//! The crate `sscc-io` reads meshes, modes, glTF morph targets and whole models (`load_model`), and writes models,
//! certificates and poses. `sscc-modes` makes modes for a mesh that has none. The workspace's `examples/` has whole
//! programs.
//!
//! # Where the paper is
//!
//! | section | here |
//! | --- | --- |
//! | 3, hierarchy | [`hierarchy`] |
//! | 3 and 4, Algorithm 1 | [`Query`] (`query/traversal.rs` and `query/pair_walk.rs`, with BD-tree boxes in `query/bd_tree.rs`) |
//! | 5.1, two triangles | `bounds/triangle_pair.rs`, `direction.rs`, `affine.rs` |
//! | 5.2, nodes and precomputation | `bounds/cluster.rs`, `certificates/` |
//! | 6, scaling | [`Metric`] |

#[macro_use]
mod mutants;

mod audit;
mod bounds;
mod certificates;
mod detect;
mod error;
mod filter;
mod geometry;
mod heap;
pub mod hierarchy;
pub mod limits;
mod model;
mod posed;
mod progress;
mod query;
mod threads;

pub use audit::{AuditOptions, AuditReport, audit};
pub use certificates::{
    BUILD, CertificateParts, Certificates, CertifyOptions, Digest, PairTree, RunJobs, Scope, ShardWorker,
};
pub use error::Error;
pub use filter::{Neighbours, Pair, PairRule};
pub use geometry::{
    Aabb, MovingTriangle, impact_edge_edge, impact_triangle_triangle, impact_vertex_face,
    intersect_shared_vertex_pair, intersect_triangle_triangle,
};
pub use model::{Metric, MetricKind, Modes, ReducedModel, TriMesh, deformed_position, vertex_areas};
pub use posed::{Pose, PosedShape};
pub use progress::Progress;
pub use query::{Answer, Impact, KineticQuery, Method, Query, Statistics};
