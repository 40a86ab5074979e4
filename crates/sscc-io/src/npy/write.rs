//! Writer for NumPy arrays.

use std::path::Path;

use crate::{IoError, write_whole};

/// Returns the bytes of a `.npy` file (version 1.0, little-endian f8, C order) with this shape; `None` if the number of
/// values does not fit the shape, or the shape has more than 32 axes.
pub fn to_bytes(shape: &[usize], values: &[f64]) -> Option<Vec<u8>> {
    let entries = shape.iter().try_fold(1_usize, |n, axis| n.checked_mul(*axis));
    if entries != Some(values.len()) || shape.len() > 32 {
        return None;
    }
    // (3,) has a comma in Python, (3, 4) needs none.
    let axes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let comma = if axes.len() == 1 { "," } else { "" };
    let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}{comma}), }}", axes.join(", "));
    // Padded with spaces and one line end, so that the data begins at a multiple of 64.
    const PREFIX: usize = 10;
    let body = (PREFIX + text.len() + 1).next_multiple_of(64);
    let mut bytes = Vec::with_capacity(body + 8 * values.len());
    bytes.extend(b"\x93NUMPY\x01\x00");
    bytes.extend(((body - PREFIX) as u16).to_le_bytes()); // 32 axes of 20 digits fit
    bytes.extend(text.as_bytes());
    bytes.resize(body - 1, b' ');
    bytes.push(b'\n');
    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    Some(bytes)
}

/// Writes an array of f64 (C order: last axis fastest) as `.npy`.
///
/// # Errors
/// When the number of values does not fit the shape, or the file cannot be written.
pub fn write_npy(path: &Path, shape: &[usize], values: &[f64]) -> Result<(), IoError> {
    let Some(bytes) = to_bytes(shape, values) else {
        let cause = format!("{} values do not fill an array of shape {shape:?}", values.len());
        return Err(IoError::request(path, cause));
    };
    write_whole(path, &bytes)
}
