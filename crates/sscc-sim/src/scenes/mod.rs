//! Scenes: models, bodies, ground and sound, as TOML files. docs/simulations.md explains the keys.

mod bodies;
mod models;
mod scene;
mod section;
mod shake;
mod shipped;
#[cfg(test)]
mod tests;

pub use bodies::BodySpec;
pub use models::ModelSpec;
pub use scene::{Scene, Sound};
pub use shake::{Shake, ShakeUnit};
pub use shipped::{OWN_AMPLITUDE_SCENES, SHIPPED, read_scene};
