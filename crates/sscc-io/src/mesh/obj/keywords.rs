//! Which OBJ lines are skipped, and which are refused because vertices or faces would be missing.

use crate::FormatError;
use crate::error::quoted;

/// Keywords of lines that the reader reads or refuses. All others make neither vertices nor faces.
const GEOMETRY: [&str; 9] = ["v", "f", "fo", "surf", "bzp", "bsp", "cdp", "call", "csh"];

/// Returns an error if a line with another keyword than `v`, `f` and `fo` must not be skipped: it makes a free-form surface,
/// calls another file, has a malformed keyword of these, or continues a face.
pub(super) fn check_skipped(keyword: &[u8], follows_face: bool, line: usize) -> Result<(), FormatError> {
    let refused = |cause: &str| {
        let keyword = quoted(&String::from_utf8_lossy(keyword));
        Err(FormatError::line(line, format!("{keyword}{cause}")))
    };
    match keyword {
        b"surf" | b"bzp" | b"bsp" | b"cdp" => {
            refused(": free-form surfaces are not supported: convert them to polygons")
        }
        b"call" | b"csh" => {
            refused(": other files and commands are not read: put their lines into this file")
        }
        _ if follows_face && is_corner(keyword) => refused(
            " begins a line after a face: end the line before it with a backslash, or begin this one with '#'",
        ),
        _ => match malformed(keyword) {
            Some(meant) => {
                refused(&format!(" is not a keyword of OBJ: write {meant}, or begin the line with '#'"))
            }
            None => Ok(()),
        },
    }
}

/// Whether a word has the form of a corner.
fn is_corner(word: &[u8]) -> bool {
    word.iter().all(|b| matches!(b, b'0'..=b'9' | b'-' | b'/')) && word.iter().any(u8::is_ascii_digit)
}

/// Returns the correction of a malformed keyword of vertices or faces: in capitals, behind a character that is not visible
/// (a byte order mark), or joined to one that is not a letter (a no-break space, a digit). Words with more letters can be
/// private extensions (`vc`, `f_tag`).
fn malformed(keyword: &[u8]) -> Option<String> {
    // Almost all keywords, without their conversion to text. The exact ones of geometry do not come here.
    if keyword.iter().all(u8::is_ascii_lowercase) {
        return None;
    }
    let word = String::from_utf8_lossy(keyword);
    let visible = word.trim_start_matches(|c: char| !c.is_alphanumeric() && !c.is_ascii_graphic());
    let is_letter = |c: char| c.is_alphabetic() || c == '_';
    let name = visible.split(|c: char| !is_letter(c)).next().unwrap_or_default();
    let meant = GEOMETRY.iter().find(|keyword| keyword.eq_ignore_ascii_case(name))?;
    let space = if name.len() < visible.len() { " and a space" } else { "" };
    Some(format!("'{meant}'{space}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn malformed_keywords_have_a_correction_and_others_none() {
        for (word, correction) in [
            (&b"F"[..], "'f'"),
            (b"V", "'v'"),
            (b"FO", "'fo'"),
            (b"Surf", "'surf'"),
            (b"\xef\xbb\xbff", "'f'"),
            (b"\xc2\xa0f", "'f'"),
            (b"\x00v", "'v'"),
            (b"f\xc2\xa04", "'f' and a space"),
            (b"f\xa04", "'f' and a space"),
            (b"v\x0b1", "'v' and a space"),
            (b"v1", "'v' and a space"),
            (b"f/1", "'f' and a space"),
            (b"f\\", "'f' and a space"),
        ] {
            assert_eq!(malformed(word).as_deref(), Some(correction), "{word:?}");
        }
        for word in [
            &b""[..],
            b"vn",
            b"VT",
            b"vc",
            b"f_1",
            b"_f",
            b"3f",
            b"-f",
            b"facet",
            b"V_",
            b"v\xc3\xa4",
            b"\xc2\xa0",
        ] {
            assert_eq!(malformed(word), None, "{word:?}");
        }
    }

    #[test]
    fn corners_have_digits() {
        for word in [&b"1"[..], b"-1", b"1/2", b"1//3", b"1/2/3"] {
            assert!(is_corner(word), "{word:?}");
        }
        for word in [&b""[..], b"//", b"--", b"3D", b"1.5", b"vn"] {
            assert!(!is_corner(word), "{word:?}");
        }
    }
}
