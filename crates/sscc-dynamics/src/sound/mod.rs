//! Sound of vibrating bodies, and the materials that it is known for.

mod materials;
mod sound_bank;

pub use materials::{MATERIALS, SoundMaterial};
pub use sound_bank::SoundBank;
