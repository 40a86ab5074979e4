//! The package `sscc` of npm: models, certificates, queries and the detector of the core, for browsers and Node.
//!
//! `wasm-bindgen` exports the types below as classes of JavaScript. Arrays are typed arrays, which are copied at each call:
//! coordinates of points as 3 numbers for each vertex, faces as 3 numbers for each triangle, pairs as 2 numbers for each pair.
//! An error is an `Error` with one line. `cargo xtask wasm` builds the package; docs/wasm.md describes it.

mod arrays;
mod batch;
mod certificates;
mod detector;
mod impacts;
mod model;
mod options;
mod query;
mod statistics;

pub use batch::Batch;
pub use certificates::Certificates;
pub use detector::Detector;
pub use impacts::Impacts;
pub use model::Model;
pub use query::Query;
pub use statistics::Statistics;
