//! Proven self-collision detection for reduced deformable models: a triangle mesh that deforms by r modes,
//! `x = p + U q`.
//!
//! Once, [`Certificates::compute`] finds radii in q-space within which parts of the model provably cannot hit
//! themselves. From then on a [`Query`] answers "does the shape collide with itself at q?" exactly: mostly by one
//! comparison, and where certificates fail by a traversal that opens only what they could not rule out. The method
//! is *Subspace Self-Collision Culling* (Barbič and James, SIGGRAPH 2010), with bounds that hold for any
//! modes of any rank and for the floating-point positions themselves.
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
//! # What is promised
//!
//! - **Free is proven.** No pairs listed means that no two triangles without a common vertex have a point in
//!   common. There is no tolerance, and no false negative.
//! - **Colliding is exact.** The pairs listed are all those that intersect or touch, and no others, sorted, the
//!   same on every machine and for every number of threads.
//! - Both speak of one shape: the f64 positions given by [`deformed_position`].
//!
//! # Where the paper is
//!
//! | section | here |
//! | --- | --- |
//! | 3, hierarchy | [`hierarchy`] |
//! | 3 and 4, Algorithm 1 | [`Query`] (`query/traversal.rs`, with BD-tree boxes in `query/bd_tree.rs`) |
//! | 5.1, two triangles | `bounds/triangle_pair.rs`, `direction.rs`, `affine.rs` |
//! | 5.2, nodes and precomputation | `bounds/cluster.rs`, `certificates/` |
//! | 6, scaling | [`Metric`] |
//!
//! Data flows one way: [`TriMesh`] and [`Modes`] make a [`ReducedModel`]; that makes a [`hierarchy::Hierarchy`] and
//! [`Certificates`]; a [`Query`] reads both. This crate reads no files, knows no clock and prints nothing.

mod audit;
mod bounds;
mod certificates;
mod error;
pub mod hierarchy;
mod intersect;
pub mod limits;
mod mesh;
mod metric;
mod model;
mod modes;
mod pairs;
mod progress;
mod query;
mod threads;

pub use audit::{AuditOptions, AuditReport, audit};
pub use certificates::{CertificateParts, Certificates, CertifyOptions, Digest, Scope};
pub use error::Error;
pub use intersect::{intersect_beyond_vertex, intersect_triangle_triangle};
pub use mesh::TriMesh;
pub use metric::{Metric, MetricKind, vertex_areas};
pub use model::ReducedModel;
pub use modes::{Modes, deformed_position};
pub use pairs::{Neighbours, Pair, PairRule};
pub use progress::Progress;
pub use query::{Answer, Method, Query, Statistics};
