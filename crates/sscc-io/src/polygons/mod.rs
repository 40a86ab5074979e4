//! Polygons of mesh files and their triangles.
//!
//! A polygon of n corners becomes n - 2 triangles in its place in the file: the fan around its first corner where the
//! fan triangulates it, else triangles that are cut off at ears ([`ears`]). Positions decide, by exact predicates on a
//! coordinate projection ([`plane`]), so the triangles are the same on every machine.

mod collector;
mod ear_candidates;
mod ears;
mod fan;
mod plane;
mod simple;
mod soup;
mod triangulation;
mod work;

pub(crate) use collector::Polygons;
pub(crate) use soup::Soup;
