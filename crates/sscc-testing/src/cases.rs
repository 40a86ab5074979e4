//! How many of their random cases tests try: the first quarter, and all of them where the environment says `CI=true`.
//! Both begin with the same seeds.

use std::ops::Div;

/// Of all cases, one in so many is tried outside of CI.
const SHARE: u8 = 4;

/// The number of cases to try of this many: all of them in CI, else the first quarter, but at least one.
pub fn cases<T: Div<Output = T> + From<u8> + Ord>(all: T) -> T {
    of_cases(all, is_ci())
}

/// What a count over all cases must exceed, for the cases that [`cases`] tries.
pub fn threshold<T: Div<Output = T> + From<u8>>(all: T) -> T {
    of_threshold(all, is_ci())
}

fn of_cases<T: Div<Output = T> + From<u8> + Ord>(all: T, is_ci: bool) -> T {
    of_threshold(all, is_ci).max(T::from(1))
}

fn of_threshold<T: Div<Output = T> + From<u8>>(all: T, is_ci: bool) -> T {
    if is_ci { all } else { all / T::from(SHARE) }
}

fn is_ci() -> bool {
    std::env::var_os("CI").is_some_and(|value| value == "true")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_is_tried_outside_of_ci() {
        assert_eq!((of_cases(400_u64, true), of_cases(400_u64, false)), (400, 100));
        assert_eq!((of_cases(3_usize, true), of_cases(3_usize, false)), (3, 1));
        assert_eq!((of_threshold(21, true), of_threshold(21, false), of_threshold(3, false)), (21, 5, 0));
    }
}
