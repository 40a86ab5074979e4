//! The demo: an animation of the embedded spring, whose frames are checked by three methods.

mod animation;
mod frames;

pub use animation::demo_animation;
pub use frames::{Answers, Frames};
