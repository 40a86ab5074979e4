//! Number of random cases of a test: all cases with `CI=true` in the environment, else the first eighth.
//!
//! The first cases have the same seeds in both runs.

use std::ops::Div;

/// Returns the number of cases to try out of `all`: all cases in CI, else an eighth, at least one.
const DIVISOR: u8 = 8;

/// Returns the number of cases to try out of `all`: all of them in CI, else an eighth, at least one.
pub fn cases<T: Div<Output = T> + From<u8> + Ord>(all: T) -> T {
    scaled_cases(all, is_ci())
}

/// Scales a threshold on a count over all cases to the cases that [`cases`] tries.
pub fn threshold<T: Div<Output = T> + From<u8>>(all: T) -> T {
    scaled_threshold(all, is_ci())
}

fn scaled_cases<T: Div<Output = T> + From<u8> + Ord>(all: T, is_ci: bool) -> T {
    scaled_threshold(all, is_ci).max(T::from(1))
}

fn scaled_threshold<T: Div<Output = T> + From<u8>>(all: T, is_ci: bool) -> T {
    if is_ci { all } else { all / T::from(DIVISOR) }
}

fn is_ci() -> bool {
    std::env::var_os("CI").is_some_and(|value| value == "true")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_eighth_is_tried_outside_of_ci() {
        assert_eq!((scaled_cases(400_u64, true), scaled_cases(400_u64, false)), (400, 50));
        assert_eq!((scaled_cases(3_usize, true), scaled_cases(3_usize, false)), (3, 1));
        assert_eq!(
            (scaled_threshold(21, true), scaled_threshold(21, false), scaled_threshold(3, false)),
            (21, 2, 0)
        );
    }
}
