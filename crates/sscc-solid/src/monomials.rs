//! Monomials of q in lexicographic order: `q_0 q_0, q_0 q_1, .., q_1 q_1, ..`.
//!
//! The coefficients of [`ReducedForces`](crate::ReducedForces) are in this order, as in VegaFEM's `.cub`.

use std::ops::Range;

/// Returns the number of monomials of a degree in `rank` variables; `usize::MAX` if its computation overflows.
pub fn count(rank: usize, degree: usize) -> usize {
    let mut product = 1_usize;
    for k in 0..degree {
        product = match rank.checked_add(k).and_then(|factor| product.checked_mul(factor)) {
            Some(product) => product / (k + 1),
            None => return usize::MAX,
        };
    }
    product
}

/// Returns the index of the monomial with these ascending indices among those of its degree.
pub fn place(rank: usize, indices: &[usize]) -> usize {
    let mut place = 0;
    let mut first = 0;
    for (at, index) in indices.iter().enumerate() {
        let left = indices.len() - at - 1;
        // Monomials with a smaller index here: the indices that follow start at that index.
        place += (first..*index).map(|k| count(rank - k, left)).sum::<usize>();
        first = *index;
    }
    place
}

/// Returns all monomials of a degree, as ascending indices.
pub fn all(rank: usize, degree: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..degree {
        let longer = |m: &Vec<usize>| {
            let from: Range<usize> = m.last().copied().unwrap_or(0)..rank;
            let m = m.clone();
            from.map(move |k| [&m[..], &[k]].concat())
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

/// Returns the values of all monomials of degree 2 or 3.
pub(crate) fn values(q: &[f64], degree: usize) -> Vec<f64> {
    let r = q.len();
    let mut values = Vec::with_capacity(count(r, degree));
    for a in 0..r {
        for b in a..r {
            let ab = q[a] * q[b];
            match degree {
                2 => values.push(ab),
                _ => values.extend(q[b..].iter().map(|c| ab * c)),
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_is_the_index_in_all_monomials() {
        for (rank, degree) in [(1, 3), (3, 1), (4, 2), (5, 3), (4, 4)] {
            let all = all(rank, degree);
            assert_eq!(all.len(), count(rank, degree));
            assert!(all.is_sorted());
            assert!(all.iter().enumerate().all(|(at, m)| place(rank, m) == at));
        }
        assert_eq!(values(&[2.0, 3.0], 2), [4.0, 6.0, 9.0]);
        assert_eq!(values(&[2.0, 3.0], 3), [8.0, 12.0, 18.0, 27.0]);
    }

    #[test]
    fn counts_that_overflow_saturate() {
        assert_eq!(count(usize::MAX, 1), usize::MAX);
        assert_eq!(count(usize::MAX >> 24, 3), usize::MAX);
        assert_eq!(count(usize::MAX, 2), usize::MAX);
    }
}
