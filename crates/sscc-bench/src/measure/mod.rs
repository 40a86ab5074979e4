//! Measures methods on steps: processor times, interleaved, with equal answers.

mod agreement;
mod clock;
mod comparison;
mod distance;
mod interleaved;
mod kinetic;
mod mismatch;
mod step;
mod times;

pub use clock::{median, seconds};
pub use comparison::{Comparison, Kinds, compare};
pub use interleaved::REPETITIONS;
pub use kinetic::time_kinetic;
pub use step::Step;
pub use times::Times;
