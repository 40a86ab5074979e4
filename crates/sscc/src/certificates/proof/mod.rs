//! Proofs of certificates: witnesses with which a checker that shares no code with this crate can verify each stored radius.
//!
//! `entries` divides all pairs of triangles into entries, `prover` finds witnesses, `encoding` writes their bytes.

mod encoding;
mod entries;
mod prover;
#[cfg(test)]
mod tests;

pub use prover::Prover;
