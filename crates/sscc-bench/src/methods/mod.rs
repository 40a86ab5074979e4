//! The compared methods: ours and peers.

mod columns;
mod engine;
mod parry;
#[cfg(test)]
mod tests;

pub use columns::{COLUMNS, Column, Role};
pub use engine::Engine;
