//! Exact predicates of the oracles. They share no code with the core. Each is written for any kind of [`Number`] and
//! evaluated with intervals of doubles first. Where an interval contains 0, it is decided with integers of fixed width, or
//! with big integers. Most ordinary pairs of triangles are decided before that, by doubles with an error bound.

mod cones;
mod interval;
mod moving;
mod number;
mod point;
mod rounded;
mod segments;
mod separation;
mod triangles;
mod vectors;
mod whole;
mod wide;
pub mod work;

pub use moving::{Verdict, free_until};
pub use point::{Point, Triangle};
pub use triangles::{meet, meet_beyond_corner};
