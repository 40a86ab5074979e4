//! Tests of the command as a child process. They are one program, because linking takes long.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod bench;
mod clearance;
mod common;
mod contract;
mod data_sets;
mod detector;
mod detector_bad_input;
mod detector_models;
mod detector_report;
mod exact_poses;
mod folded;
mod formats;
mod guide;
mod help;
mod info;
mod interrupt;
mod left_out;
mod modes;
mod penetration;
mod picture;
mod places;
mod readers;
mod readme;
mod real_data;
mod resolve;
mod rows;
mod samples;
mod scenes;
mod scopes;
mod simulate;
mod statics;
mod sweep;
mod view;
mod vtk;
