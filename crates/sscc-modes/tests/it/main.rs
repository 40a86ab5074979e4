//! Modes of real and made solids through the public interface. One program, so that the crate is linked once.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod common;
mod diagonalize;
mod energy;
mod hare_and_serpent;
mod matrix;
mod pca;
mod polynomial;
mod scales;
mod spring;
mod stiffness;
mod vega_a;
mod vibration;
