//! Reads numbers from untrusted bytes.

/// Reads little-endian numbers one after the other. Each method that reads a number returns None if the bytes end, or
/// the number is out of range.
pub(super) struct ByteReader<'a>(&'a [u8]);

impl<'a> ByteReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.0.is_empty()
    }

    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.bytes().map(u8::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.bytes().map(u64::from_le_bytes)
    }

    /// Reads a radius, which must not be negative or NaN.
    pub(super) fn radius(&mut self) -> Option<f64> {
        self.bytes().map(f64::from_le_bytes).filter(|x| *x >= 0.0)
    }

    /// Reads a radius in single precision, which must not be negative or NaN.
    pub(super) fn single_radius(&mut self) -> Option<f32> {
        self.bytes().map(f32::from_le_bytes).filter(|x| *x >= 0.0)
    }
}
