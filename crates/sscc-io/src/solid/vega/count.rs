//! Count at the head of a section, and the numbering of its items.

use crate::Place;
use crate::solid::statements::{fields, index};

/// Declared number of items of a section, and its place.
pub(super) struct DeclaredCount {
    pub count: u64,
    pub place: Place,
}

/// Parses the count at the head of a section, and the optional number after it, which must be `size`.
pub(super) fn declared_count(
    text: &str,
    size: u64,
    what: &str,
    place: &Place,
) -> Result<DeclaredCount, String> {
    let mut fields = fields(text).map(index);
    let count = fields.next().unwrap_or(Ok(0))?;
    match fields.next().unwrap_or(Ok(size))? {
        found if found == size => Ok(DeclaredCount { count, place: place.clone() }),
        other => Err(format!("the section declares {other} {what}: {size} were expected")),
    }
}

/// Checks the number of the next item; returns the number of the first, which is 0 or 1.
pub(super) fn numbered(
    field: Option<&str>,
    done: u64,
    first: u64,
    declared_count: &Option<DeclaredCount>,
    what: &str,
) -> Result<u64, String> {
    let number = index(field.unwrap_or_default())?;
    if declared_count.as_ref().is_some_and(|declared_count| done >= declared_count.count) {
        return Err(format!("the section has more {what} than the declared {done}"));
    }
    let first = if done == 0 { number } else { first };
    if first > 1 || number != first + done {
        let expected = first.min(1) + done;
        return Err(format!(
            "{what} are numbered from 0 or 1 without gaps: {expected} was expected, not {number}"
        ));
    }
    Ok(first)
}
