//! Words of a text STL file, with their lines.

use glam::DVec3;

use crate::FormatError;
use crate::error::quoted;
use crate::text::{decoded, is_line_end, number};

/// The keywords of the format. `normal` is none of them: normals are skipped.
const KEYWORDS: [&str; 8] = ["solid", "facet", "outer", "loop", "vertex", "endloop", "endfacet", "endsolid"];

/// Position in a text, from which words are read.
#[derive(Clone, Copy)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
    /// Line of the next byte, from 1.
    line: usize,
}

/// A word, and its line from 1.
#[derive(Clone, Copy)]
pub(super) struct Word<'a> {
    text: &'a [u8],
    pub line: usize,
}

impl<'a> Words<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, line: 1 }
    }

    /// Returns the next word; None at the end of the file.
    pub fn next_word(&mut self) -> Option<Word<'a>> {
        self.skip_space();
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        if text.is_empty() { None } else { Some(Word { text, line: self.line }) }
    }

    /// Returns the next word; at the end of the file an error that names what was expected.
    pub fn required(&mut self, expected: &str) -> Result<Word<'a>, FormatError> {
        let ends = || FormatError::whole(format!("the file ends where {expected} was expected"));
        self.next_word().ok_or_else(ends)
    }

    /// Reads the next word, which must be this keyword.
    pub fn keyword(&mut self, keyword: &str, expected: &str) -> Result<(), FormatError> {
        let word = self.required(expected)?;
        if word.is(keyword) { Ok(()) } else { Err(word.refused(expected)) }
    }

    /// Reads three coordinates; `line` is that of their keyword.
    pub fn position(&mut self, line: usize) -> Result<DVec3, FormatError> {
        let too_few = || FormatError::line(line, "a vertex has 3 coordinates");
        let mut coordinates = [0.0; 3];
        for coordinate in &mut coordinates {
            let word = self.next_word().ok_or_else(too_few)?;
            *coordinate = match word.number() {
                Ok(value) => value,
                Err(_) if word.is_keyword() => return Err(too_few()),
                Err(error) => return Err(error),
            };
        }
        Ok(coordinates.into())
    }

    /// Skips the name after `solid`: the rest of the line, or the words before a facet in that line.
    pub fn skip_name(&mut self) {
        self.skip_to("facet");
    }

    /// Skips the name after `endsolid`: the rest of the line, or the words before a solid with a facet in that line.
    pub fn skip_end_name(&mut self) {
        self.skip_to("solid");
    }

    fn skip_to(&mut self, keyword: &str) {
        match self.before_facet(keyword) {
            Some(position) => *self = position,
            None => {
                let end = self.rest.iter().position(|b| is_line_end(*b)).unwrap_or(self.rest.len());
                self.rest = self.rest.get(end..).unwrap_or_default();
            }
        }
    }

    /// Returns the position of the first word of this line that is this keyword, else of the first word `facet`, if a facet
    /// follows in this line: a word `facet`, then `outer loop vertex` or `endfacet`. A name alone can have one of these.
    /// Reads no further than to the first facet, because a single line may have many.
    fn before_facet(&self, keyword: &str) -> Option<Self> {
        let (mut words, mut first, mut facet) = (*self, None, None);
        loop {
            let before = words;
            let word = words.next_word().filter(|word| word.line == self.line)?;
            if word.is(keyword) {
                first = first.or(Some(before));
            }
            if word.is("facet") {
                facet = facet.or(Some(before));
            }
            if facet.is_some() && (word.is("endfacet") || word.is("outer") && words.begins_corners()) {
                return first.or(facet);
            }
        }
    }

    /// Whether the words after `outer` are next.
    fn begins_corners(mut self) -> bool {
        ["loop", "vertex"].into_iter().all(|keyword| self.next_word().is_some_and(|word| word.is(keyword)))
    }

    /// Skips white space, counts line ends, and skips the byte order marks of files that were joined.
    fn skip_space(&mut self) {
        let mut rest = self.rest;
        loop {
            rest = match rest {
                [b' ' | b'\t' | b'\x0c', after @ ..] => after,
                // CR LF is counted at its LF.
                [b'\r', after @ ..] if after.starts_with(b"\n") => after,
                [b'\n' | b'\r', after @ ..] => {
                    self.line += 1;
                    after
                }
                [0xef, 0xbb, 0xbf, after @ ..] => after,
                _ => break,
            };
        }
        self.rest = rest;
    }
}

impl Word<'_> {
    /// Whether this is a keyword, in any case.
    pub fn is(&self, keyword: &str) -> bool {
        self.text.eq_ignore_ascii_case(keyword.as_bytes())
    }

    pub fn is_keyword(&self) -> bool {
        KEYWORDS.iter().any(|keyword| self.is(keyword))
    }

    /// Returns the finite number of this word.
    pub fn number(&self) -> Result<f64, FormatError> {
        number(decoded(self.text, self.line)?, self.line)
    }

    /// Whether this is a number, which need not be finite.
    pub fn is_number(&self) -> bool {
        std::str::from_utf8(self.text).is_ok_and(|text| text.parse::<f64>().is_ok())
    }

    /// Returns an error that names what was expected.
    pub fn refused(&self, expected: &str) -> FormatError {
        FormatError::line(self.line, format!("{expected} expected, not {}", self.quoted()))
    }

    pub fn quoted(&self) -> String {
        quoted(&String::from_utf8_lossy(self.text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_the_lines_of_all_line_ends() {
        let mut words = Words::new(b"\xef\xbb\xbfa\tb\r\nc\rd\n\n\xef\xbb\xbfe\r\r\nf ");
        let found: Vec<(&[u8], usize)> =
            std::iter::from_fn(|| words.next_word()).map(|word| (word.text, word.line)).collect();
        assert_eq!(found, [(&b"a"[..], 1), (b"b", 1), (b"c", 2), (b"d", 3), (b"e", 5), (b"f", 7)]);
    }

    /// Returns the next word after the first one and a name, and its line.
    fn after_name(text: &str, is_end: bool) -> Option<(String, usize)> {
        let mut words = Words::new(text.as_bytes());
        words.next_word().unwrap();
        if is_end {
            words.skip_end_name()
        } else {
            words.skip_name()
        }
        words.next_word().map(|word| (String::from_utf8_lossy(word.text).into_owned(), word.line))
    }

    #[test]
    fn names_reach_to_the_end_of_the_line() {
        for name in
            ["", "a b", "facet", "my facet normal 0 0 1", "endsolid solid", "outer loop vertex endfacet"]
        {
            for is_end in [false, true] {
                for end in ["\n", "\r\n", "\r"] {
                    let found = after_name(&format!("solid {name}{end}next"), is_end);
                    assert_eq!(found, Some(("next".to_owned(), 2)), "{name}");
                }
                assert_eq!(after_name(&format!("solid {name}"), is_end), None, "{name}");
            }
        }
    }

    #[test]
    fn names_end_before_a_facet_or_a_solid_in_their_line() {
        let facet = "facet normal 0 0 1 outer loop vertex 0 0 0";
        for name in ["", "a", "facet", "my outer facet normal"] {
            let found = after_name(&format!("solid {name} {facet}"), false);
            assert_eq!(found, Some(("facet".to_owned(), 1)), "{name}");
            let found = after_name(&format!("endsolid {name} {facet}"), true);
            assert_eq!(found, Some(("facet".to_owned(), 1)), "{name}");
            let found = after_name(&format!("endsolid {name} SOLID b {facet}"), true);
            assert_eq!(found, Some(("SOLID".to_owned(), 1)), "{name}");
            // The facet of another line belongs to no name.
            let found = after_name(&format!("solid {name}\n{facet}"), false);
            assert_eq!(found, Some(("facet".to_owned(), 2)), "{name}");
        }
    }
}
