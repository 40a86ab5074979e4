//! Exact self-collision detection for reduced deformable models: a triangle mesh that deforms by r modes,
//! `x = p + U q` (blendshapes, PCA components, modal analysis).
//!
//! [`Certificates::compute`] is called once. It builds a bounding volume hierarchy (BVH) and finds *certified radii*:
//! within them, in q-space, nodes and node pairs of the hierarchy provably do not collide. A [`Query`] then answers which
//! triangles collide at q (discrete) or between two q (continuous, CCD). Where the root's certificate holds, the answer is
//! one comparison. Elsewhere the broad phase opens only nodes whose certificates do not hold, and the narrow phase tests
//! triangles with exact predicates. The method is *Subspace Self-Collision Culling* (Barbič and James, SIGGRAPH 2010), with
//! bounds that hold for any modes of any rank and account for every rounding error.
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
//! Data flows one way: [`TriMesh`] and [`Modes`] make a [`ReducedModel`]; from it follow a [`parts::Hierarchy`] and
//! [`Certificates`]; a [`Query`] reads both. Clones of models and certificates share their data, and no query, detector
//! or body has a lifetime parameter, so any structure can own it. This crate reads no files and no clock and prints
//! nothing. It needs `std`; without the feature `parallel` (on by default) it starts no thread and does not need rayon,
//! and gives the same bits. Positions are vectors of [`glam`], which it re-exports.
//!
//! # Any mesh
//!
//! A [`Detector`] needs no modes: it answers for any positions of a mesh.
//!
//! ```
//! use sscc::glam::DVec3;
//! use sscc::{Detector, TriMesh};
//!
//! # fn main() -> Result<(), sscc::Error> {
//! let rest = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
//! let mut detector = Detector::new(&TriMesh::new(rest.clone(), vec![[0, 1, 2], [3, 4, 5]])?);
//! assert!(detector.discrete(&rest)?.is_empty());
//! let flat: Vec<DVec3> = rest.iter().map(|x| x.with_z(0.0)).collect();
//! assert_eq!(detector.discrete(&flat)?, [(0, 1)]);
//! # Ok(())
//! # }
//! ```
//!
//! # Guarantees
//!
//! An empty answer is a proof that no two triangles that count have a point in common, and a list of pairs has exactly those
//! that do. Continuous queries miss no impact; [`Query::continuous`] states how close a pair without contact may come and
//! still be listed. `docs/guarantees.md` in the repository states the promise in full, with its assumptions.
//!
//! # Which method for which question
//!
//! | question | method |
//! | --- | --- |
//! | Which triangles of any mesh collide at given positions, or between two sets of them? | [`Detector::discrete`], [`Detector::continuous`] |
//! | Which triangles of two meshes collide? | [`Detector::against`], [`Detector::continuous_against`] |
//! | Which triangles are nearer than a distance, and what is the smallest distance? | [`Detector::within`], [`Detector::nearest`], at q [`Query::within`] |
//! | Is a mesh inside another one? | [`Detector::enclosed`] |
//! | Which triangles collide at q? | [`Query::discrete`] |
//! | Does any pair of triangles collide at q? | [`Query::first`], which stops at the first pair |
//! | Which pairs collide at q, at most n? | [`Query::discrete_at_most`] |
//! | How many pairs collide at q? | [`Query::count`] |
//! | Which triangles collide at each of many q? | [`Query::batch`], on all cores |
//! | How much did that cost, and did the root's certificate hold? | [`Query::statistics`] |
//! | Which collide between one q and another, and when? | [`Query::continuous`], [`Query::time_of_impact`] |
//! | Which collide at each small step of a motion? | [`KineticQuery::discrete`] |
//! | How far towards q does the shape stay free? | [`Query::safe_scale`] |
//! | How far can the weight of a mode go until the shape touches itself? | [`Query::sweep`], [`Query::sweep_modes`] |
//! | Over which intervals of the weight does it collide, and how deep? | [`Query::sweep_intervals`] |
//! | Which free q is near a colliding one? | [`Query::resolve`], [`Query::resolve_batch`] |
//! | Which free q are near the draws of a distribution? | [`Query::free_samples`] |
//! | Which q on the line to the centre is free by the root's certificate? | [`Certificates::clamp`] |
//! | Which positions do vertices have at q? | [`ReducedModel::positions`] |
//! | Which triangles collide at q, without certificates? | [`Query::without_certificates`], for models that change often |
//! | Which triangles collide at q, by another method? | [`Query::with_method`], [`Method`], for comparison |
//! | Do the certificates hold under attack, and how tight are they? | [`audit()`] |
//! | Do shapes in the world collide with each other? | [`parts::PosedShape`], [`parts::SweptShape`] |
//! | Do two triangles intersect? | [`intersect_triangle_triangle`] |
//! | Which points do two triangles have in common? | [`parts::intersection_triangle_triangle`] |
//! | What is the smallest translation that separates two triangles? | [`parts::penetration_triangle_triangle`] |
//! | Along which curves does a mesh intersect itself or another, and how deep is each pair? | [`parts::contact_curves`], [`parts::contact_curves_between`] |
//! | Do two moving triangles meet, and when? | [`impact_triangle_triangle`] |
//!
//! Below the root's radius ([`Certificates::root_radius`]) an answer is one comparison, however large the mesh, and the
//! tests of exceptions, if there are any. Above it a query costs at most about as much as refitting all boxes and
//! testing the triangles whose boxes overlap.
//!
//! # Which pairs count
//!
//! Touching counts. Triangles that share a vertex always touch, so the contact filter ([`ContactFilter`]) decides which pairs
//! count:
//!
//! - [`Neighbours`]: by default triangles that share a vertex never count. Optionally, triangles that share exactly
//!   one vertex count if they have another point in common; for meshes without modes also those that share an edge or all
//!   vertices, if they are folded onto each other.
//! - *Weld*: whether vertices of equal position and modes are one vertex. Files for rendering (STL, glTF) split vertices
//!   along seams; without welding, the triangles on both sides of a seam share no vertex, and always collide. Readers of such
//!   files mark the mesh ([`TriMesh::with_split_vertices`]), and then welding is the default.
//! - *Ignored* pairs never count.
//! - *Groups* ([`TriangleGroups`]): pairs of triangles within or between groups count or not by a table.
//!
//! [`CertifyOptions`] sets the contact filter, certificates store it ([`Certificates::filter`]), and their queries use it.
//!
//! ```
//! use glam::DVec3;
//! use sscc::{Certificates, CertifyOptions, Error, Modes, Neighbours, ContactFilter, Query, ReducedModel, TriMesh};
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
//! let welded = plain.filter(ContactFilter::new(Neighbours::Exclude).weld(true));
//! assert!(!collide(&welded, 0.0)? && !collide(&welded, 1.0)?); // neighbours never count
//! let one_vertex = ContactFilter::new(Neighbours::IncludeOneVertex).weld(true);
//! let strict = welded.filter(one_vertex);
//! assert!(!collide(&strict, 0.0)? && collide(&strict, 1.0)?); // folded, they meet beside the corner
//! # Ok(())
//! # }
//! ```
//!
//! # Contacts at rest
//!
//! Closed lips touch, and many meshes intersect themselves somewhere. One such pair would make the radius of every node
//! that contains it 0. So the pairs that collide at rest (or at the centre, if one is given) become *exceptions*: no
//! radius covers them, every query tests them, and answers stay exact ([`Certificates::exceptions`]). The root's
//! certificate then proves all pairs free but the exceptions. There are at most half as many as triangles, or
//! [`CertifyOptions::max_exceptions`]; if more pairs collide there, none becomes an exception.
//!
//! [`CertifyOptions::ignore_rest`] excludes such pairs for good.
//!
//! # Metrics
//!
//! A radius is a length `|z| = |S q|` in q-space, and the [`Metric`] weights the modes. Answers are the same under every
//! metric, but the share of configurations that one comparison proves free depends on it.
//!
//! | metric | length `\|z\|` of a unit of a mode |
//! | --- | --- |
//! | [`Metric::displacement`] (default) | the largest distance that it moves a vertex |
//! | [`Metric::mass`] | the root of the sum of squared displacements of vertices, weighted by their areas |
//! | [`Metric::identity`] | 1 |
//! | [`Metric::from_weights`], [`Metric::from_scales`] | the root of a given weight, or a given scale |
//! | [`Metric::from_matrix`], [`Metric::from_factor`] | `sqrt(M_kk)` of a given dense matrix `M = S'S`, such as an inverse covariance |
//! | `energy_metric` in the crate `sscc-modes` | the root of its strain energy, for modes in which the stiffness is diagonal (paper, section 6) |
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
//! let options = CertifyOptions::default().metric(metric);
//! let certificates = Certificates::compute(&model, &options, &())?;
//! let mut query = Query::new(&model, &certificates)?;
//! query.discrete(&[0.5, 0.5])?;
//! let together = query.statistics().norm;
//! query.discrete(&[0.5, -0.5])?;
//! assert!(together < query.statistics().norm);
//! # Ok(())
//! # }
//! ```
//!
//! # Centres
//!
//! Radii are measured from the rest pose q = 0, or from another [`CertifyOptions::center`], such as the mean pose of a
//! motion. A model can have certificates about several centres.
//!
//! ```
//! # use glam::DVec3;
//! # use sscc::{Certificates, CertifyOptions, Modes, Proof, Query, ReducedModel, TriMesh};
//! # fn main() -> Result<(), sscc::Error> {
//! # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
//! # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
//! # let model = ReducedModel::new(mesh, modes)?;
//! // The two triangles of the first example, far apart: beyond the root's radius about the rest pose.
//! let q = [-2.0];
//! let options = CertifyOptions::default().center(vec![-1.0]);
//! for (options, proof) in [(CertifyOptions::default(), Proof::Local), (options, Proof::Radius)] {
//!     let certificates = Certificates::compute(&model, &options, &())?;
//!     let mut query = Query::new(&model, &certificates)?;
//!     assert!(query.discrete(&q)?.is_empty());
//!     assert_eq!(query.statistics().proof, proof);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Batches, threads, cancelling
//!
//! A query owns its memory and serves one thread; clone it for another, or use [`Query::batch`]. Certificates and batches
//! take a number of threads (`None` for all cores), and are the same for any number; without the feature `parallel`, which is on
//! by default, they run on the calling thread. Long work reports to a [`Progress`]. A [`CancelToken`] cancels it, or a single
//! query ([`Query::cancelled_by`]). The `Progress` `()` ignores reports and never cancels.
//!
//! ```
//! # use glam::DVec3;
//! # use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};
//! use sscc::CancelToken;
//!
//! # fn main() -> Result<(), sscc::Error> {
//! # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
//! # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
//! # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
//! # let model = ReducedModel::new(mesh, modes)?;
//! # let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
//! let mut query = Query::new(&model, &certificates)?;
//! let stop = CancelToken::new();
//! let answers = query.batch(&[[0.0], [0.5], [1.0], [2.0]], None, &stop)?;
//! let colliding: Vec<bool> = answers.iter().map(|answer| !answer.pairs.is_empty()).collect();
//! assert_eq!(colliding, [false, false, true, false]); // at 2 the second triangle has passed
//!
//! let scale = query.safe_scale(&[1.5])?; // they touch two thirds of the way
//! assert!(scale > 0.5 && scale <= 2.0 / 3.0);
//!
//! stop.cancel(); // any thread may do so
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
//! # Sections of the paper
//!
//! | section | where |
//! | --- | --- |
//! | 3, hierarchy | `hierarchy/` |
//! | 3 and 4, Algorithm 1 | `query/certified_traversal.rs`, for the pair tree `query/pair_tree_traversal.rs`; BD-tree AABBs in `detect/bd_tree.rs` |
//! | 5.1, two triangles | `bounds/pair_refiner.rs`, `bounds/separating_direction.rs`, `bounds/affine_bound.rs` |
//! | 5.2, nodes and precomputation | `bounds/node_pair.rs`, `certificates/build/` |
//! | 6, scaling | [`Metric`] |
//! | 7, continuous queries | `query/continuous.rs`, `geometry/ccd/` |
//! | 7, collisions between objects | `posed/` |

#[macro_use]
mod mutants;
#[macro_use]
mod names;
#[macro_use]
mod setters;

mod arithmetic;
mod audit;
mod bounds;
mod cancel_token;
mod certificates;
mod curves;
mod detect;
mod disjoint_sets;
mod error;
mod filter;
mod geometry;
mod hierarchy;
pub mod limits;
mod min_heap;
mod model;
mod parallel;
pub mod parts;
mod posed;
mod progress;
mod query;
mod random;
#[cfg(test)]
mod test_models;
mod vectors;

pub use audit::{AuditOptions, AuditReport, audit};
pub use cancel_token::CancelToken;
pub use certificates::{Certificates, CertifyOptions};
pub use detect::{Answer, Clearance, Detector, Enclosed, Impact, NearPair, Proof, Statistics};
pub use error::Error;
pub use filter::{ContactFilter, Neighbours, Pair, TriangleGroups};
pub use geometry::{
    DISTANCE_ERROR, MovingTriangle, distance_triangle_triangle, impact_triangle_triangle,
    intersect_triangle_triangle,
};
pub use glam;
pub use model::{Metric, MetricKind, Modes, ReducedModel, TriMesh, deformed_position};
pub use progress::Progress;
pub use query::{
    FreeSamples, KineticQuery, Method, ModeRange, Query, ResolveOptions, Resolved, Sweep, SweepOutcome,
    WeightInterval, WeightIntervals, WeightSample,
};
