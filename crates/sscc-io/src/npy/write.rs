//! Writer for NumPy arrays.

use std::path::{Path, PathBuf};

use crate::file::WholeFile;
use crate::{IoError, write_whole};

/// Returns the bytes of a `.npy` file (version 1.0, little-endian f8, C order) with this shape; `None` if the number of
/// values does not fit the shape, or the shape has more than 32 axes.
pub fn to_bytes(shape: &[usize], values: &[f64]) -> Option<Vec<u8>> {
    let entries = shape.iter().try_fold(1_usize, |n, axis| n.checked_mul(*axis));
    if entries != Some(values.len()) {
        return None;
    }
    let mut bytes = header(shape)?;
    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    Some(bytes)
}

/// Returns the bytes before the values; None if the shape has more than 32 axes.
fn header(shape: &[usize]) -> Option<Vec<u8>> {
    if shape.len() > 32 {
        return None;
    }
    // (3,) has a comma in Python, (3, 4) needs none.
    let axes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let comma = if axes.len() == 1 { "," } else { "" };
    let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}{comma}), }}", axes.join(", "));
    // Padded with spaces and one line end, so that the data begins at a multiple of 64.
    const PREFIX: usize = 10;
    let body = (PREFIX + text.len() + 1).next_multiple_of(64);
    let mut bytes = Vec::with_capacity(body);
    bytes.extend(b"\x93NUMPY\x01\x00");
    bytes.extend(((body - PREFIX) as u16).to_le_bytes()); // 32 axes of 20 digits fit
    bytes.extend(text.as_bytes());
    bytes.resize(body - 1, b' ');
    bytes.push(b'\n');
    Some(bytes)
}

/// Writes an array of f64 (C order: last axis fastest) as `.npy`.
///
/// # Errors
/// When the number of values does not fit the shape, the shape has more than 32 axes, or the file cannot be written.
pub fn write_npy(path: &Path, shape: &[usize], values: &[f64]) -> Result<(), IoError> {
    let Some(bytes) = to_bytes(shape, values) else {
        let cause = format!("{} values do not fill an array of shape {shape:?}", values.len());
        return Err(IoError::request(path, cause));
    };
    write_whole(path, &bytes)
}

/// An array of f64 (C order: last axis fastest) that is written in parts, as `.npy`. The file replaces its target when it is
/// complete, and is removed otherwise.
pub struct NpyWriter {
    path: PathBuf,
    file: WholeFile,
    /// Number of values that are still to come.
    missing: usize,
}

impl NpyWriter {
    /// Begins a file with this shape.
    ///
    /// # Errors
    /// When the shape has too many entries or more than 32 axes, or the file cannot be written.
    pub fn create(path: &Path, shape: &[usize]) -> Result<Self, IoError> {
        let entries = shape.iter().try_fold(1_usize, |n, axis| n.checked_mul(*axis));
        let (Some(missing), Some(header)) = (entries, header(shape)) else {
            return Err(IoError::request(path, format!("an array of shape {shape:?} is too large")));
        };
        let mut file = WholeFile::create(path)?;
        file.write(&header)?;
        Ok(Self { path: path.to_owned(), file, missing })
    }

    /// Appends values.
    ///
    /// # Errors
    /// When they do not fit the shape, or the file cannot be written.
    pub fn push(&mut self, values: &[f64]) -> Result<(), IoError> {
        let Some(missing) = self.missing.checked_sub(values.len()) else { return Err(self.unfit()) };
        self.missing = missing;
        self.file.write(&values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
    }

    /// Completes the file.
    ///
    /// # Errors
    /// When values are missing, or the file cannot be written.
    pub fn finish(self) -> Result<(), IoError> {
        if self.missing > 0 {
            return Err(self.unfit());
        }
        self.file.finish()
    }

    fn unfit(&self) -> IoError {
        IoError::request(&self.path, "the number of values does not fit the shape of the array")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_written_in_parts_equal_those_written_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.npy");
        let values: Vec<f64> = (0..24).map(|i| f64::from(i) / 7.0).collect();
        let mut writer = NpyWriter::create(&path, &[4, 2, 3]).unwrap();
        values.chunks(6).for_each(|part| writer.push(part).unwrap());
        assert!(!path.exists() && writer.push(&[0.0]).is_err());
        writer.finish().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), to_bytes(&[4, 2, 3], &values).unwrap());
        // If values are missing, the old file is kept, and no other file remains.
        let mut writer = NpyWriter::create(&path, &[4, 2, 3]).unwrap();
        writer.push(&values[1..]).unwrap();
        assert!(writer.finish().is_err() && NpyWriter::create(&path, &[usize::MAX, 2]).is_err());
        assert_eq!(std::fs::read(&path).unwrap(), to_bytes(&[4, 2, 3], &values).unwrap());
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }
}
