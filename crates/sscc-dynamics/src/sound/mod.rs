//! Sound of vibrating bodies, and materials with known damping.

mod materials;
mod sound_bank;

pub use materials::{MATERIALS, SoundMaterial};
pub use sound_bank::SoundBank;
