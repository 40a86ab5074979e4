//! Queries: which pairs of triangles collide at q, or between two q, with traversals that certificates cull (paper,
//! Algorithm 1 and section 7).

mod batch;
mod certified_search;
mod certified_traversal;
mod context;
mod discrete_search;
mod kinetic;
mod method;
mod node_pair;
mod pair_tree_traversal;
mod query;
mod root_ball;
mod safe_scale;
mod statistics;
mod swept;
mod swept_search;

pub use batch::Answer;
pub use kinetic::KineticQuery;
pub use method::Method;
pub use query::Query;
pub use statistics::Statistics;
