//! Lines and numbers of text files.

use crate::FormatError;
use crate::error::quoted;

/// Iterator over the lines of a text file, each with its number from 1. Lines end with LF or CR LF, in files without LF
/// with CR; a byte order mark is skipped. Lines are bytes, because comments may have other encodings.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    end: u8,
}

/// Returns the last byte of a line end of this text: LF, or CR in files without LF.
pub(crate) fn line_end(bytes: &[u8]) -> u8 {
    if !bytes.contains(&b'\n') && bytes.contains(&b'\r') { b'\r' } else { b'\n' }
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Result<Self, FormatError> {
        Self::with_end(bytes, line_end(bytes))
    }

    /// As [`Lines::new`], for lines that end with this byte.
    pub fn with_end(bytes: &'a [u8], end: u8) -> Result<Self, FormatError> {
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(FormatError::whole("the file is UTF-16 text: save it as UTF-8"));
        }
        Ok(Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0, end })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| *b == self.end).unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        self.number += 1;
        Some((self.number, line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// Returns the line up to the first `#`.
pub(crate) fn without_comment(line: &[u8]) -> &[u8] {
    line.iter().position(|b| *b == b'#').map_or(line, |end| &line[..end])
}

/// Returns the first word of a line (bytes), and the remainder.
pub(crate) fn split_word(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii_start();
    line.split_at(line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len()))
}

/// Returns the bytes of a line as text.
pub(crate) fn decoded(bytes: &[u8], line: usize) -> Result<&str, FormatError> {
    std::str::from_utf8(bytes).map_err(|_| FormatError::line(line, "not UTF-8 text"))
}

/// Parses a finite number.
pub(crate) fn number(word: &str, line: usize) -> Result<f64, FormatError> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(FormatError::line(line, format!("{} is not a finite number", quoted(word)))),
        Err(_) => Err(FormatError::line(line, format!("{} is not a number", quoted(word)))),
    }
}

/// Parses a count: an integer from 0.
pub(crate) fn count(word: &str, line: usize) -> Result<usize, FormatError> {
    word.parse().map_err(|_| FormatError::line(line, format!("{} is not a count", quoted(word))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbered_and_have_any_ending() {
        let lines: Vec<_> = Lines::new(b"\xef\xbb\xbfa\r\nb\n\nc").unwrap().collect();
        assert_eq!(lines, [(1, &b"a"[..]), (2, b"b"), (3, b""), (4, b"c")]);
        assert!(Lines::new(b"\xff\xfev\0").is_err());
        let lines: Vec<_> = Lines::new(b"\xef\xbb\xbfa\rb\r\rc").unwrap().collect();
        assert_eq!(lines, [(1, &b"a"[..]), (2, b"b"), (3, b""), (4, b"c")]);
        // A single CR within a file of other line ends is no line end.
        let lines: Vec<_> = Lines::new(b"a\rb\nc\r").unwrap().collect();
        assert_eq!(lines, [(1, &b"a\rb"[..]), (2, b"c")]);
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number("-1.5e-3", 1).unwrap(), -1.5e-3);
        for word in ["nan", "inf", "-infinity", "1e999", "1,5", "0x10", "", "1_0"] {
            assert!(number(word, 1).is_err(), "{word}");
        }
    }
}
