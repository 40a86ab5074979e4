//! An image, and its PNG file.

use super::color::{BACKGROUND, INK};

/// An RGB image with eight bits per channel, row by row from the top.
pub struct Image {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Image {
    /// Returns an image of the background.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, bytes: BACKGROUND.repeat(width * height) }
    }

    /// Copies rows of pixels into the image; `left` and `top` are the upper left corner.
    pub fn put(&mut self, left: usize, top: usize, width: usize, pixels: &[u8]) {
        for (row, from) in pixels.chunks_exact(3 * width).enumerate() {
            let at = 3 * ((top + row) * self.width + left);
            self.bytes[at..at + from.len()].copy_from_slice(from);
        }
    }

    /// Blends the colour of text into a pixel by this share; does nothing outside the image.
    pub fn ink(&mut self, x: usize, y: usize, share: f64) {
        if x < self.width && 3 * (y * self.width + x) < self.bytes.len() {
            let at = 3 * (y * self.width + x);
            for (byte, ink) in self.bytes[at..at + 3].iter_mut().zip(INK) {
                *byte = (f64::from(*byte) * (1.0 - share) + f64::from(ink) * share).round() as u8;
            }
        }
    }

    /// The colour of a pixel.
    #[cfg(test)]
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.bytes[at], self.bytes[at + 1], self.bytes[at + 2]]
    }

    /// Returns the bytes of a PNG file.
    pub fn encode(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.bytes)?;
        writer.finish()?;
        Ok(bytes)
    }
}
