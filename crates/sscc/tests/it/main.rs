//! Tests of the core through its public interface, against brute force and exact arithmetic. They are one program, so that the
//! core is linked once; the tests that count allocations are a separate program.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod audit;
mod batch;
mod body_penetration;
mod cancel;
mod ccd;
mod certificates;
mod certified_clearance;
mod clearance;
mod clusters;
mod common;
mod contact_curves;
mod continuous;
mod detector;
mod few_modes;
mod folded;
mod groups;
mod impact;
mod impact_tolerance;
mod intersect;
mod intersection;
mod kinetic;
mod limits;
mod local_certificates;
mod near_layers;
mod neighbours;
mod normal_cones;
mod owned;
mod pair_tree;
mod pair_tree_traversal;
mod penetration;
mod reach;
mod resolve;
mod rounding;
mod safe_scale;
mod statistics;
mod sweep;
mod sweep_intervals;
