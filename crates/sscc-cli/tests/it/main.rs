//! The command as its users run it. One program of tests: linking is dear.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod bench;
mod common;
mod contract;
mod formats;
mod help;
mod interrupt;
mod modes;
mod picture;
mod readme;
mod real_data;
mod scopes;
mod simulate;
mod view;
