//! Measures methods on steps: processor times, interleaved, with equal answers.

mod agreement;
mod clock;
mod comparison;
mod kinetic;
mod mismatch;
mod step;
mod timer;
mod times;

pub use clock::{median, seconds};
pub use comparison::{Comparison, Kinds, compare};
pub use kinetic::time_kinetic;
pub use step::Step;
pub use timer::REPETITIONS;
pub use times::Times;
