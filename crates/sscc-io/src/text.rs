//! Lines and numbers of text files.

use crate::FormatError;
use crate::error::quoted;

/// Iterator over the lines of a text file, each with its number from 1. A line ends with LF, CR LF, or a CR that no LF
/// follows; a file may mix them. Byte order marks at the beginning of a line are skipped: files that are joined have several.
/// Lines are bytes, because comments may have other encodings.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Result<Self, FormatError> {
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(FormatError::whole("the file is UTF-16 text: save it as UTF-8"));
        }
        Ok(Self { rest: bytes, number: 0 })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| is_line_end(*b)).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest.strip_prefix(b"\r\n").or_else(|| rest.get(1..)).unwrap_or_default();
        self.number += 1;
        Some((self.number, without_marks(line)))
    }
}

/// Whether a byte is LF or CR.
pub(crate) fn is_line_end(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// Whether a line ends with the byte at this place: LF, or CR that no LF follows.
pub(crate) fn ends_line(bytes: &[u8], at: usize) -> bool {
    match bytes.get(at) {
        Some(b'\n') => true,
        Some(b'\r') => bytes.get(at + 1) != Some(&b'\n'),
        _ => false,
    }
}

/// Returns a line without the byte order marks at its beginning.
fn without_marks(mut line: &[u8]) -> &[u8] {
    while let Some(rest) = line.strip_prefix(b"\xef\xbb\xbf") {
        line = rest;
    }
    line
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

    fn lines(bytes: &[u8]) -> Vec<(usize, &[u8])> {
        Lines::new(bytes).unwrap().collect()
    }

    #[test]
    fn lines_are_numbered_and_have_any_ending() {
        let all = [(1, &b"a"[..]), (2, b"b"), (3, b""), (4, b"c")];
        for bytes in [
            &b"\xef\xbb\xbfa\r\nb\n\nc"[..],
            b"\xef\xbb\xbfa\rb\r\rc",
            b"a\rb\n\nc\r",
            b"a\nb\r\r\nc\n",
            b"a\r\nb\n\rc\r\n",
        ] {
            assert_eq!(lines(bytes), all, "{bytes:?}");
        }
        assert!(lines(b"").is_empty());
        assert_eq!(lines(b"\r"), [(1, &b""[..])]);
        assert!(Lines::new(b"\xff\xfev\0").is_err());
    }

    #[test]
    fn the_ends_of_lines_are_those_of_the_iterator() {
        for bytes in [&b"a\r\nb\n\nc"[..], b"a\rb\r\r\nc", b"\r\n\r\n", b"\n\r", b"a"] {
            let ends = (0..bytes.len()).filter(|at| ends_line(bytes, *at)).count();
            let is_open = !bytes.ends_with(b"\n") && !bytes.ends_with(b"\r");
            assert_eq!(lines(bytes).len(), ends + usize::from(is_open), "{bytes:?}");
        }
    }

    /// Files that are joined keep their marks.
    #[test]
    fn every_line_may_begin_with_byte_order_marks() {
        let joined = b"\xef\xbb\xbfa\n\xef\xbb\xbfb\r\xef\xbb\xbf\xef\xbb\xbfc\nd\xef\xbb\xbf";
        assert_eq!(lines(joined), [(1, &b"a"[..]), (2, b"b"), (3, b"c"), (4, b"d\xef\xbb\xbf")]);
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number("-1.5e-3", 1).unwrap(), -1.5e-3);
        for word in ["nan", "inf", "-infinity", "1e999", "1,5", "0x10", "", "1_0"] {
            assert!(number(word, 1).is_err(), "{word}");
        }
    }
}
