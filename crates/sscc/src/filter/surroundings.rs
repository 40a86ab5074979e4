//! The surroundings of pairs of triangles: the pairs that touch next where two parts of a surface rest on each other.

use super::contact_filter::Pair;
use super::pair_filter::{PairFilter, Relation};
use super::rings::Rings;
use crate::{CancelToken, Error};

/// Maximum number of pairs of the surroundings.
const MAX_PAIRS: usize = 1 << 22;

/// Maximum number of pairs that are examined: a few seconds of work. Surroundings of neighbouring pairs overlap, so many more
/// pairs are examined than found.
const MAX_WORK: usize = 1 << 28;

/// Returns all pairs of which one triangle lies within that many rings of the first triangle of one of `pairs`, and the
/// other one within as many rings of its second triangle. Triangles with a common vertex are one ring apart: around a
/// triangle whose vertices have six edges each there are 13 within one ring and 37 within two. With 0 rings these are
/// `pairs` themselves; otherwise pairs that never count by their relation are left out. Sorted.
///
/// # Errors
/// If there are more than 2^22 pairs, or more than 2^24 around one pair or 2^28 in all must be examined (without a
/// limit for 0 rings); if the search is cancelled.
pub(crate) fn surroundings(
    filter: &PairFilter,
    pairs: &[Pair],
    rings: u32,
    cancel: Option<&CancelToken>,
) -> Result<Vec<Pair>, Error> {
    let ascending = |(a, b): Pair| (a.min(b), a.max(b));
    let mut search = Rings::new(filter, rings);
    let around = |(a, b): Pair| {
        let around_a = search.around(filter, a).to_vec();
        let kept = with_mutant!(around_a.len(), SurroundingsOfOne, 1);
        (around_a[..kept].to_vec(), search.around(filter, b).to_vec())
    };
    let counts = |(a, b): Pair| a != b && filter.relation(a, b) != Relation::Adjacent;
    collect(pairs.iter().copied().map(ascending), rings, cancel, around, |pair| {
        counts(pair).then(|| ascending(pair))
    })
}

/// Returns the surroundings of pairs between two meshes: (triangle of the first, triangle of the second). No pair is
/// left out, also if its groups do not count.
///
/// # Errors
/// As [`surroundings`].
pub(crate) fn surroundings_between(
    filters: [&PairFilter; 2],
    pairs: &[Pair],
    rings: u32,
    cancel: Option<&CancelToken>,
) -> Result<Vec<Pair>, Error> {
    let mut search = filters.map(|filter| Rings::new(filter, rings));
    let around =
        |(a, b): Pair| (search[0].around(filters[0], a).to_vec(), search[1].around(filters[1], b).to_vec());
    collect(pairs.iter().copied(), rings, cancel, around, Some)
}

/// Passes each pair of triangles around a pair to `kept`, and collects the pairs that it returns.
fn collect(
    pairs: impl Iterator<Item = Pair>,
    rings: u32,
    cancel: Option<&CancelToken>,
    mut around: impl FnMut(Pair) -> (Vec<u32>, Vec<u32>),
    kept: impl Fn(Pair) -> Option<Pair>,
) -> Result<Vec<Pair>, Error> {
    if rings == 0 {
        let mut pairs: Vec<Pair> = pairs.collect();
        pairs.sort_unstable();
        pairs.dedup();
        return Ok(pairs);
    }
    let too_many = || Err(Error::TooManyIgnored { most: MAX_PAIRS, rings });
    let (mut found, mut sorted, mut work) = (Vec::new(), 0, 0_usize);
    for pair in pairs {
        if cancel.is_some_and(CancelToken::is_cancelled) {
            return Err(Error::Cancelled);
        }
        let (around_a, around_b) = around(pair);
        let size = around_a.len().saturating_mul(around_b.len());
        work = work.saturating_add(size);
        if size > 4 * MAX_PAIRS || work > MAX_WORK {
            return too_many();
        }
        for a in around_a {
            found.extend(around_b.iter().filter_map(|b| kept((a, *b))));
        }
        if found.len() - sorted > MAX_PAIRS {
            found.sort_unstable();
            found.dedup();
            sorted = found.len();
            if sorted > MAX_PAIRS {
                return too_many();
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    if found.len() > MAX_PAIRS { too_many() } else { Ok(found) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ContactFilter;

    #[test]
    fn surroundings_are_those_of_both_triangles() {
        // Two strips of six triangles: of each triangle the next two share a vertex with it.
        let strip = |first: u32| (first..first + 6).map(|i| [i, i + 1, i + 2]);
        let faces: Vec<[u32; 3]> = strip(0).chain(strip(20)).collect();
        let filter = PairFilter::with_classes(&faces, None, &ContactFilter::default());
        assert_eq!(surroundings(&filter, &[(6, 0), (0, 6)], 0, None), Ok(vec![(0, 6)]));
        let expected: Vec<Pair> = (0..3).flat_map(|a| (6..9).map(move |b| (a, b))).collect();
        assert_eq!(surroundings(&filter, &[(0, 6)], 1, None), Ok(expected.clone()));
        assert_eq!(surroundings_between([&filter; 2], &[(0, 6)], 1, None), Ok(expected));
    }

    /// Pairs that never count, of a triangle and itself or a neighbour, are left out, and no others.
    #[test]
    fn surroundings_within_one_strip_are_pairs_that_count() {
        let faces: Vec<[u32; 3]> = (0..9).map(|i| [i, i + 1, i + 2]).collect();
        let filter = PairFilter::with_classes(&faces, None, &ContactFilter::default());
        let near = |a: u32, b: u32| u32::abs_diff(a, b) <= 2;
        let expected: Vec<Pair> = (0..9)
            .flat_map(|a| (a + 1..9).map(move |b| (a, b)))
            .filter(|&(a, b)| !near(a, b) && ((near(a, 1) && near(b, 4)) || (near(a, 4) && near(b, 1))))
            .collect();
        assert_eq!(surroundings(&filter, &[(4, 1)], 1, None), Ok(expected));
    }

    /// Pairs that are found more than once count once.
    #[test]
    fn the_limits_are_those_of_different_pairs() {
        let find = |n: u32, m: u32, kept: fn(Pair) -> Option<Pair>| {
            let around = |_| ((0..n).collect(), (0..m).collect());
            collect([(0, 0)].into_iter(), 1, None, around, kept).map(|pairs| pairs.len())
        };
        let too_many = Err(Error::TooManyIgnored { most: MAX_PAIRS, rings: 1 });
        let side = MAX_PAIRS.isqrt() as u32;
        assert_eq!(find(side, side, Some), Ok(MAX_PAIRS));
        assert_eq!(find(side, side + 1, Some), too_many);
        // More than the limit, of which two differ.
        assert_eq!(find(side + 1, side + 1, |(_, b)| Some((0, b % 2))), Ok(2));
        // The surroundings of one pair are not even listed if they have four times as many.
        assert_eq!(find(2 * side, 2 * side + 1, |_| panic!("listed")), too_many);
    }
}
