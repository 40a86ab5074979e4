//! Reads point caches (`.pc2`): positions of all vertices of a mesh in each sample, in single precision.
//!
//! A header of 32 bytes (the text `POINTCACHE2` and a zero, version, number of points, start frame, sample rate, number of
//! samples) comes before the coordinates. All numbers are little-endian.

use std::path::Path;

use crate::file::read_whole;
use crate::{FormatError, IoError};

const MAGIC: &[u8] = b"POINTCACHE2\0";
const HEADER: usize = 32;

/// A point cache whose size has been checked.
pub struct PointCache {
    shape: [usize; 3],
    bytes: Vec<u8>,
}

impl PointCache {
    /// Reads a point cache.
    ///
    /// # Errors
    /// When the file cannot be read, is no point cache of version 1, or has another length than its header states.
    pub fn open(path: &Path) -> Result<Self, IoError> {
        let bytes = read_whole(path)?;
        let shape = parse_shape(&bytes).map_err(|error| error.of(path))?;
        Ok(Self { shape, bytes })
    }

    /// Returns the number of samples, the number of points, and 3.
    pub fn shape(&self) -> &[usize; 3] {
        &self.shape
    }

    /// Returns `length` coordinates from `start` on; both must be within the file.
    pub fn read(&self, start: usize, length: usize) -> Vec<f64> {
        let floats = &self.bytes[HEADER..].as_chunks().0[start..start + length];
        floats.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect()
    }
}

fn parse_shape(bytes: &[u8]) -> Result<[usize; 3], FormatError> {
    let refused = |cause: String| Err(FormatError::whole(cause));
    let Some((header, data)) = bytes.split_at_checked(HEADER).filter(|(header, _)| header.starts_with(MAGIC))
    else {
        return refused("the file is no point cache: its first 32 bytes are not a header POINTCACHE2".into());
    };
    let words = header[MAGIC.len()..].as_chunks().0;
    let number = |word: usize| i32::from_le_bytes(words[word]);
    let (version, points, samples) = (number(0), number(1), number(4));
    if version != 1 {
        return refused(format!("the point cache has version {version}; version 1 was expected"));
    }
    let (Ok(v), Ok(frames)) = (usize::try_from(points), usize::try_from(samples)) else {
        return refused(format!("the header states {samples} samples of {points} points"));
    };
    // 12 bytes a point: in 128 bits the product of two 31-bit numbers cannot overflow.
    let expected = 12 * frames as u128 * v as u128;
    if data.len() as u128 != expected {
        return refused(format!(
            "{samples} samples of {points} points need {expected} bytes, {} bytes follow the header: is the file cut off?",
            data.len()
        ));
    }
    Ok([frames, v, 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cache(version: i32, points: i32, samples: i32, coordinates: &[f32]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        for word in [version, points, 0, 1.0_f32.to_bits().cast_signed(), samples] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(coordinates.iter().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    #[test]
    fn coordinates_are_read_in_file_order() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.pc2");
        let coordinates: Vec<f32> = (0..12_u8).map(|i| f32::from(i) / 3.0).collect();
        std::fs::write(&path, cache(1, 2, 2, &coordinates)).unwrap();
        let read = PointCache::open(&path).unwrap();
        assert_eq!(read.shape(), &[2, 2, 3]);
        let expected: Vec<f64> = coordinates[6..].iter().map(|x| f64::from(*x)).collect();
        assert_eq!(read.read(6, 6), expected);
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = cache(1, 1, 2, &[0.0; 6]);
        parse_shape(&whole).unwrap();
        for length in 0..whole.len() {
            parse_shape(&whole[..length]).unwrap_err();
        }
        let long = [&whole[..], &[0]].concat();
        let magic = [b"X", &whole[1..]].concat();
        for (bytes, named) in [
            (long, "need 24 bytes, 25 bytes follow"),
            (magic, "no point cache"),
            (cache(2, 1, 2, &[0.0; 6]), "version 2"),
            (cache(1, -1, 2, &[0.0; 6]), "2 samples of -1 points"),
            (cache(1, i32::MAX, i32::MAX, &[0.0; 6]), "is the file cut off?"),
        ] {
            let message = parse_shape(&bytes).unwrap_err().cause().to_string();
            assert!(message.contains(named), "{message}");
        }
    }
}
