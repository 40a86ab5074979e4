//! An image, and its PNG file.

use super::color::BACKGROUND;

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
