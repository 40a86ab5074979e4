//! Count at the head of a section, and the numbering of its items.

use crate::Place;
use crate::solid::statements::{fields, index};

/// How many items a section promises, and where.
pub(super) struct Promise {
    pub count: u64,
    pub place: Place,
}

/// The count at the head of a section, and the number behind it, which may be missing.
pub(super) fn promise(text: &str, size: u64, what: &str, place: &Place) -> Result<Promise, String> {
    let mut fields = fields(text).map(index);
    let count = fields.next().unwrap_or(Ok(0))?;
    match fields.next().unwrap_or(Ok(size))? {
        found if found == size => Ok(Promise { count, place: place.clone() }),
        other => Err(format!("{other} {what} each: {size} were expected")),
    }
}

/// Checks the number of the next item; returns that of the first, which is 0 or 1.
pub(super) fn numbered(
    field: Option<&str>,
    done: u64,
    first: u64,
    promise: &Option<Promise>,
    what: &str,
) -> Result<u64, String> {
    let number = index(field.unwrap_or_default())?;
    if promise.as_ref().is_some_and(|promise| done >= promise.count) {
        return Err(format!("more {what} than the {done} that their section promises"));
    }
    let first = if done == 0 { number } else { first };
    if first > 1 || number != first + done {
        let expected = first.min(1) + done;
        return Err(format!("{what} are numbered from 0 or 1 without gaps: not {number} but {expected}"));
    }
    Ok(first)
}
