//! Why a file that is not binary STL is not read as text STL.

use super::words::{Word, Words};
use crate::FormatError;
use crate::text::Lines;

/// Number of bytes at the beginning of a file that show whether it is text.
const START: usize = 512;

/// Returns the reason for a file whose size does not fit a binary file, and which is not parsed as text; None if it does not
/// look like text.
pub(super) fn cause(bytes: &[u8]) -> Option<FormatError> {
    let mut lines = match Lines::new(bytes) {
        Ok(lines) => lines,
        Err(utf16) => return Some(utf16),
    };
    if !looks_like_text(bytes) {
        return None;
    }
    let first = Words::new(bytes).next_word()?;
    if first.is("solid") {
        // Otherwise the file would have been parsed as text.
        let (line, _) = lines.find(|(_, text)| text.contains(&0))?;
        return Some(FormatError::line(line, "the text has a zero byte: remove it"));
    }
    Some(lines.find_map(|(line, text)| wrong_start(line, text)).unwrap_or_else(|| unknown(first)))
}

/// Returns the error of the first line that is one of text STL.
fn wrong_start(line: usize, text: &[u8]) -> Option<FormatError> {
    let word = Words::new(text).next_word()?;
    let remedy = match (word.is("solid"), word.is("facet")) {
        (true, _) => "remove the lines before this one",
        (_, true) => "begin the file with a line 'solid', then this line",
        _ => return None,
    };
    Some(FormatError::line(line, format!("text STL begins with 'solid': {remedy}")))
}

fn unknown(first: Word) -> FormatError {
    let cause = format!("not an STL file: text STL begins with 'solid', not {}", first.quoted());
    FormatError::line(first.line, cause)
}

/// Whether a file begins like a text: with at most one control character, and another one in each hundred bytes. The count
/// and the triangles of a binary file have more.
fn looks_like_text(bytes: &[u8]) -> bool {
    let start = bytes.iter().take(START);
    let controls = start.filter(|b| b.is_ascii_control() && !b.is_ascii_whitespace()).count();
    controls <= 1 + bytes.len().min(START) / 100
}
