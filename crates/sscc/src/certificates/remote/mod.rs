//! Certificates of one large model computed by many processes, with the same bytes as by one.
//!
//! [`compute_in_shards`] writes the tasks of each stage as jobs; the caller runs each by a [`ShardWorker`] in any process that
//! has the same model and options. Jobs and results are sealed: one that was damaged, or is of another model, other options or
//! another build, is refused.

mod byte_reader;
mod executor;
mod job;
mod job_result;
mod seal;
#[cfg(test)]
mod tests;
mod worker;

pub use executor::{RunJobs, compute_in_shards};
pub use seal::BUILD;
pub use worker::ShardWorker;
