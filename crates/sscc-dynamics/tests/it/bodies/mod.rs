//! Tests of bodies.

mod oscillators;
mod root_constraint;
mod shape;
