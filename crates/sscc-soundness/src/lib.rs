//! A campaign of tests of the core: random and adversarial models, every public query, and oracles in exact arithmetic that
//! share no code with the core. `cargo xtask soundness` runs it; `docs/guarantees.md` states its results. To *attack* an
//! answer means to search for a counterexample in exact arithmetic.
//!
//! - `exact/`: predicates by intervals, then by big integers.
//! - `oracle.rs`: decides which pairs of a shape collide.
//! - `models/`: the adversarial models; `setup.rs`: the same models for the core, with certificates.
//! - `paths/`: a module for each kind of answer.
//! - `campaign.rs`, `record.rs`: the order of configurations, and the counters on disk.
// A campaign panics if its own oracle is wrong.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable)]

mod campaign;
mod exact;
mod models;
mod oracle;
mod paths;
mod random;
mod record;
mod setup;
mod tally;

pub use campaign::{Campaign, replay, run, run_quick};
pub use paths::PATHS;
pub use record::Record;
pub use tally::Tally;
