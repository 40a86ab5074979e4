//! Readers for tables of numbers: trajectories of q, vectors and matrices.

use std::path::Path;

use crate::file::{ending, read_whole, unsupported};
use crate::text::{Lines, decoded, number, without_comment};
use crate::{FormatError, IoError, npy};

/// Table of numbers, row after row; a trajectory has one q in each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// Number of rows, at least 1.
    pub rows: usize,
    /// Numbers in each row, at least 1.
    pub columns: usize,
    /// `data[row * columns + column]`
    pub data: Vec<f64>,
}

impl Rows {
    /// Returns the rows in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.data.chunks_exact(self.columns)
    }
}

/// Reads a trajectory: a `.npy` array of shape (T, r), one q in each row, or (r), a single q. The numbers are not
/// checked: a query rejects a q of another length or one that is not finite.
///
/// # Errors
/// When the file is not a `.npy` file, cannot be read or is malformed, or the array is empty or of another dimension.
pub fn read_rows(path: &Path) -> Result<Rows, IoError> {
    if ending(path) != "npy" {
        return Err(unsupported(path, "trajectory", ".npy"));
    }
    parse_rows(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Reads a vector: a `.npy` array of shape (r), or a text file (any other ending) with numbers between white space or commas,
/// where `#` begins a comment.
///
/// # Errors
/// When the file cannot be read, is malformed or has no numbers; when a number in a text file is not finite; when an
/// array is of another dimension.
pub fn read_vector(path: &Path) -> Result<Vec<f64>, IoError> {
    let bytes = read_whole(path)?;
    let parse = if ending(path) == "npy" { parse_vector } else { parse_text };
    parse(&bytes).map_err(|error| error.of(path))
}

/// Reads a matrix: a `.npy` array of shape (n, m), or a vector of any form that [`read_vector`] reads, as one row.
///
/// # Errors
/// As [`read_rows`] and [`read_vector`].
pub fn read_matrix(path: &Path) -> Result<Rows, IoError> {
    let bytes = read_whole(path)?;
    if ending(path) == "npy" {
        return parse_rows(&bytes).map_err(|error| error.of(path));
    }
    let data = parse_text(&bytes).map_err(|error| error.of(path))?;
    Ok(Rows { rows: 1, columns: data.len(), data })
}

fn parse_rows(bytes: &[u8]) -> Result<Rows, FormatError> {
    let array = npy::parse(bytes)?;
    match *array.shape() {
        [rows, columns] if rows > 0 && columns > 0 => Ok(Rows { rows, columns, data: array.into_c_order() }),
        [columns] if columns > 0 => Ok(Rows { rows: 1, columns, data: array.into_c_order() }),
        ref other => Err(FormatError::whole(format!(
            "shape {other:?}: (T, r) or (r) was expected, without empty axes"
        ))),
    }
}

fn parse_vector(bytes: &[u8]) -> Result<Vec<f64>, FormatError> {
    let array = npy::parse(bytes)?;
    match *array.shape() {
        [length] if length > 0 => Ok(array.into_c_order()),
        ref other => Err(FormatError::whole(format!(
            "shape {other:?}: (r) was expected, without an empty axis; save one row, or q.reshape(-1)"
        ))),
    }
}

fn parse_text(bytes: &[u8]) -> Result<Vec<f64>, FormatError> {
    if bytes.starts_with(b"PK\x03\x04") {
        return Err(FormatError::whole("an archive: save one array with numpy.save"));
    }
    let mut values = Vec::new();
    for (line, text) in Lines::new(bytes)? {
        let text = decoded(without_comment(text), line)?.trim_ascii();
        // A comma may end a line that goes on in the next one.
        for part in text.strip_suffix(',').unwrap_or(text).split(',') {
            if part.trim_ascii().is_empty() && !text.is_empty() {
                return Err(FormatError::line(line, "a number is missing beside a comma"));
            }
            for word in part.split_ascii_whitespace() {
                values.push(number(word, line)?);
            }
        }
    }
    if values.is_empty() { Err(FormatError::whole("the file has no numbers")) } else { Ok(values) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_one_and_two_axes_are_read_and_others_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("q.npy");
        npy::write_npy(&path, &[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        let rows = read_rows(&path).unwrap();
        assert_eq!((rows.rows, rows.columns), (2, 3));
        assert_eq!(rows.iter().collect::<Vec<_>>(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert!(
            read_vector(&path)
                .unwrap_err()
                .to_string()
                .contains("shape [2, 3]: (r) was expected, without an empty axis; save one row")
        );
        npy::write_npy(&path, &[3], &[1.0, 2.0, 3.0]).unwrap();
        assert_eq!(read_rows(&path).unwrap(), Rows { rows: 1, columns: 3, data: vec![1.0, 2.0, 3.0] });
        assert_eq!(read_vector(&path).unwrap(), [1.0, 2.0, 3.0]);
        for shape in [&[0, 3][..], &[3, 0], &[0], &[1, 1, 0]] {
            npy::write_npy(&path, shape, &[]).unwrap();
            assert!(read_rows(&path).is_err() && read_vector(&path).is_err(), "{shape:?}");
        }
        npy::write_npy(&path, &[], &[1.0]).unwrap();
        assert!(read_rows(&path).is_err() && read_vector(&path).is_err());
        assert!(npy::write_npy(&path, &[2], &[1.0]).is_err());
        let other = directory.path().join("q.csv");
        let message = || read_rows(&other).unwrap_err().to_string();
        assert!(message().ends_with("q.csv: not found"));
        std::fs::write(&other, "0 0\n").unwrap();
        assert!(message().contains("unknown kind of trajectory"));
    }

    #[test]
    fn vectors_are_read_from_text_with_comments() {
        assert_eq!(parse_text(b"1 2e-3 # weights\r\n\n-4\n").unwrap(), [1.0, 2e-3, -4.0]);
        assert_eq!(parse_text(b"0.1,0.2 , 3\t4,\n-5\n").unwrap(), [0.1, 0.2, 3.0, 4.0, -5.0]);
        for wrong in ["1,,2", ",1", "1, ,2", ",", "1,,"] {
            let message = parse_text(format!("7\n{wrong}\n").as_bytes()).unwrap_err().to_string();
            assert_eq!(message, "line 2: a number is missing beside a comma");
        }
        assert!(parse_text(b"PK\x03\x04\n").unwrap_err().to_string().contains("numpy.save"));
        assert_eq!(parse_text(b"1\nx").unwrap_err().to_string(), "line 2: 'x' is not a number");
        assert_eq!(parse_text(b"1\nnan").unwrap_err().to_string(), "line 2: 'nan' is not a finite number");
        assert_eq!(parse_text(b" # \n").unwrap_err().to_string(), "the file has no numbers");
        assert_eq!(parse_text(b"1 \xff").unwrap_err().to_string(), "line 1: not UTF-8 text");
    }
}
