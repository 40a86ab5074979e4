//! Limit on the memory that the numbers of an archive take when they are decoded, 8 bytes each.

use super::archive::place;
use crate::FormatError;
use crate::allowance::Allowance;

/// Factor on the allowance of the bytes of entries, which is 100 times the size of the archive. Sparse modes shrink about 50 times,
/// as integers of one byte, too, and each of these takes 8 bytes as a number.
const MAX_WIDENING: u64 = 4;

/// Maximum size of the numbers, for archives of any size: 8 GiB, those of entries of float32 of 4 GiB.
const MAX_NUMBER_BYTES: u64 = 8 << 30;

/// Returns an error if the numbers of all arrays take too much memory for an archive of `read` bytes. Each array has its name
/// and the number of its entries.
pub(super) fn check_numbers<'a>(
    read: u64,
    arrays: impl Iterator<Item = (&'a str, u64)>,
) -> Result<(), FormatError> {
    let mut allowance = Allowance::new(read.saturating_mul(MAX_WIDENING), MAX_NUMBER_BYTES);
    for (name, count) in arrays {
        allowance.take(count, 8).map_err(|cause| FormatError::part(place(name), cause))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const MB: u64 = 1_000_000;

    fn check(read: u64, counts: &[u64]) -> Result<(), FormatError> {
        check_numbers(read, counts.iter().map(|count| ("modes", *count)))
    }

    #[test]
    fn numbers_of_real_models_are_accepted() {
        // 400 modes of 10,475 vertices in double and single precision, compressed by 1.2, and all other parts of the model.
        let shapes = 3 * 10_475 * 400;
        for size in [4, 8] {
            check(size * shapes * 5 / 6, &[shapes, 3 * 10_475, 3 * 20_908, 55 * 10_475]).unwrap();
        }
        // Sparse modes that shrink 50 times: of 1, 2, 4 and 8 bytes.
        for size in [1, 2, 4, 8] {
            check(size * 90 * MB / 50, &[90 * MB]).unwrap();
        }
        // Entries of 4 GiB that are stored.
        for size in [4, 8] {
            check(4 << 30, &[(4 << 30) / size]).unwrap();
        }
        // Small arrays may be zeros.
        check(1000, &[8 * MB]).unwrap();
    }

    #[test]
    fn numbers_that_take_far_more_than_their_archive_are_refused() {
        // 90 million zeros of one byte in 100 kB.
        let message = check(MB / 10, &[90 * MB, 3, 3]).unwrap_err().to_string();
        assert!(
            message.starts_with("array 'modes': its numbers would take more than 102 MiB of memory"),
            "{message}"
        );
        assert!(!message.contains('\n'), "{message}");
        // Arrays count together.
        check(MB, &[50 * MB]).unwrap();
        assert!(check(MB, &[50 * MB, 50 * MB]).is_err());
        assert!(check(u64::MAX, &[u64::MAX]).is_err() && check(u64::MAX, &[(1 << 30) + 1]).is_err());
    }
}
