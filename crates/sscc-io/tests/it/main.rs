//! Readers of real and hostile files. One program, so that the crate is linked once; tests that measure memory are programs
//! of their own.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod default_filter;
mod hostile;
mod real_data;
mod real_solids;
mod sweeps;
