//! Writer for archives of named arrays.

use std::io::{Cursor, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::npy;
use crate::{IoError, write_whole};

/// An array with its name, in C order (last axis fastest).
#[derive(Clone, Debug, PartialEq)]
pub struct NamedArray<'a> {
    /// Name in `numpy.load`.
    pub name: &'a str,
    /// The length of each axis.
    pub shape: Vec<usize>,
    /// Values; their number is the product of the shape.
    pub values: &'a [f64],
}

/// Writes arrays of f64 as `.npz`, uncompressed, in this order. The bytes are a function of the arrays.
///
/// # Errors
/// When the number of values does not fit a shape, a name is duplicated or invalid (allowed: letters, digits and `_`),
/// or the file cannot be written.
pub fn write_npz(path: &Path, arrays: &[NamedArray<'_>]) -> Result<(), IoError> {
    let bytes = to_bytes(arrays).map_err(|cause| IoError::request(path, cause))?;
    write_whole(path, &bytes)
}

fn to_bytes(arrays: &[NamedArray<'_>]) -> Result<Vec<u8>, String> {
    let size = arrays.iter().map(|array| 8 * array.values.len() + 1024).sum();
    let mut writer = ZipWriter::new(Cursor::new(Vec::with_capacity(size)));
    for NamedArray { name, shape, values } in arrays {
        if name.is_empty() || !name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
            return Err(format!("array '{}': a name consists of letters, digits and _", name.escape_debug()));
        }
        let refused = |cause: &dyn std::fmt::Display| format!("array '{name}': {cause}");
        let array = npy::to_bytes(shape, values)
            .ok_or_else(|| refused(&format!("{} values do not fill the shape {shape:?}", values.len())))?;
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .large_file(u32::try_from(array.len()).is_err());
        writer.start_file(format!("{name}.npy"), options).map_err(|e| refused(&e))?;
        writer.write_all(&array).map_err(|e| refused(&e))?;
    }
    Ok(writer.finish().map_err(|e| e.to_string())?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use npyz::NpyFile;

    #[test]
    fn another_reader_reads_the_arrays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        let (q, t) = ([1.0, -2.5, 0.1, 4.0, 5.0, -0.0], [0.5]);
        let arrays = [
            NamedArray { name: "q", shape: vec![1, 3, 2], values: &q },
            NamedArray { name: "time_s", shape: vec![], values: &t },
            NamedArray { name: "none", shape: vec![0, 4], values: &[] },
        ];
        write_npz(&path, &arrays).unwrap();
        let first = std::fs::read(&path).unwrap();
        let entries = crate::npz::archive::entries(&first, |_| true).unwrap();
        assert_eq!(entries.len(), 3);
        let read = |name: &str| {
            let array = NpyFile::new(&entries[name][..]).unwrap();
            (array.shape().to_vec(), array.into_vec::<f64>().unwrap())
        };
        let (shape, values) = read("q");
        assert_eq!(
            (shape, values.iter().map(|x| x.to_bits()).collect()),
            (vec![1, 3, 2], q.map(f64::to_bits).to_vec())
        );
        assert_eq!(read("time_s"), (vec![], vec![0.5]));
        assert_eq!(read("none"), (vec![0, 4], vec![]));
        write_npz(&path, &arrays).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), first);
    }

    #[test]
    fn invalid_arrays_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        let array = |name, shape: &[usize]| NamedArray { name, shape: shape.to_vec(), values: &[1.0, 2.0] };
        for (arrays, cause) in [
            (vec![array("a", &[3])], "array 'a': 2 values do not fill the shape [3]"),
            (vec![array("a", &[usize::MAX, 4])], "do not fill the shape"),
            (vec![array("", &[2])], "array '': a name consists"),
            (vec![array("../a", &[2])], "array '../a': a name consists"),
            (vec![array("a", &[2]), array("a", &[2])], "array 'a': "),
        ] {
            let refused = write_npz(&path, &arrays).unwrap_err().to_string();
            assert!(refused.contains(cause), "{refused}");
        }
        assert!(!path.exists());
    }
}
