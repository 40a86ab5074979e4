//! Example shapes, made in code: the same bits on every machine.

mod spring;
mod tube;

pub use spring::spring;
