//! Limit on the memory that the content of a file may take.
//!
//! A compressed entry expands up to 1032 times, and a glTF file may refer to the same numbers in any number of targets.
//! Real files stay far below this limit: compressed modes shrink 1 to 3 times, and sparse blendshapes about 50 times.

/// Times the bytes read that may be decoded from them ...
const GROWTH: u64 = 100;

/// ... beside what any file may take.
const SMALL: u64 = 64 << 20;

/// Number of bytes that may still be decoded from a file.
#[derive(Debug)]
pub(crate) struct Allowance {
    left: u64,
    all: u64,
}

impl Allowance {
    /// For that many bytes read, and no more than `most` in any case.
    pub fn new(read: u64, most: u64) -> Self {
        let all = read.saturating_mul(GROWTH).saturating_add(SMALL).min(most);
        Self { left: all, all }
    }

    /// Takes `count` items of `size` bytes. The error is the cause of the rejection, if more is taken than is left.
    pub fn take(&mut self, count: u64, size: u64) -> Result<(), String> {
        match count.checked_mul(size).and_then(|bytes| self.left.checked_sub(bytes)) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(format!(
                "its numbers would take more than {} MiB of memory, too much for a file of this size",
                self.all >> 20
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_all_is_taken() {
        let mut allowance = Allowance::new(10, u64::MAX);
        assert!(allowance.take(u64::MAX, 2).is_err());
        assert!(allowance.take(SMALL / 8, 8).is_ok());
        assert!(allowance.take(125, 8).is_ok());
        assert!(allowance.take(1, 1).is_err());
        assert!(allowance.take(0, 8).is_ok());
        assert!(Allowance::new(u64::MAX, 100).take(101, 1).is_err());
    }
}
