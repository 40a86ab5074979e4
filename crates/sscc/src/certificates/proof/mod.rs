//! Proofs of certificates: for each stored radius why it holds, for a checker that shares no code with this crate.
//!
//! `entries` divides all pairs of triangles into entries, `prover` finds witnesses, `encoding` has their bytes.

mod encoding;
mod entries;
mod prover;
#[cfg(test)]
mod tests;

pub use prover::Prover;
