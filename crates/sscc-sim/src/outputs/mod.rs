//! The files of a simulation: summary, trajectories, costs, animation, sound and report.

mod animation;
mod arrays;
mod files;
mod sound;

pub use files::Outputs;
pub use sound::SoundTrack;
