//! Reads an array of numbers block by block, so that files larger than memory can be read.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::array::{check_size, floats, parse};
use super::header::{Header, Item, NumberKind};
use crate::file::{check_content, open_regular, read_error};
use crate::{FormatError, IoError};

/// Headers are read in full up to this size in bytes; NumPy writes at most a few hundred bytes for arrays of numbers.
const MAX_HEADER: u64 = 1 << 20;

/// Arrays in Fortran order are read as a whole up to this size of the file, in bytes.
const MAX_FORTRAN: u64 = 1 << 30;

/// Maximum size of the numbers of such an array, 8 bytes each: those of a file of float32 of that size.
const MAX_FORTRAN_NUMBERS: u64 = 2 << 30;

/// An open `.npy` file. A block is a range of its entries in C order.
pub(crate) struct Blocks {
    path: PathBuf,
    shape: Vec<usize>,
    body: Body,
}

enum Body {
    /// In C order blocks are contiguous.
    File { file: Mutex<File>, start: u64, item: Item },
    /// Arrays in Fortran order are read as a whole, in C order.
    Memory(Vec<f64>),
}

impl Blocks {
    /// Opens a file and checks its size.
    ///
    /// # Errors
    /// When the file cannot be read or is a Git LFS pointer, its header is malformed, longer than 1 MiB or has another
    /// type, or its length differs from the header; when it is in Fortran order and larger than 1 GiB, or 2 GiB as numbers
    /// of 8 bytes.
    pub fn open(path: &Path) -> Result<Self, IoError> {
        let (file, size) = open_regular(path)?;
        Self::of_file(path, file, size)
    }

    /// As [`Blocks::open`], for an open file of this size. The path may name another file meanwhile.
    fn of_file(path: &Path, mut file: File, size: u64) -> Result<Self, IoError> {
        let refused = |cause| read_error(path, cause);
        let mut start = Vec::new();
        (&mut file).take(MAX_HEADER.min(size)).read_to_end(&mut start).map_err(refused)?;
        check_content(&start).map_err(|error| error.of(path))?;
        let header = Header::parse(&start, NumberKind::Floats).map_err(|error| error.of(path))?;
        let Header { item, fortran, shape, body } = header;
        check_size(&shape, item, body, size - body as u64).map_err(|error| error.of(path))?;
        let body = if fortran {
            check_fortran(item, size).map_err(|error| error.of(path))?;
            // The rest of the same file follows the same header, so the array has the shape that was checked.
            let mut whole = start;
            let rest = size - whole.len() as u64;
            if whole.try_reserve_exact(rest as usize).is_err() {
                return Err(refused(io::Error::from(ErrorKind::OutOfMemory)));
            }
            file.take(rest).read_to_end(&mut whole).map_err(refused)?;
            let array = parse(&whole).map_err(|error| error.of(path))?;
            drop(whole);
            Body::Memory(array.into_c_order())
        } else {
            Body::File { file: Mutex::new(file), start: body as u64, item }
        };
        Ok(Self { path: path.to_owned(), shape, body })
    }

    /// Returns the length of each axis.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns `length` numbers from the entry `start` in C order on.
    ///
    /// # Errors
    /// When the file cannot be read, or is shorter than it was when it was opened; when an integer is beyond 2^53.
    ///
    /// # Panics
    /// When the block is beyond the array.
    pub fn read(&self, start: usize, length: usize) -> Result<Vec<f64>, IoError> {
        assert!(start + length <= self.shape.iter().product(), "block beyond the array");
        match &self.body {
            Body::Memory(data) => Ok(data[start..][..length].to_vec()),
            Body::File { file, start: body, item } => {
                let mut bytes = vec![0; length * item.size];
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                let read = file
                    .seek(SeekFrom::Start(body + (start * item.size) as u64))
                    .and_then(|_| file.read_exact(&mut bytes));
                drop(file);
                read.map_err(|cause| read_error(&self.path, cause))?;
                floats(*item, &bytes).map_err(|error| error.of(&self.path))
            }
        }
    }
}

/// Returns an error if an array in Fortran order is too large to be read as a whole. `size` is that of the file.
fn check_fortran(item: Item, size: u64) -> Result<(), FormatError> {
    let numbers = size.saturating_mul(8) / item.size as u64;
    let (has, limit) = if size > MAX_FORTRAN {
        (format!("has {} MiB", size >> 20), MAX_FORTRAN)
    } else if numbers > MAX_FORTRAN_NUMBERS {
        (format!("has {} MiB as float64", numbers >> 20), MAX_FORTRAN_NUMBERS)
    } else {
        return Ok(());
    };
    Err(FormatError::whole(format!(
        "the array is in Fortran order and {has}, more than the {} MiB that are read as a whole: save it in C order \
         (numpy.ascontiguousarray)",
        limit >> 20
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::npy::header::Class;
    use crate::npy::write::to_bytes;

    /// Returns a file of f64 in Fortran order: 0, 1, 2, ...
    fn fortran(shape: &str, count: usize) -> Vec<u8> {
        let text = format!("{{'descr': '<f8', 'fortran_order': True, 'shape': {shape}, }}\n");
        let numbers = (0..count).flat_map(|i| (i as f64).to_le_bytes());
        let start = [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()].concat();
        start.into_iter().chain(numbers).collect()
    }

    /// A program may replace or shorten a file of frames while it is read.
    #[test]
    fn a_file_in_fortran_order_is_opened_once() {
        let directory = tempfile::tempdir().unwrap();
        let [path, other] = ["x.npy", "y.npy"].map(|name| directory.path().join(name));
        // 1.5 MiB: more than is read with the header.
        std::fs::write(&path, fortran("(65536, 1, 3)", 3 << 16)).unwrap();
        let (file, size) = open_regular(&path).unwrap();
        std::fs::write(&other, fortran("(1, 1, 3)", 3)).unwrap();
        std::fs::rename(&other, &path).unwrap();
        let blocks = Blocks::of_file(&path, file, size).unwrap();
        assert_eq!(blocks.shape(), [65536, 1, 3]);
        let last = [65535.0, 131_071.0, 196_607.0];
        assert_eq!(blocks.read(3 * 65535, 3).unwrap(), last);
        assert_eq!(Blocks::open(&path).unwrap().shape(), [1, 1, 3]);

        let (file, size) = open_regular(&path).unwrap();
        std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(size - 8).unwrap();
        let message = Blocks::of_file(&path, file, size).err().unwrap().to_string();
        assert!(message.ends_with("but 16 bytes follow: is the file cut off?"), "{message}");
    }

    /// Narrow entries become numbers of 8 bytes, which take several times the size of the file.
    #[test]
    fn arrays_in_fortran_order_are_limited_by_their_numbers() {
        let message = |size: usize, mib: u64| {
            let item = Item { class: Class::Signed, size, big: false };
            check_fortran(item, mib << 20).err().map(|error| error.to_string())
        };
        for (size, mib) in [(8, 1024), (4, 1024), (2, 512), (1, 256)] {
            assert_eq!(message(size, mib), None, "{size}");
            let refused = message(size, mib + 1).unwrap();
            assert!(refused.starts_with("the array is in Fortran order and has "), "{refused}");
        }
        let refused = message(1, 257).unwrap();
        assert!(
            refused.contains("has 2056 MiB as float64, more than the 2048 MiB that are read"),
            "{refused}"
        );
    }

    #[test]
    fn blocks_are_parts_of_the_whole() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.npy");
        let data: Vec<f64> = (0..24).map(f64::from).collect();
        let bytes = to_bytes(&[4, 2, 3], &data).unwrap();
        std::fs::write(&path, &bytes).unwrap();
        let blocks = Blocks::open(&path).unwrap();
        assert_eq!(blocks.shape(), [4, 2, 3]);
        assert_eq!(blocks.read(18, 6).unwrap(), data[18..]);
        assert_eq!(blocks.read(0, 6).unwrap(), data[..6]);

        // The same array in Fortran order, in float32.
        let text = "{'descr': '<f4', 'fortran_order': True, 'shape': (4, 2, 3), }\n";
        let mut fortran =
            [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()].concat();
        for (k, j, i) in (0..3).flat_map(|k| (0..2).flat_map(move |j| (0..4).map(move |i| (k, j, i)))) {
            fortran.extend((data[6 * i + 3 * j + k] as f32).to_le_bytes());
        }
        std::fs::write(&path, &fortran).unwrap();
        assert_eq!(Blocks::open(&path).unwrap().read(6, 12).unwrap(), data[6..18]);

        // A file with a hole of 2 GiB.
        let text = "{'descr': '<f8', 'fortran_order': True, 'shape': (268435456, 1, 1), }\n";
        let start = [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()].concat();
        std::fs::write(&path, &start).unwrap();
        std::fs::OpenOptions::new()
            .write(true)
            .open(&path)
            .unwrap()
            .set_len((2 << 30) + start.len() as u64)
            .unwrap();
        let message = Blocks::open(&path).err().unwrap().to_string();
        assert!(message.contains("in Fortran order and has 2048 MiB, more than the 1024 MiB"), "{message}");

        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        let message = Blocks::open(&path).err().unwrap().to_string();
        assert!(
            message.ends_with("of 8-byte numbers, but 191 bytes follow: is the file cut off?"),
            "{message}"
        );
        std::fs::write(&path, &bytes).unwrap();
        let blocks = Blocks::open(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        assert!(blocks.read(18, 6).is_err() && blocks.read(0, 6).is_ok());
    }
}
