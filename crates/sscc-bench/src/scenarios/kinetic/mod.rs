//! Scenario `kinetic`: a spring that vibrates, 44,100 steps per second.

mod kinetic_bench;
mod kinetic_record;
mod vibration;

pub use kinetic_bench::KineticBench;
pub use kinetic_record::KineticRecord;
