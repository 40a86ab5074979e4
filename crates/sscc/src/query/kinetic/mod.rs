//! Kinetic queries: the results of one query are used in the next ones, as long as q stays near.
//!
//! A search with the volumes and radii of all z in a region finds every pair that can collide anywhere in the region. Each
//! of them gets a safe distance: two triangles that are separated stay so until z has travelled their gap over the rate at
//! which it can close. A pair whose safe distance is used up gets a new one. Pairs that collide or nearly do have no useful
//! safe distance: they are active. While z stays in the region, a query tests only the active pairs. That is a Verlet list
//! (Verlet 1967) with a safe distance for each pair.
//!
//! If the motion of z is nearly straight, the region is a capsule along the predicted motion, otherwise a ball. A capsule costs
//! little more than a swept query and lasts for tens of steps (docs/notes/queries.md#capsules).

mod kinetic_query;
mod region;
mod region_control;
mod region_pairs;
mod region_search;
mod safe_distance;
mod step_history;
#[cfg(test)]
mod tests;

pub use kinetic_query::KineticQuery;
