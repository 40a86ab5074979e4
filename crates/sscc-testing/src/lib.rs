//! Support for tests and benches: exact oracles, real models, and the number of random cases.
// Tests end with a panic.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable)]

mod cases;
mod distance;
mod dyadic;
mod first_contact;
mod flexible;
mod grid;
mod models;
mod partition;
mod polynomial;

pub use cases::{cases, threshold};
pub use distance::{distance, squared_distance};
pub use dyadic::{Dyadic, common_denominator};
pub use first_contact::first_contact;
pub use flexible::{FlexibleShape, Numbers, Shape};
pub use models::{SKIP_LOG, models, skip};
pub use polynomial::Root;
