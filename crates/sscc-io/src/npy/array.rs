//! Arrays in memory, and the decoding of their numbers.

use super::header::{Class, Header, Item, NumberKind};
use crate::{FormatError, Place};

/// An array of numbers: f64, narrower floats and integers, all as f64; or integers, as i64.
#[derive(Clone, Debug, PartialEq)]
pub struct Array<T = f64> {
    shape: Vec<usize>,
    /// Stride of each axis in `data`.
    strides: Vec<usize>,
    pub(super) data: Vec<T>,
}

/// Integers up to this one have the same value as f64.
const MAX_EXACT_INTEGER: u64 = 1 << 53;

/// Parses a `.npy` file, versions 1 to 3, with numbers of type f8, f4 or f2, or integers, in either byte order, in C
/// or Fortran order.
///
/// # Errors
/// When the header is malformed or has another type, or the length of the data differs from the header; when an integer is
/// beyond 2^53.
pub fn parse(bytes: &[u8]) -> Result<Array, FormatError> {
    array(bytes, NumberKind::Floats, floats)
}

/// Parses a `.npy` file of signed or unsigned integers of 1, 2, 4 or 8 bytes; else as [`parse`].
///
/// # Errors
/// As [`parse`], but an integer may be as large as i64 allows.
pub fn parse_integers(bytes: &[u8]) -> Result<Array<i64>, FormatError> {
    array(bytes, NumberKind::Integers, integers)
}

/// Returns the number of entries whose bytes follow the header; None if the header is malformed or has another type.
pub(crate) fn entry_count(bytes: &[u8]) -> Option<u64> {
    let header = Header::parse(bytes, NumberKind::Floats).ok()?;
    let body_bytes = bytes.len().checked_sub(header.body)?;
    body_bytes.checked_div(header.item.size).map(|count| count as u64)
}

fn array<T>(
    bytes: &[u8],
    wanted: NumberKind,
    decode: impl Fn(Item, &[u8]) -> Result<Vec<T>, FormatError>,
) -> Result<Array<T>, FormatError> {
    let Header { item, fortran, shape, body } = Header::parse(bytes, wanted)?;
    let body_bytes = &bytes[body..];
    check_size(&shape, item, body, body_bytes.len() as u64)?;
    Ok(Array { strides: strides(&shape, fortran), data: decode(item, body_bytes)?, shape })
}

/// Returns an error if `found` bytes from offset `body` are not an array of this shape.
pub(super) fn check_size(shape: &[usize], item: Item, body: usize, found: u64) -> Result<(), FormatError> {
    let size = shape.iter().try_fold(item.size as u64, |size, n| size.checked_mul(*n as u64));
    if size == Some(found) {
        return Ok(());
    }
    let cause = format!(
        "the header declares shape {shape:?} of {}-byte numbers, but {found} bytes follow: is the file cut off?",
        item.size
    );
    Err(FormatError::new(Place::Byte(body), cause))
}

impl<T: Copy> Array<T> {
    /// Returns an array of that shape from its entries in C order (last axis fastest); None if their number differs.
    pub fn from_c_order(shape: &[usize], data: Vec<T>) -> Option<Self> {
        let size = shape.iter().try_fold(1_usize, |size, n| size.checked_mul(*n));
        (size == Some(data.len())).then(|| Self {
            shape: shape.to_vec(),
            strides: strides(shape, false),
            data,
        })
    }

    /// Returns the length of each axis; the product is the number of entries.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns one entry; `index` has one number per axis.
    ///
    /// # Panics
    /// When the entry would be beyond the data. Another index beyond the shape returns another entry.
    pub fn at<const N: usize>(&self, index: [usize; N]) -> T {
        self.data[index.iter().zip(&self.strides).map(|(i, stride)| i * stride).sum::<usize>()]
    }

    /// Returns all entries in C order (last axis fastest).
    pub fn to_c_order(&self) -> Vec<T> {
        if self.is_c_order() { self.data.clone() } else { self.reordered() }
    }

    /// As [`Array::to_c_order`]. Entries that are in C order already are moved.
    pub fn into_c_order(self) -> Vec<T> {
        if self.is_c_order() { self.data } else { self.reordered() }
    }

    fn is_c_order(&self) -> bool {
        self.strides == strides(&self.shape, false)
    }

    fn reordered(&self) -> Vec<T> {
        let mut index = vec![0; self.shape.len()];
        let mut at = 0;
        (0..self.data.len())
            .map(|_| {
                let value = self.data[at];
                for axis in (0..index.len()).rev() {
                    index[axis] += 1;
                    at += self.strides[axis];
                    if index[axis] < self.shape[axis] {
                        break;
                    }
                    at -= self.strides[axis] * self.shape[axis];
                    index[axis] = 0;
                }
                value
            })
            .collect()
    }
}

/// Returns the stride of each axis. Products saturate only for empty arrays, which have no entries.
fn strides(shape: &[usize], fortran: bool) -> Vec<usize> {
    let mut strides = vec![0; shape.len()];
    let mut stride = 1_usize;
    let mut set = |axis: usize| {
        strides[axis] = stride;
        stride = stride.saturating_mul(shape[axis]);
    };
    if fortran {
        (0..shape.len()).for_each(&mut set)
    } else {
        (0..shape.len()).rev().for_each(&mut set)
    }
    strides
}

/// Decodes floats, and integers as floats.
pub(super) fn floats(item: Item, bytes: &[u8]) -> Result<Vec<f64>, FormatError> {
    if item.class != Class::Float {
        let exact = |value: i64| match value.unsigned_abs() {
            ..=MAX_EXACT_INTEGER => Ok(value as f64),
            _ => Err(FormatError::whole(format!(
                "the integer {value} is beyond 2^53: save the array as float64"
            ))),
        };
        return decoded(item, bytes, exact);
    }
    let twos = || bytes.as_chunks::<2>().0.iter().copied();
    let eights = || bytes.as_chunks::<8>().0.iter().copied();
    let fours = || bytes.as_chunks::<4>().0.iter().copied();
    Ok(match (item.size, item.big) {
        (8, false) => eights().map(f64::from_le_bytes).collect(),
        (8, true) => eights().map(f64::from_be_bytes).collect(),
        (2, false) => twos().map(|b| half(u16::from_le_bytes(b))).collect(),
        (2, true) => twos().map(|b| half(u16::from_be_bytes(b))).collect(),
        (_, false) => fours().map(|b| f32::from_le_bytes(b).into()).collect(),
        (_, true) => fours().map(|b| f32::from_be_bytes(b).into()).collect(),
    })
}

/// Returns the value of a float of 16 bits: a sign, 5 bits of exponent, 10 of mantissa.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, mantissa) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    sign * match exponent {
        0 => libm::ldexp(mantissa, -24),
        31 if mantissa == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => libm::ldexp(mantissa + 1024.0, exponent - 25),
    }
}

fn integers(item: Item, bytes: &[u8]) -> Result<Vec<i64>, FormatError> {
    decoded(item, bytes, Ok)
}

/// Decodes integers, and converts each one at once, so that there is no second array of wide numbers.
fn decoded<T>(
    item: Item,
    bytes: &[u8],
    convert: impl Fn(i64) -> Result<T, FormatError>,
) -> Result<Vec<T>, FormatError> {
    let mut numbers = Vec::with_capacity(bytes.len() / item.size);
    for bytes in bytes.chunks_exact(item.size) {
        numbers.push(convert(integer(item, bytes)?)?);
    }
    Ok(numbers)
}

/// Decodes one integer.
fn integer(item: Item, bytes: &[u8]) -> Result<i64, FormatError> {
    let widen = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
    let magnitude = if item.big { bytes.iter().fold(0, widen) } else { bytes.iter().rev().fold(0, widen) };
    match item.class {
        // Two shifts extend the sign from the top bit of the item to 64 bits.
        Class::Signed => Ok((magnitude << (64 - 8 * bytes.len())) as i64 >> (64 - 8 * bytes.len())),
        _ => i64::try_from(magnitude)
            .map_err(|_| FormatError::whole(format!("the integer {magnitude} is too large"))),
    }
}
