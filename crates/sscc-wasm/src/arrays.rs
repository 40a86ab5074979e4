//! Typed arrays as points, triangles and pairs.

use std::fmt;

use glam::DVec3;
use sscc::Pair;

/// An array whose length is no multiple of its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthError {
    name: &'static str,
    length: usize,
    row: usize,
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, length, row } = self;
        write!(f, "{name} has {length} numbers; their number must be a multiple of {row}")
    }
}

impl std::error::Error for LengthError {}

/// The points of an array with 3 coordinates for each.
pub fn points(name: &'static str, numbers: &[f64]) -> Result<Vec<DVec3>, LengthError> {
    Ok(rows::<3, _>(name, numbers)?.iter().copied().map(DVec3::from).collect())
}

/// The rows of an array.
pub fn rows<'a, const N: usize, T>(
    name: &'static str,
    numbers: &'a [T],
) -> Result<&'a [[T; N]], LengthError> {
    match numbers.as_chunks::<N>() {
        (rows, []) => Ok(rows),
        _ => Err(LengthError { name, length: numbers.len(), row: N }),
    }
}

/// The numbers of points.
pub fn coordinates(points: &[DVec3]) -> Vec<f64> {
    points.iter().flat_map(DVec3::to_array).collect()
}

/// The numbers of pairs.
pub fn numbers(pairs: &[Pair]) -> Vec<u32> {
    pairs.iter().flat_map(|&(a, b)| [a, b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_that_is_no_multiple_of_a_row_is_refused() {
        assert_eq!(points("positions", &[1.0, 2.0, 3.0]).unwrap(), [DVec3::new(1.0, 2.0, 3.0)]);
        let error = points("positions", &[0.0; 4]).unwrap_err().to_string();
        assert_eq!(error, "positions has 4 numbers; their number must be a multiple of 3");
        assert_eq!(rows::<3, u32>("faces", &[]).unwrap().len(), 0);
        assert!(rows::<3, u32>("faces", &[0, 1]).is_err());
    }
}
