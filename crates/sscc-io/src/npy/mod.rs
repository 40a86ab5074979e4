//! NumPy arrays (`.npy`) of floating point numbers.
//!
//! A reader of our own. The npyz crate hands the header to a general parser of Python literals whose time is
//! exponential in the number of open brackets: a file of 60 bytes keeps it busy for years. Here the header can
//! only be what NumPy writes for an array of numbers. The tests compare the two on good files.

mod header;
mod write;

use crate::{FormatError, Place};
use header::{Header, Item};

pub use write::{to_bytes, write_npy};

/// An array of f64 or f32 numbers, widened to f64.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    shape: Vec<usize>,
    /// How far apart in `data` neighbours along each axis are.
    strides: Vec<usize>,
    data: Vec<f64>,
}

/// Parses a `.npy` file, versions 1 to 3: numbers of type f8 or f4, of either byte order, in C or
/// Fortran order.
///
/// # Errors
/// When the header is malformed or of another type, or the data is not exactly as long as the header says.
pub fn parse(bytes: &[u8]) -> Result<Array, FormatError> {
    let Header { item, fortran, shape, body } = Header::parse(bytes)?;
    let body_bytes = &bytes[body..];
    let size = shape.iter().try_fold(item.size(), |size, n| size.checked_mul(*n));
    if size != Some(body_bytes.len()) {
        let cause = format!(
            "the header says shape {shape:?} of {}-byte numbers, but {} bytes follow: is the file cut off?",
            item.size(),
            body_bytes.len()
        );
        return Err(FormatError::new(Place::Byte(body), cause));
    }
    Ok(Array { strides: strides(&shape, fortran), data: item.decode(body_bytes), shape })
}

impl Array {
    /// The length of each axis. Their product is the number of entries.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// One entry; `index` has one number for each axis.
    ///
    /// # Panics
    /// When the index is beyond the shape.
    pub fn at<const N: usize>(&self, index: [usize; N]) -> f64 {
        self.data[index.iter().zip(&self.strides).map(|(i, stride)| i * stride).sum::<usize>()]
    }

    /// All entries in C order (last axis fastest).
    pub fn to_c_order(&self) -> Vec<f64> {
        if self.strides == strides(&self.shape, false) {
            return self.data.clone();
        }
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

/// For an array that holds something the products are below its size; an empty one has no entries to find.
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

impl Item {
    fn decode(self, bytes: &[u8]) -> Vec<f64> {
        let eights = || bytes.as_chunks::<8>().0.iter().copied();
        let fours = || bytes.as_chunks::<4>().0.iter().copied();
        match self {
            Self::F64Little => eights().map(f64::from_le_bytes).collect(),
            Self::F64Big => eights().map(f64::from_be_bytes).collect(),
            Self::F32Little => fours().map(|b| f32::from_le_bytes(b).into()).collect(),
            Self::F32Big => fours().map(|b| f32::from_be_bytes(b).into()).collect(),
        }
    }
}

#[cfg(test)]
mod tests;
