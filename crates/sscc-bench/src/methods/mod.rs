//! The compared methods: ours and peers.

mod approximate_cones;
mod columns;
mod engine;
mod parry;

pub use columns::{COLUMNS, Column, Role};
pub use engine::Engine;
