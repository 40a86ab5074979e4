//! Reader for lists of vertices, such as those that are fixed.

use std::path::Path;

use crate::file::{ending, read_whole};
use crate::numbers::read_vector;
use crate::text::{Lines, decoded, without_comment};
use crate::{FormatError, IoError};

/// Reads vertex numbers, counted from 0: a `.npy` array of shape (n), or text with numbers separated by white space or
/// commas, where `#` begins a comment. A text file whose name ends in `.bou`, as VegaFEM writes fixed vertices, counts
/// from 1.
///
/// # Errors
/// When the file cannot be read or is malformed, has no numbers, or a number is no integer from 0 (`.bou`: 1) to 2^32 -
/// 1.
pub fn read_vertex_numbers(path: &Path) -> Result<Vec<u32>, IoError> {
    match ending(path).as_str() {
        "npy" => read_vector(path)?.into_iter().map(of_real).collect::<Result<_, _>>(),
        ending => parse(&read_whole(path)?, u32::from(ending == "bou")),
    }
    .map_err(|error| error.of(path))
}

fn of_real(number: f64) -> Result<u32, FormatError> {
    let is_number = number >= 0.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0;
    let refused = || FormatError::whole(format!("{number} is not a vertex number"));
    is_number.then_some(number as u32).ok_or_else(refused)
}

/// Parses a list in which the first vertex has the number `first`.
fn parse(bytes: &[u8], first: u32) -> Result<Vec<u32>, FormatError> {
    let mut numbers = Vec::new();
    for (line, text) in Lines::new(bytes)? {
        let words = decoded(without_comment(text), line)?.split([',', ' ', '\t']);
        for word in words.map(str::trim).filter(|word| !word.is_empty()) {
            let number: Option<u32> = word.parse().ok();
            let number = number.and_then(|number| number.checked_sub(first));
            numbers.push(number.ok_or_else(|| {
                let from = if first == 1 { ", counted from 1" } else { "" };
                let quoted = crate::error::quoted(word);
                FormatError::line(line, format!("{quoted} is not a vertex number{from}"))
            })?);
        }
    }
    if numbers.is_empty() { Err(FormatError::whole("the file has no numbers")) } else { Ok(numbers) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_counted_from_0_and_those_of_vegafem_from_1() {
        let directory = tempfile::tempdir().unwrap();
        let read = |name: &str, bytes: &[u8]| {
            let path = directory.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            read_vertex_numbers(&path).map_err(|error| error.to_string())
        };
        assert_eq!(read("a.txt", b"3, 1 # two\n\t0,\r\n4294967295").unwrap(), [3, 1, 0, u32::MAX]);
        assert_eq!(read("a.bou", b"1,2,3,\n7\n").unwrap(), [0, 1, 2, 6]);
        let npy = crate::npy::to_bytes(&[2], &[5.0, 0.0]).unwrap();
        assert_eq!(read("a.npy", &npy).unwrap(), [5, 0]);
        for (name, text, cause) in [
            ("a.bou", "1\n0", "a.bou: line 2: '0' is not a vertex number, counted from 1"),
            ("a.txt", "1.5", "a.txt: line 1: '1.5' is not a vertex number"),
            ("a.txt", "-1", "'-1' is not a vertex number"),
            ("a.txt", "4294967296", "is not a vertex number"),
            ("a.txt", " # none\n", "the file has no numbers"),
        ] {
            let refused = read(name, text.as_bytes()).unwrap_err();
            assert!(refused.ends_with(cause), "{refused}");
        }
        let npy = crate::npy::to_bytes(&[1], &[0.5]).unwrap();
        assert!(read("a.npy", &npy).unwrap_err().ends_with("0.5 is not a vertex number"));
    }
}
