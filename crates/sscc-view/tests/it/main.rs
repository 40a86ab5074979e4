//! The page's data, its report and its server, through the public interface. One program of tests: linking is dear.
#![allow(clippy::unwrap_used)]

mod answers;
mod common;
mod report;
mod server;
