//! Tests of the C interface through its functions.
#![allow(unsafe_code, reason = "functions of C")]
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod answers;
#[cfg(target_arch = "x86_64")]
mod arithmetic;
mod bad_input;
mod callbacks;
mod common;
mod files;
mod handles;
mod header;
mod no_allocation;
mod threads;
