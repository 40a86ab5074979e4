//! Tests of dynamics through its public interface, against closed forms, conservation laws and brute force. They are one
//! program, so that the crate is linked once.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod bodies;
mod common;
mod contacts;
mod state;
mod step;
mod world;
