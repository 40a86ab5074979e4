//! Colours, and the light on surfaces.

use glam::{DVec3, Vec3};

/// The background (sRGB).
pub const BACKGROUND: [u8; 3] = [246, 246, 244];

/// The colour of text (sRGB).
pub const INK: [u8; 3] = [40, 46, 54];

/// Colour of vertices with the smallest displacement (sRGB).
const STILL_COLOR: [u8; 3] = [176, 186, 198];

/// Colour of vertices with the largest displacement (sRGB).
const MOVED_COLOR: [u8; 3] = [216, 130, 72];

/// The direction of the main light: from the left, above and in front of the surface.
const KEY_LIGHT: DVec3 = DVec3::new(-0.45, 0.65, 0.75);

/// A colour in linear units of light.
#[derive(Clone, Copy)]
pub struct Linear(Vec3);

impl Linear {
    /// Converts from sRGB bytes.
    pub fn of(bytes: [u8; 3]) -> Self {
        let decode = |x: u8| {
            let x = f64::from(x) / 255.0;
            (if x <= 0.04045 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) }) as f32
        };
        Self(Vec3::from_array(bytes.map(decode)))
    }

    /// Converts to sRGB bytes.
    pub fn to_bytes(self) -> [u8; 3] {
        self.0.to_array().map(|x| {
            let x = f64::from(x.clamp(0.0, 1.0));
            let coded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 };
            (255.0 * coded).round() as u8
        })
    }
}

/// The colours of a surface, from the smallest to the largest displacement.
#[derive(Clone, Copy)]
pub struct Palette {
    still: Linear,
    moved: Linear,
}

impl Palette {
    /// Returns the palette of all pictures.
    pub fn new() -> Self {
        Self { still: Linear::of(STILL_COLOR), moved: Linear::of(MOVED_COLOR) }
    }

    /// Returns the colour of a surface with a normal (y up, z towards the viewer); `moved` is its displacement as a
    /// share of the largest.
    pub fn lit(&self, normal: DVec3, moved: f64) -> Linear {
        let key = normal.dot(KEY_LIGHT.normalize()).max(0.0);
        let sky = 0.5 + 0.5 * normal.y;
        let edge = 1.0 - normal.z.max(0.0);
        let rim = edge * edge * edge;
        let light = 0.16 + 0.22 * sky + 0.72 * key - 0.10 * rim;
        let base = self.still.0.lerp(self.moved.0, moved.clamp(0.0, 1.0) as f32);
        Linear(base * light as f32)
    }
}

/// Returns the mean of colours.
pub fn mean(colors: impl Iterator<Item = Linear>) -> Linear {
    let (sum, count) = colors.fold((Vec3::ZERO, 0.0), |(sum, count), color| (sum + color.0, count + 1.0));
    Linear(sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_round_trip() {
        for bytes in [BACKGROUND, STILL_COLOR, MOVED_COLOR, [0, 1, 255]] {
            assert_eq!(Linear::of(bytes).to_bytes(), bytes);
        }
    }
}
