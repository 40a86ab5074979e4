//! The arrays of a `.vtu` file and their numbers.

use super::data::{Layout, from_base64, unsigned};
use crate::FormatError;
use crate::allowance::Allowance;
use crate::error::quoted;

/// An array of a file; its data is not decoded yet.
pub(super) struct Array<'a> {
    pub name: String,
    kind: Option<Kind>,
    /// The type as the file names it.
    type_name: String,
    pub components: usize,
    pub data: Data<'a>,
}

/// Location of the numbers of an array.
pub(super) enum Data<'a> {
    Ascii(&'a str),
    Base64(&'a str),
    /// Offset in the appended data.
    Appended(u64),
    /// A format that is not known.
    Unknown(String),
}

/// Type of a number, with its size in bytes.
#[derive(Clone, Copy)]
enum Kind {
    Float(usize),
    Signed(usize),
    Unsigned(usize),
}

impl Kind {
    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "Float32" => Self::Float(4),
            "Float64" => Self::Float(8),
            "Int8" => Self::Signed(1),
            "Int16" => Self::Signed(2),
            "Int32" => Self::Signed(4),
            "Int64" => Self::Signed(8),
            "UInt8" => Self::Unsigned(1),
            "UInt16" => Self::Unsigned(2),
            "UInt32" => Self::Unsigned(4),
            "UInt64" => Self::Unsigned(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Float(size) | Self::Signed(size) | Self::Unsigned(size) => size,
        }
    }
}

impl<'a> Array<'a> {
    pub fn new(name: String, type_name: String, components: usize, data: Data<'a>) -> Self {
        Self { name, kind: Kind::of_name(&type_name), type_name, components, data }
    }

    fn refused(&self, cause: impl Into<String>) -> FormatError {
        FormatError::part(format!("array {}", quoted(&self.name)), cause.into())
    }
}

/// Decodes the arrays of one file.
pub(super) struct Decoder<'a> {
    pub layout: Layout,
    /// The appended data after its `_`; None if the file has none.
    pub appended: Option<&'a [u8]>,
    /// Whether the appended data is base64.
    pub is_base64: bool,
    /// Offsets of all appended arrays: an array ends where the next one begins.
    pub offsets: Vec<u64>,
    pub allowance: Allowance,
}

impl Decoder<'_> {
    /// Returns `count` numbers.
    pub fn floats(&mut self, array: &Array<'_>, count: u64) -> Result<Vec<f64>, FormatError> {
        if let Data::Ascii(text) = array.data {
            return self.words(array, text, count, |word| word.parse().ok());
        }
        let (bytes, kind) = self.bytes(array, count)?;
        let order = self.layout.is_big_endian;
        let number = |bytes: &[u8]| match kind {
            Kind::Float(4) => f64::from(f32::from_bits(unsigned(bytes, order) as u32)),
            Kind::Float(_) => f64::from_bits(unsigned(bytes, order)),
            Kind::Signed(size) => signed(bytes, size, order) as f64,
            Kind::Unsigned(_) => unsigned(bytes, order) as f64,
        };
        Ok(bytes.chunks_exact(kind.size()).map(number).collect())
    }

    /// Returns `count` integers from 0.
    pub fn integers(&mut self, array: &Array<'_>, count: u64) -> Result<Vec<u64>, FormatError> {
        if let Data::Ascii(text) = array.data {
            return self.words(array, text, count, |word| word.parse().ok());
        }
        let (bytes, kind) = self.bytes(array, count)?;
        let order = self.layout.is_big_endian;
        let number = |bytes: &[u8]| match kind {
            Kind::Float(_) => None,
            Kind::Signed(size) => u64::try_from(signed(bytes, size, order)).ok(),
            Kind::Unsigned(_) => Some(unsigned(bytes, order)),
        };
        let numbers: Option<Vec<u64>> = bytes.chunks_exact(kind.size()).map(number).collect();
        numbers.ok_or_else(|| array.refused("integers from 0 were expected"))
    }

    fn words<T>(
        &mut self,
        array: &Array<'_>,
        text: &str,
        count: u64,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Vec<T>, FormatError> {
        let mut numbers = Vec::new();
        for word in text.split_ascii_whitespace() {
            let number = parse(word);
            numbers.push(
                number.ok_or_else(|| array.refused(format!("{} is no number of its type", quoted(word))))?,
            );
        }
        if numbers.len() as u64 != count {
            let found = numbers.len();
            return Err(array.refused(format!("it has {found} numbers, {count} are needed")));
        }
        Ok(numbers)
    }

    fn bytes(&mut self, array: &Array<'_>, count: u64) -> Result<(Vec<u8>, Kind), FormatError> {
        let refused = |cause: String| array.refused(cause);
        let Some(kind) = array.kind else {
            let known = "Float32, Float64, Int8 to Int64 and UInt8 to UInt64 are";
            return Err(refused(format!(
                "numbers of type {} are not supported: {known}",
                quoted(&array.type_name)
            )));
        };
        let size = kind.size() as u64;
        // The array, and its numbers of 8 bytes.
        self.allowance.take(count, size + 8).map_err(refused)?;
        let length = count.saturating_mul(size);
        let unpacked = match &array.data {
            Data::Appended(offset) => self.appended(*offset, length),
            Data::Base64(text) => {
                from_base64(text.as_bytes()).and_then(|bytes| self.layout.unpack(&bytes, length))
            }
            Data::Ascii(_) => Ok(Vec::new()), // not binary
            Data::Unknown(format) => {
                Err(format!("format {} is not known: ascii, binary and appended are", quoted(format)))
            }
        };
        Ok((unpacked.map_err(refused)?, kind))
    }

    fn appended(&self, offset: u64, length: u64) -> Result<Vec<u8>, String> {
        let Some(all) = self.appended else {
            return Err("the file has no appended data: is it cut off?".into());
        };
        let start = usize::try_from(offset).ok().filter(|start| *start <= all.len());
        let Some(start) = start else {
            return Err(format!("its offset {offset} is beyond the appended data of {} bytes", all.len()));
        };
        if !self.is_base64 {
            return self.layout.unpack(&all[start..], length);
        }
        let next = self.offsets.iter().copied().filter(|next| *next > offset).min();
        let end = next.map_or(all.len(), |next| usize::try_from(next).unwrap_or(usize::MAX).min(all.len()));
        self.layout.unpack(&from_base64(&all[start..end])?, length)
    }
}

/// Returns a signed number of `size` bytes.
fn signed(bytes: &[u8], size: usize, is_big_endian: bool) -> i64 {
    let shift = 64 - 8 * size as u32;
    (unsigned(bytes, is_big_endian) << shift).cast_signed() >> shift
}
