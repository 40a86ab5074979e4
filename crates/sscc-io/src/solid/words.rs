//! Words and bytes of formats in which line ends have no meaning.

use crate::error::quoted;
use crate::text::{Lines, count, decoded, ends_line, is_line_end, number};
use crate::{FormatError, Message, Place};

/// Position in a file, from which words or bytes are read.
#[derive(Clone, Copy)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Line of the last word, from 1. Line ends within bytes are not counted.
    line: usize,
    /// The end of the last run of CR that no LF follows. Without it, each line of a long run would search the rest of the run.
    lone_returns: usize,
    comments: bool,
    /// Whether places are byte offsets (binary files).
    pub binary: bool,
}

impl<'a> Words<'a> {
    /// Creates a reader. With `comments`, text from a `#` to the end of its line is skipped.
    pub fn new(bytes: &'a [u8], comments: bool) -> Result<Self, FormatError> {
        Lines::new(bytes)?; // an error for UTF-16
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Ok(Self { bytes, at, line: 1, lone_returns: 0, comments, binary: false })
    }

    /// Returns the line of the last word; in binary files, the offset of the next byte.
    pub fn place(&self) -> Place {
        if self.binary { Place::Byte(self.at) } else { Place::Line(self.line) }
    }

    pub fn refused<T>(&self, cause: impl Into<Message>) -> Result<T, FormatError> {
        Err(FormatError::new(self.place(), cause))
    }

    /// Returns the next word; None at the end of the file.
    pub fn next_word(&mut self) -> Result<Option<&'a str>, FormatError> {
        let mut comment = false;
        while let Some(byte) = self.bytes.get(self.at) {
            match byte {
                end if is_line_end(*end) => {
                    self.line += usize::from(ends_line(self.bytes, self.at));
                    comment = false;
                }
                b'#' if self.comments => comment = true,
                _ if comment || byte.is_ascii_whitespace() => {}
                _ => break,
            }
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let ends = |b: &u8| b.is_ascii_whitespace() || (self.comments && *b == b'#');
        let word = &rest[..rest.iter().position(ends).unwrap_or(rest.len())];
        self.at += word.len();
        if word.is_empty() { Ok(None) } else { decoded(word, self.line).map(Some) }
    }

    /// Returns the next word without consuming it.
    pub fn peek(&self) -> Result<Option<&'a str>, FormatError> {
        let mut ahead = *self;
        ahead.next_word()
    }

    /// Returns the next word, or an error at the end of the file.
    pub fn word(&mut self, what: &str) -> Result<&'a str, FormatError> {
        match self.next_word()? {
            Some(word) => Ok(word),
            None => Err(FormatError::whole(format!("the file ends before {what}"))),
        }
    }

    pub fn number(&mut self, what: &str) -> Result<f64, FormatError> {
        let word = self.word(what)?;
        number(word, self.line).map_err(|error| self.here(&error))
    }

    pub fn count(&mut self, what: &str) -> Result<usize, FormatError> {
        let word = self.word(what)?;
        count(word, self.line).map_err(|error| self.here(&error))
    }

    fn here(&self, error: &FormatError) -> FormatError {
        FormatError::new(self.place(), error.cause().clone())
    }

    pub fn integer(&mut self, what: &str) -> Result<i64, FormatError> {
        let word = self.word(what)?;
        word.parse().or_else(|_| self.refused(format!("{} is not an integer", quoted(word))))
    }

    /// Returns the next bytes.
    pub fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        let Some(bytes) = self.bytes[self.at..].first_chunk() else {
            let cause = format!("the file ends before {what}");
            return Err(FormatError::new(Place::Byte(self.at), cause));
        };
        self.at += N;
        Ok(*bytes)
    }

    /// Returns the next `length` bytes.
    pub fn bytes(&mut self, length: u64, what: &str) -> Result<&'a [u8], FormatError> {
        let rest = &self.bytes[self.at..];
        let Some(bytes) = usize::try_from(length).ok().and_then(|length| rest.get(..length)) else {
            let cause =
                format!("the file ends before {what}: {length} bytes are needed, {} are left", rest.len());
            return Err(FormatError::new(Place::Byte(self.at), cause));
        };
        self.at += bytes.len();
        Ok(bytes)
    }

    /// Returns the rest of the line, without its end. Several CR before LF are one end.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let line = &rest[..rest.iter().position(|b| is_line_end(*b)).unwrap_or(rest.len())];
        let end = self.at + line.len();
        self.at = end + self.line_end(end);
        self.line += (end..self.at).filter(|at| ends_line(self.bytes, *at)).count();
        line
    }

    /// Returns the number of bytes of the line end at this place.
    fn line_end(&mut self, at: usize) -> usize {
        if at < self.lone_returns {
            return 1;
        }
        let end = &self.bytes[at..];
        let returns = end.iter().take_while(|b| **b == b'\r').count();
        if end.get(returns) == Some(&b'\n') {
            return returns + 1;
        }
        self.lone_returns = at + returns;
        returns.min(1)
    }

    /// Skips a line, which may be empty; an error at the end of the file.
    pub fn line(&mut self, what: &str) -> Result<(), FormatError> {
        if self.at == self.bytes.len() {
            return Err(FormatError::whole(format!("the file ends before {what}")));
        }
        self.rest_of_line();
        Ok(())
    }

    /// Skips all text up to the end of the next line with this beginning, if there is one.
    pub fn skip_past_line(&mut self, start: &str) -> bool {
        while self.at < self.bytes.len() {
            if self.rest_of_line().trim_ascii_start().starts_with(start.as_bytes()) {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_line_numbers() {
        let mut words = Words::new(b"\xef\xbb\xbfa  b#c\r\n# d\n\te", true).unwrap();
        let mut found = Vec::new();
        while let Some(word) = words.next_word().unwrap() {
            found.push((word, words.place()));
        }
        assert_eq!(found, [("a", Place::Line(1)), ("b", Place::Line(1)), ("e", Place::Line(3))]);
        let mut words = Words::new(b"a # b\rc", true).unwrap();
        assert_eq!((words.next_word().unwrap(), words.next_word().unwrap()), (Some("a"), Some("c")));
        assert_eq!(words.place(), Place::Line(2));
        assert_eq!(Words::new(b"a#b", false).unwrap().next_word().unwrap(), Some("a#b"));
        assert!(Words::new(b"\xff\xfea\0", false).is_err());
    }

    #[test]
    fn bytes_and_lines_alternate() {
        let mut words = Words::new(b"a b\nxyz\n$End", false).unwrap();
        words.word("a").unwrap();
        assert_eq!(words.rest_of_line(), b" b");
        assert_eq!(words.take::<2>("xy").unwrap(), *b"xy");
        assert!(words.take::<7>("more").unwrap_err().to_string().starts_with("byte 6: the file ends before"));
        assert!(words.skip_past_line("$End") && !words.skip_past_line("$End"));
        let mut words = Words::new(b"a b\rc\r$End\r", false).unwrap();
        words.word("a").unwrap();
        assert_eq!(words.rest_of_line(), b" b");
        assert!(words.skip_past_line("$End"));
    }

    /// Python on Windows writes CR CR LF. A single CR ends a line beside lines that end with LF, too.
    #[test]
    fn several_returns_before_a_line_feed_are_one_end() {
        let mut words = Words::new(b"# vtk\r\r\ntitle\r\r\nASCII\r\r\nx", false).unwrap();
        assert_eq!([words.rest_of_line(), words.rest_of_line()], [&b"# vtk"[..], b"title"]);
        assert_eq!(words.word("ASCII or BINARY").unwrap(), "ASCII");
        let mut words = Words::new(b"a\rb\nc", false).unwrap();
        assert_eq!([(); 3].map(|()| words.rest_of_line()), [b"a", b"b", b"c"]);
        let mut words = Words::new(b"a\r\r\rb\r\r\nc", false).unwrap();
        assert_eq!([(); 5].map(|()| words.rest_of_line()), [&b"a"[..], b"", b"", b"b", b"c"]);
        assert_eq!((words.place(), words.rest_of_line()), (Place::Line(6), &b""[..]));
    }

    /// The square of this number would take an hour.
    #[test]
    fn a_long_run_of_returns_takes_linear_time() {
        let text = [&b"a"[..], &[b'\r'; 4_000_000]].concat();
        let mut words = Words::new(&text, false).unwrap();
        assert!(!words.skip_past_line("$End"));
        assert_eq!(words.place(), Place::Line(4_000_001));
    }
}
