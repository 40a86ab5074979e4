//! Example shapes, computed with the same bits on every machine.

mod capped_tube;
mod elastic;
mod hare;
mod implicit;
mod marching;
mod remesh;
mod serpent;
mod spring;
mod surface;
mod tube;

pub use elastic::{ElasticShape, elastic_hare, elastic_spring};
pub use hare::hare;
pub use serpent::serpent;
pub use spring::{spring, spring_of};
