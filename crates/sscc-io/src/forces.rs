//! Reader for VegaFEM's `.cub` files: reduced internal forces as cubic polynomials.
//!
//! Layout, little endian: r (i32); the numbers of monomials of degree 1, 2 and 3 (i32: r, r(r+1)/2, r(r+1)(r+2)/6); the
//! coefficients of degree 1, 2 and 3 (float64).

use std::path::Path;

use sscc::limits;
use sscc_solid::{ReducedForces, SolidError, Stiffness, monomials};

use crate::file::{ending, read_whole, unsupported};
use crate::{FormatError, IoError, Place};

/// Number of bytes before the coefficients.
const HEADER: usize = 16;

/// Reads a `.cub` file.
///
/// # Errors
/// When the name has another ending, or the file cannot be read; when its size or numbers of monomials do not fit its
/// rank, or the rank is 0; when a coefficient is not finite or beyond [`sscc::limits`], or the linear part is not
/// symmetric.
pub fn read_reduced_forces(path: &Path) -> Result<ReducedForces, IoError> {
    if ending(path) != "cub" {
        return Err(unsupported(path, "reduced forces", ".cub"));
    }
    parse_reduced_forces(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Parses a `.cub` file.
///
/// # Errors
/// As [`read_reduced_forces`].
#[expect(clippy::unreachable, reason = "16 bytes are four chunks of 4 bytes")]
pub fn parse_reduced_forces(bytes: &[u8]) -> Result<ReducedForces, FormatError> {
    let Some((header, body)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(FormatError::new(Place::Byte(bytes.len()), "the file ends within the header"));
    };
    let [rank, sizes @ ..] = header.as_chunks::<4>().0 else {
        unreachable!("16 bytes are four chunks of 4 bytes")
    };
    let rank = usize::try_from(i32::from_le_bytes(*rank)).unwrap_or_default();
    if rank == 0 {
        return Err(FormatError::new(Place::Byte(0), "the rank is 0 or less: is this a .cub file?"));
    }
    let expected = [1, 2, 3].map(|degree| monomials::count(rank, degree));
    for (i, (size, expected)) in sizes.iter().zip(expected).enumerate() {
        let (size, degree) = (i32::from_le_bytes(*size), i + 1);
        if usize::try_from(size) != Ok(expected) {
            let cause = format!("{size} monomials of degree {degree}: rank {rank} has {expected}");
            return Err(FormatError::new(Place::Byte(4 * degree), cause));
        }
    }
    // Each number of monomials is below 2^31, so the rank is below 2^16.
    let all = expected.iter().map(|size| 8 * rank as u64 * *size as u64).sum::<u64>();
    if body.len() as u64 != all {
        let cause = format!(
            "rank {rank} needs {all} bytes of coefficients, but {} bytes follow the header: is the file cut off?",
            body.len()
        );
        return Err(FormatError::new(Place::Byte(HEADER), cause));
    }
    let mut values: Vec<f64> =
        body.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    if let Some(at) = values.iter().position(|value| value.is_nan() || value.abs() > limits::LARGEST) {
        let cause = format!("a coefficient is {:e}: not a finite number, or beyond 2^200", values[at]);
        return Err(FormatError::new(Place::Byte(HEADER + 8 * at), cause));
    }
    let refused = |error: SolidError| FormatError::new(Place::Byte(HEADER), error.to_string());
    let [linear, quadratic, _] = expected.map(|size| rank * size);
    let cubic = values.split_off(linear + quadratic);
    let quadratic = values.split_off(linear);
    let linear = Stiffness::new(rank, values).map_err(refused)?;
    ReducedForces::new(linear, quadratic, cubic).map_err(refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header, then the numbers from 1 on with 2 repeated, so that the linear part of rank 2 is symmetric.
    fn file(header: [i32; 4], values: usize) -> Vec<u8> {
        let header = header.iter().flat_map(|n| n.to_le_bytes());
        let value = |i: usize| if i < 2 { i + 1 } else { i };
        header.chain((0..values).flat_map(|i| (value(i) as f64).to_le_bytes())).collect()
    }

    #[test]
    fn coefficients_are_split_by_degree() {
        let forces = parse_reduced_forces(&file([2, 2, 3, 4], 18)).unwrap();
        assert_eq!((forces.rank(), forces.linear().entries()), (2, &[1.0, 2.0, 2.0, 3.0][..]));
        assert_eq!(forces.quadratic(), [4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        assert_eq!((forces.cubic()[0], forces.cubic().len()), (10.0, 8));
    }

    #[test]
    fn errors_name_the_place() {
        let message = |bytes: &[u8]| parse_reduced_forces(bytes).unwrap_err().to_string();
        assert_eq!(message(&file([0, 0, 0, 0], 0)), "byte 0: the rank is 0 or less: is this a .cub file?");
        assert!(message(&file([-2, 2, 3, 4], 18)).contains("the rank is 0 or less"));
        assert_eq!(message(&file([2, 2, 4, 4], 18)), "byte 8: 4 monomials of degree 2: rank 2 has 3");
        assert!(message(&file([i32::MAX; 4], 18)).starts_with("byte 8: 2147483647 monomials of degree 2"));
        assert!(message(&file([1000, 1000, 500_500, 167_167_000], 18)).contains("but 144 bytes follow"));
        let mut nan = file([2, 2, 3, 4], 18);
        nan[24..32].copy_from_slice(&f64::NAN.to_le_bytes());
        let finite = "not a finite number, or beyond 2^200";
        assert_eq!(message(&nan), format!("byte 24: a coefficient is NaN: {finite}"));
        let mut huge = file([2, 2, 3, 4], 18);
        for (value, shown) in [(1e61_f64, "1e61"), (-f64::MAX, "-1.7976931348623157e308")] {
            huge[16 + 8 * 17..].copy_from_slice(&value.to_le_bytes());
            assert_eq!(message(&huge), format!("byte 152: a coefficient is {shown}: {finite}"));
        }
        let mut asymmetric = file([2, 2, 3, 4], 18);
        asymmetric[24..32].copy_from_slice(&2.1_f64.to_le_bytes());
        let message = message(&asymmetric);
        assert!(
            message
                .starts_with("byte 16: the stiffness is 2e0 at row 1, column 0 (counted from 0), but 2.1e0")
        );
        assert_eq!(read_reduced_forces(Path::new("a.U")).unwrap_err().to_string(), "a.U: not found");
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.U");
        std::fs::write(&path, nan).unwrap();
        let wrong = read_reduced_forces(&path).unwrap_err().to_string();
        assert!(wrong.ends_with("a.U: unknown kind of reduced forces file; supported: .cub"), "{wrong}");
    }

    #[test]
    fn truncations_and_extra_bytes_are_rejected() {
        let bytes = file([2, 2, 3, 4], 18);
        for len in 0..bytes.len() {
            assert!(parse_reduced_forces(&bytes[..len]).is_err(), "{len}");
        }
        assert!(parse_reduced_forces(&[&bytes[..], b"\0"].concat()).is_err());
    }
}
