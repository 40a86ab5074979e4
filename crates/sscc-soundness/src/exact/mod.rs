//! Exact predicates of the oracles. They share no code with the core: each is written for any kind of [`Number`], tried with
//! intervals of doubles first, and decided with whole numbers, of fixed width or big, where an interval contains 0. Ordinary
//! pairs of triangles are decided before, by doubles with an error bound.

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
