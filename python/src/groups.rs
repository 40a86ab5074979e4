//! Groups of triangles from arrays: the arguments `groups` and `ignore_groups`.

use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use sscc::parts::GroupTable;
use sscc::{ContactFilter, Pair, TriangleGroups};

use crate::arrays::integers;
use crate::errors::{refused, value};

/// Adds the groups of a mesh with this many triangles to a filter: `groups` has one number for each triangle,
/// `ignore_groups` the pairs of groups that do not count.
pub fn with_groups(
    filter: ContactFilter,
    triangles: usize,
    groups: Option<&Bound<'_, PyAny>>,
    ignore_groups: Option<&Bound<'_, PyAny>>,
) -> PyResult<ContactFilter> {
    let Some(groups) = groups else {
        return match ignore_groups {
            Some(_) => Err(value("ignore_groups needs groups: one number for each triangle")),
            None => Ok(filter),
        };
    };
    let found = integers(groups, "groups")?;
    if found.shape() != [triangles] {
        let shape = found.shape();
        return Err(value(format!(
            "groups has shape {shape:?}: one number for each of {triangles} triangles was expected"
        )));
    }
    let of_triangle = copied(found.as_slice()?, "groups")?;
    let table = TriangleGroups::new(&of_triangle).map_err(|error| refused(&error, ""))?;
    let pairs = match ignore_groups {
        Some(pairs) if !pairs.len().is_ok_and(|count| count == 0) => {
            let pairs = integers(pairs, "ignore_groups")?;
            if pairs.ndim() != 2 || pairs.shape()[1] != 2 {
                let shape = pairs.shape();
                return Err(value(format!(
                    "ignore_groups has shape {shape:?}: pairs of groups (n, 2) were expected"
                )));
            }
            copied(pairs.as_slice()?, "ignore_groups")?
        }
        _ => Vec::new(),
    };
    let table = table.ignoring(pairs.as_chunks().0.iter().copied());
    Ok(filter.with_groups(table.map_err(|error| refused(&error, ""))?))
}

/// Returns the pairs of groups that do not count, sorted.
pub fn ignored_pairs(groups: &TriangleGroups) -> Vec<Pair> {
    let table = GroupTable::from(groups);
    if table.others_count {
        return table.listed.iter().map(|&[g, h]| (g.into(), h.into())).collect();
    }
    // At least half of all pairs do not count, so a search visits at most twice as many pairs as it lists.
    let all = 0..table.count as u32;
    let pairs = all.clone().flat_map(|g| (g..all.end).map(move |h| (g, h)));
    pairs.filter(|(g, h)| table.listed.binary_search(&[*g as u16, *h as u16]).is_err()).collect()
}

/// Copies group numbers. It refuses numbers that do not fit into 32 bits; the core refuses numbers above 65535.
fn copied(numbers: &[i64], name: &str) -> PyResult<Vec<u32>> {
    let number = |number: &i64| {
        u32::try_from(*number).map_err(|_| {
            value(format!("{name}: {number} is no group: a number from 0 to 65535 was expected"))
        })
    };
    numbers.iter().map(number).collect()
}
