//! Limit on the memory that the content of a file may take.
//!
//! A compressed entry expands up to 1032 times, and a glTF file may refer to the same numbers in any number of targets.
//! Real files stay far below this limit: compressed modes shrink 1 to 3 times, and sparse blendshapes about 50 times.

/// Maximum ratio of decoded bytes to bytes read, beyond [`BASE_BYTES`].
const MAX_GROWTH: u64 = 100;

/// Bytes that may be decoded from a file of any size.
const BASE_BYTES: u64 = 64 << 20;

/// Number of bytes that may still be decoded from a file.
#[derive(Debug)]
pub(crate) struct Allowance {
    remaining: u64,
    total: u64,
}

impl Allowance {
    /// Creates the allowance of a file with `read` bytes, at most `max`.
    pub fn new(read: u64, max: u64) -> Self {
        let total = read.saturating_mul(MAX_GROWTH).saturating_add(BASE_BYTES).min(max);
        Self { remaining: total, total }
    }

    /// Adds the allowance of another file with `read` bytes.
    pub fn add(&mut self, read: u64) {
        let more = read.saturating_mul(MAX_GROWTH);
        self.remaining = self.remaining.saturating_add(more);
        self.total = self.total.saturating_add(more);
    }

    /// Takes `count` items of `size` bytes. The error is the cause of the rejection, if the items
    /// exceed the remaining bytes.
    pub fn take(&mut self, count: u64, size: u64) -> Result<(), String> {
        match count.checked_mul(size).and_then(|bytes| self.remaining.checked_sub(bytes)) {
            Some(remaining) => {
                self.remaining = remaining;
                Ok(())
            }
            None => Err(format!(
                "its numbers would take more than {} MiB of memory, too much for a file of this size: the file is damaged \
                 or malformed; write it anew",
                self.total >> 20
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_the_total_is_taken() {
        let mut allowance = Allowance::new(10, u64::MAX);
        assert!(allowance.take(u64::MAX, 2).is_err());
        assert!(allowance.take(BASE_BYTES / 8, 8).is_ok());
        assert!(allowance.take(125, 8).is_ok());
        assert!(allowance.take(1, 1).is_err());
        assert!(allowance.take(0, 8).is_ok());
        allowance.add(1);
        assert!(allowance.take(101, 1).is_err() && allowance.take(100, 1).is_ok());
        assert!(Allowance::new(u64::MAX, 100).take(101, 1).is_err());
    }
}
