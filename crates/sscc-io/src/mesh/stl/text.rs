//! Parser for text STL files: words between white space, where lines end only the names of solids.

use glam::DVec3;

use super::words::{Word, Words};
use crate::FormatError;

const FACET: &str = "'facet' or 'endsolid'";
const LOOP: &str = "'outer loop'";
const CORNER: &str = "'vertex' (a facet has 3)";
const LOOP_END: &str = "'endloop' (a facet has 3 vertices)";

/// Returns three corners for each facet.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<DVec3>, FormatError> {
    let mut words = Words::new(bytes);
    let mut positions = Vec::new();
    while let Some(word) = words.next_word() {
        if !word.is("solid") {
            return Err(word.refused("'solid'"));
        }
        words.skip_name();
        read_facets(&mut words, &mut positions)?;
        words.skip_end_name();
    }
    Ok(positions)
}

/// Reads facets up to the word `endsolid`.
fn read_facets(words: &mut Words, positions: &mut Vec<DVec3>) -> Result<(), FormatError> {
    loop {
        let word = words.required(FACET)?;
        if word.is("endsolid") {
            return Ok(());
        }
        if !word.is("facet") {
            return Err(word.refused(FACET));
        }
        skip_normal(words, word.line)?;
        read_loop(words, positions)?;
    }
}

/// Skips the normal, up to the word `outer`. It may be missing, and need not be finite; further words of its line are
/// skipped, too. A keyword among them would be part of another facet.
fn skip_normal(words: &mut Words, line: usize) -> Result<(), FormatError> {
    loop {
        let word = words.required(LOOP)?;
        if word.is("outer") {
            return Ok(());
        }
        let is_skipped =
            if word.line == line { !word.is_keyword() } else { word.is("normal") || word.is_number() };
        if !is_skipped {
            return Err(word.refused(LOOP));
        }
    }
}

/// Reads the corners after the word `outer`, up to the end of the facet.
fn read_loop(words: &mut Words, positions: &mut Vec<DVec3>) -> Result<(), FormatError> {
    words.keyword("loop", LOOP)?;
    for _ in 0..3 {
        let word = words.required(CORNER)?;
        if !word.is("vertex") {
            return Err(not_after_corner(word, CORNER));
        }
        positions.push(words.position(word.line)?);
    }
    let word = words.required(LOOP_END)?;
    if !word.is("endloop") {
        return Err(not_after_corner(word, LOOP_END));
    }
    words.keyword("endfacet", "'endfacet'")
}

/// Returns the error of a word that may not follow a corner.
fn not_after_corner(word: Word, expected: &str) -> FormatError {
    match word.is_number() {
        true => FormatError::line(word.line, "a vertex has 3 coordinates"),
        false => word.refused(expected),
    }
}
