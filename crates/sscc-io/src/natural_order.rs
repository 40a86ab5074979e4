//! Natural order of names: numbers in names by their value, so that `frame9.obj` comes before `frame10.obj`.

use std::cmp::Ordering;

/// Compares two names. Runs of digits are compared by value, all else by bytes, letters of ASCII in any case; names that
/// differ in case and leading zeros only are compared by bytes.
pub(crate) fn compare(a: &[u8], b: &[u8]) -> Ordering {
    let (mut rest_a, mut rest_b) = (a, b);
    loop {
        let (number_a, number_b) = (leading_digits(rest_a), leading_digits(rest_b));
        let order = if number_a.is_empty() || number_b.is_empty() {
            match (rest_a.split_first(), rest_b.split_first()) {
                (Some((x, left_a)), Some((y, left_b))) => {
                    (rest_a, rest_b) = (left_a, left_b);
                    x.to_ascii_lowercase().cmp(&y.to_ascii_lowercase())
                }
                (None, None) => return a.cmp(b),
                (x, y) => return x.is_some().cmp(&y.is_some()),
            }
        } else {
            (rest_a, rest_b) = (&rest_a[number_a.len()..], &rest_b[number_b.len()..]);
            let [x, y] = [number_a, number_b].map(without_zeros);
            x.len().cmp(&y.len()).then_with(|| x.cmp(y))
        };
        if order.is_ne() {
            return order;
        }
    }
}

fn leading_digits(name: &[u8]) -> &[u8] {
    &name[..name.iter().take_while(|c| c.is_ascii_digit()).count()]
}

fn without_zeros(digits: &[u8]) -> &[u8] {
    &digits[digits.iter().take_while(|c| **c == b'0').count()..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared_by_value() {
        let sorted = [
            "",
            "0.obj",
            "1.obj",
            "01.obj",
            "9.obj",
            "10.obj",
            "99999999999999999999999.obj",
            "a",
            "a1b2.obj",
            "a1b10.obj",
            "a2b1.obj",
            "a2b1.off",
            "b",
            "B1.obj",
            "b2.obj",
        ];
        let mut names = sorted;
        names.reverse();
        names.sort_by(|a, b| compare(a.as_bytes(), b.as_bytes()));
        let expected = |a: &str, b: &str| compare(a.as_bytes(), b.as_bytes());
        // Equal values: the bytes decide.
        assert_eq!(expected("01.obj", "1.obj"), Ordering::Less);
        let mut sorted = sorted;
        sorted.swap(2, 3);
        assert_eq!(names, sorted);
    }
}
