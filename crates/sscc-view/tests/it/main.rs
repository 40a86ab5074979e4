//! Tests of the page's data, its reports and its server, through the public interface. All tests are one program, since
//! linking takes long.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod answers;
mod common;
mod load;
mod mesh_report;
mod report;
mod server;
