//! Kinetic queries: reuse of one query's results in the next ones, as long as q stays near.
//!
//! A search at one z, with the boxes and radii of all z in a ball around it, finds every pair that can collide anywhere in
//! the ball. Each of them gets a safe distance: two triangles that are apart stay apart until z has moved by their gap over
//! the rate at which it can close. While z stays in the ball, a query tests only the active pairs: those whose safe
//! distance is used up, and those that collide or nearly do. That is a Verlet list (Verlet 1967) with a safe distance for
//! each pair.

mod ball_control;
mod ball_pairs;
mod ball_search;
mod kinetic_query;
mod safe_distance;
#[cfg(test)]
mod tests;

pub use kinetic_query::KineticQuery;
