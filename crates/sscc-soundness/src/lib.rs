//! A campaign against the core: random and adversarial models, every public question, and oracles in exact arithmetic that share
//! no code with the core. `cargo xtask soundness` runs it; `docs/guarantees.md` has what it found.
//!
//! - `exact/`: predicates by intervals, then by big integers.
//! - `oracle.rs`: which pairs of a shape collide.
//! - `models/`: what is attacked; `setup.rs`: the same for the core, with certificates.
//! - `paths/`: a module for each kind of answer.
//! - `campaign.rs`, `record.rs`: what runs next, and the counters on disk.
// A campaign ends with a panic where its own oracle is wrong.
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
