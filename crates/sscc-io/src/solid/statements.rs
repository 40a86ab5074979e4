//! Lines of fields, separated by blanks or commas.

use crate::FormatError;
use crate::error::quoted;
use crate::text::{Lines, decoded, without_comment};

/// Returns the lines that are not blank, without comments (`#`) and outer white space, each with its number from 1.
pub(super) fn statements(
    bytes: &[u8],
) -> Result<impl Iterator<Item = Result<(usize, &str), FormatError>>, FormatError> {
    Ok(Lines::new(bytes)?
        .map(|(line, text)| (line, without_comment(text).trim_ascii()))
        .filter(|(_, text)| !text.is_empty())
        .map(|(line, text)| decoded(text, line).map(|text| (line, text))))
}

/// Returns the fields of a line.
pub(super) fn fields(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_ascii_whitespace()).filter(|field| !field.is_empty())
}

/// Returns the numbers of `N` corners, as in the file; further fields are ignored. The error is the cause, if there are
/// fewer.
pub(super) fn corners<'a, const N: usize>(
    fields: &mut impl Iterator<Item = &'a str>,
) -> Result<[u64; N], String> {
    let mut corners = [0; N];
    for (found, corner) in corners.iter_mut().enumerate() {
        let Some(field) = fields.next() else {
            return Err(format!("an element has {N} corners, this one has {found}"));
        };
        *corner = index(field)?;
    }
    Ok(corners)
}

/// Returns the three coordinates of a vertex, or the cause of the error.
pub(super) fn position<'a>(fields: &mut impl Iterator<Item = &'a str>) -> Result<glam::DVec3, String> {
    let mut coordinates = [0.0; 3];
    for coordinate in &mut coordinates {
        let field = fields.next().ok_or("a vertex has a number and 3 coordinates")?;
        *coordinate = value(field)?;
    }
    Ok(coordinates.into())
}

/// Returns an integer from 0, or the cause of the error.
pub(super) fn index(field: &str) -> Result<u64, String> {
    field.parse().map_err(|_| format!("{} is not a number of a vertex or element", quoted(field)))
}

/// Returns a finite number, or the cause of the error.
pub(super) fn value(field: &str) -> Result<f64, String> {
    crate::text::number(field, 0).map_err(|error| error.cause().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blank_lines_and_separators_are_skipped() {
        let lines: Vec<_> = statements(b"# a\n\n 1, 2,,3\t4 # b\r\n").unwrap().map(Result::unwrap).collect();
        assert_eq!(lines, [(3, "1, 2,,3\t4")]);
        assert_eq!(corners::<4>(&mut fields(lines[0].1)).unwrap(), [1, 2, 3, 4]);
        assert!(corners::<5>(&mut fields(lines[0].1)).unwrap_err().contains("this one has 4"));
        assert!(statements(b"a\xff\n").unwrap().next().unwrap().is_err());
        assert!(value("nan").unwrap_err().contains("'nan' is not a finite number"));
    }
}
