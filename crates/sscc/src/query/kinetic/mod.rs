//! Kinetic queries: one query's results are used again in the next ones, as long as q stays near.
//!
//! A search at one z, with the boxes and radii of all z in a ball around it, finds every pair that can collide anywhere
//! in the ball. Each of them gets a safe distance: two triangles that are separated stay so until z has travelled their
//! gap over the rate at which it can close. A pair whose safe distance is used up gets a new one. Pairs that collide or
//! nearly do have no useful safe distance: they are active. While z stays in the ball, a query tests only the active
//! pairs. That is a Verlet list (Verlet 1967) with a safe distance for each pair.

mod ball_control;
mod ball_pairs;
mod ball_search;
mod kinetic_query;
mod safe_distance;
#[cfg(test)]
mod tests;

pub use kinetic_query::KineticQuery;
