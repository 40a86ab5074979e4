//! VegaFEM's `.cub`: reduced internal forces as cubic polynomials.
//!
//! Little endian: r (i32), the numbers of monomials of degree 1, 2 and 3 (i32: r, r(r+1)/2, r(r+1)(r+2)/6), then as
//! float64 the coefficients of degree 1, 2 and 3.

use std::path::Path;

use crate::file::{ending, read_whole, unsupported};
use crate::{FormatError, IoError, Place};

/// The bytes before the coefficients.
const HEADER: usize = 16;

/// Reduced internal forces of a body of rank r: r polynomials of degree 3 in q, without constant terms.
///
/// Each part has the coefficients of force 0, then of force 1, and so on; within one force, monomials are in
/// lexicographic order of their indices: q_0 q_0, q_0 q_1, .., q_1 q_1, q_1 q_2, ..
#[derive(Clone, Debug, PartialEq)]
pub struct Cubic {
    /// Length of q, and number of forces.
    pub rank: usize,
    /// r x r, row after row: the stiffness at rest.
    pub linear: Vec<f64>,
    /// r rows of r(r+1)/2: of q_i q_j, i <= j.
    pub quadratic: Vec<f64>,
    /// r rows of r(r+1)(r+2)/6: of q_i q_j q_k, i <= j <= k.
    pub cubic: Vec<f64>,
}

/// Reads a `.cub` file.
///
/// # Errors
/// When the name has another ending, the file cannot be read, its size or the numbers of its monomials do not agree
/// with its rank, that is 0, or a coefficient is not finite.
pub fn read_cubic(path: &Path) -> Result<Cubic, IoError> {
    if ending(path) != "cub" {
        return Err(unsupported(path, "reduced forces", ".cub"));
    }
    parse_cubic(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Parses a `.cub` file.
///
/// # Errors
/// As [`read_cubic`].
pub fn parse_cubic(bytes: &[u8]) -> Result<Cubic, FormatError> {
    let Some((header, body)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(FormatError::new(Place::Byte(bytes.len()), "the file ends within the header"));
    };
    let [rank, sizes @ ..] = header.as_chunks::<4>().0 else { unreachable!("16 bytes are four of 4") };
    let rank = u64::try_from(i32::from_le_bytes(*rank)).unwrap_or_default();
    if rank == 0 {
        return Err(FormatError::new(Place::Byte(0), "a rank of 0 or less: is this a .cub file?"));
    }
    // Below 2^31 r is: the products stay below 2^93.
    let r = u128::from(rank);
    let expected = monomials(r);
    for (i, (size, expected)) in sizes.iter().zip(expected).enumerate() {
        let (size, degree) = (i32::from_le_bytes(*size), i + 1);
        if u128::try_from(size) != Ok(expected) {
            let cause = format!("{size} monomials of degree {degree}: rank {rank} has {expected}");
            return Err(FormatError::new(Place::Byte(4 * degree), cause));
        }
    }
    let all = 8 * r * expected.iter().sum::<u128>();
    if body.len() as u128 != all {
        let cause = format!("rank {rank} needs {all} bytes, but {} follow: is the file cut off?", body.len());
        return Err(FormatError::new(Place::Byte(HEADER), cause));
    }
    let values: Vec<f64> = body.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let cause = format!("a coefficient is {}, not a finite number", values[at]);
        return Err(FormatError::new(Place::Byte(HEADER + 8 * at), cause));
    }
    // As the size of the body was found right, these products are within it.
    let [linear, quadratic, _] = expected.map(|size| (r * size) as usize);
    let (linear, rest) = values.split_at(linear);
    let (quadratic, cubic) = rest.split_at(quadratic);
    let (linear, quadratic, cubic) = (linear.to_vec(), quadratic.to_vec(), cubic.to_vec());
    Ok(Cubic { rank: rank as usize, linear, quadratic, cubic })
}

/// The numbers of monomials of degree 1, 2 and 3 in r variables, for r below 2^40.
pub(crate) fn monomials(r: u128) -> [u128; 3] {
    [r, r * (r + 1) / 2, r * (r + 1) * (r + 2) / 6]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: [i32; 4], values: usize) -> Vec<u8> {
        let header = header.iter().flat_map(|n| n.to_le_bytes());
        header.chain((0..values).flat_map(|i| (i as f64).to_le_bytes())).collect()
    }

    #[test]
    fn parts_follow_each_other() {
        let cubic = parse_cubic(&file([2, 2, 3, 4], 18)).unwrap();
        assert_eq!((cubic.rank, cubic.linear), (2, vec![0.0, 1.0, 2.0, 3.0]));
        assert_eq!(cubic.quadratic, [4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        assert_eq!((cubic.cubic[0], cubic.cubic.len()), (10.0, 8));
    }

    #[test]
    fn bad_files_are_named() {
        let message = |bytes: &[u8]| parse_cubic(bytes).unwrap_err().to_string();
        assert_eq!(message(&file([0, 0, 0, 0], 0)), "byte 0: a rank of 0 or less: is this a .cub file?");
        assert!(message(&file([-2, 2, 3, 4], 18)).contains("a rank of 0 or less"));
        assert_eq!(message(&file([2, 2, 4, 4], 18)), "byte 8: 4 monomials of degree 2: rank 2 has 3");
        assert!(message(&file([i32::MAX; 4], 18)).starts_with("byte 8: 2147483647 monomials of degree 2"));
        assert!(message(&file([1000, 1000, 500_500, 167_167_000], 18)).contains("but 144 follow"));
        let mut nan = file([2, 2, 3, 4], 18);
        nan[24..32].copy_from_slice(&f64::NAN.to_le_bytes());
        assert_eq!(message(&nan), "byte 24: a coefficient is NaN, not a finite number");
        assert_eq!(read_cubic(Path::new("a.U")).unwrap_err().to_string(), "a.U: not found");
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.U");
        std::fs::write(&path, nan).unwrap();
        let wrong = read_cubic(&path).unwrap_err().to_string();
        assert!(wrong.ends_with("a.U: unknown kind of reduced forces file; supported: .cub"), "{wrong}");
    }

    #[test]
    fn every_truncation_and_any_extra_is_refused() {
        let bytes = file([2, 2, 3, 4], 18);
        for len in 0..bytes.len() {
            assert!(parse_cubic(&bytes[..len]).is_err(), "{len}");
        }
        assert!(parse_cubic(&[&bytes[..], b"\0"].concat()).is_err());
    }
}
