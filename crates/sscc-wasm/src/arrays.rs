//! Conversions between numbers of JavaScript and points, triangles, limits and pairs.

use std::fmt;

use glam::DVec3;
use sscc::Pair;

/// The error that the length of an array is not a multiple of its row length.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthError {
    pub name: &'static str,
    pub length: usize,
    pub row: usize,
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, length, row } = self;
        write!(f, "{name} has {length} numbers; their number must be a multiple of {row}")
    }
}

impl std::error::Error for LengthError {}

/// The error that a number is not a valid limit or vertex number, or that `faces` has a wrong length.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberError(String);

impl fmt::Display for NumberError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for NumberError {}

/// Returns the points of an array with 3 coordinates for each.
pub fn points(name: &'static str, numbers: &[f64]) -> Result<Vec<DVec3>, LengthError> {
    Ok(rows::<3, _>(name, numbers)?.iter().copied().map(DVec3::from).collect())
}

/// Returns the rows of an array.
pub fn rows<'a, const N: usize, T>(
    name: &'static str,
    numbers: &'a [T],
) -> Result<&'a [[T; N]], LengthError> {
    match numbers.as_chunks::<N>() {
        (rows, []) => Ok(rows),
        _ => Err(LengthError { name, length: numbers.len(), row: N }),
    }
}

/// Returns the vertex numbers of triangles. JavaScript may pass any numbers.
///
/// # Errors
/// When their number is not a multiple of 3, or one is not an integer of 32 bits.
pub fn triangles(numbers: &[f64]) -> Result<Vec<[u32; 3]>, NumberError> {
    let rows = rows::<3, _>("faces", numbers).map_err(|error| NumberError(error.to_string()))?;
    let is_vertex = |number: &f64| number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(number);
    match numbers.iter().position(|number| !is_vertex(number)) {
        Some(at) => {
            let found = numbers[at];
            Err(NumberError(format!("faces[{at}] is {found}; it must be a vertex number, counted from 0")))
        }
        // All of them are integers of 32 bits, so the conversion is exact.
        None => Ok(rows.iter().map(|row| row.map(|number| number as u32)).collect()),
    }
}

/// Returns the largest number of pairs: no limit for `undefined` and infinity.
///
/// # Errors
/// When the number is negative, NaN, or not an integer.
pub fn limit(number: Option<f64>) -> Result<usize, NumberError> {
    match number {
        None | Some(f64::INFINITY) => Ok(usize::MAX),
        // The conversion saturates.
        Some(number) if number >= 0.0 && number.fract() == 0.0 => Ok(number as usize),
        Some(number) => {
            Err(NumberError(format!("the limit is {number}; it must be an integer from 0 on, or Infinity")))
        }
    }
}

/// Returns the coordinates of points.
pub fn coordinates(points: &[DVec3]) -> Vec<f64> {
    points.iter().flat_map(DVec3::to_array).collect()
}

/// Returns the triangle numbers of pairs.
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
        assert_eq!(triangles(&[]).unwrap().len(), 0);
        let error = triangles(&[0.0, 1.0]).unwrap_err().to_string();
        assert_eq!(error, "faces has 2 numbers; their number must be a multiple of 3");
    }

    #[test]
    fn vertex_numbers_are_integers_of_32_bits() {
        let largest = f64::from(u32::MAX);
        assert_eq!(triangles(&[0.0, 2.0, largest]).unwrap(), [[0, 2, u32::MAX]]);
        for number in [f64::NAN, f64::INFINITY, -1.0, 1.9, largest + 1.0] {
            let error = triangles(&[0.0, number, 1.0]).unwrap_err().to_string();
            assert_eq!(error, format!("faces[1] is {number}; it must be a vertex number, counted from 0"));
        }
    }

    #[test]
    fn a_limit_is_an_integer_or_undefined() {
        assert_eq!(
            [limit(None), limit(Some(f64::INFINITY)), limit(Some(1e300))],
            [const { Ok(usize::MAX) }; 3]
        );
        assert_eq!([limit(Some(0.0)), limit(Some(7.0))], [Ok(0), Ok(7)]);
        for number in [f64::NAN, f64::NEG_INFINITY, -1.0, 0.5] {
            assert!(limit(Some(number)).unwrap_err().to_string().contains("Infinity"), "{number}");
        }
    }
}
