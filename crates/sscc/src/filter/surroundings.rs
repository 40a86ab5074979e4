//! The surroundings of pairs of triangles: what touches next where two parts of a surface rest on each other.

use super::contact_filter::Pair;
use super::pair_filter::{PairFilter, Relation};
use super::rings::Rings;
use crate::Error;

/// Pairs of the surroundings, at most.
const MAX_PAIRS: usize = 1 << 22;

/// Pairs that are looked at, at most: a few seconds of work. Surroundings of neighbouring pairs overlap, so these are many
/// more.
const MAX_WORK: usize = 1 << 28;

/// All pairs of which one triangle lies within that many rings of the first triangle of one of `pairs`, and the other one within as
/// many of its second. Triangles with a common vertex are one ring apart: around a triangle whose vertices have six edges each there
/// are 13 within one ring and 37 within two. With rings,
/// pairs that never count are left out. Sorted.
///
/// # Errors
/// When they are more than 2^22, or more than 2^28 must be looked at.
pub(crate) fn surroundings(filter: &PairFilter, pairs: &[Pair], rings: u32) -> Result<Vec<Pair>, Error> {
    if rings == 0 {
        let mut pairs: Vec<Pair> = pairs.iter().map(|(a, b)| (*a.min(b), *a.max(b))).collect();
        pairs.sort_unstable();
        pairs.dedup();
        return Ok(pairs);
    }
    let too_many = || Err(Error::TooManyIgnored { most: MAX_PAIRS, rings });
    let mut search = Rings::new(filter, rings);
    let (mut found, mut sorted, mut work) = (Vec::new(), 0, 0_usize);
    for &(a, b) in pairs {
        let around_a = search.around(filter, a).to_vec();
        let around_b = search.around(filter, b);
        work = work.saturating_add(around_a.len().saturating_mul(around_b.len()));
        if around_a.len().saturating_mul(around_b.len()) > 4 * MAX_PAIRS || work > MAX_WORK {
            return too_many();
        }
        for &a in right_or!(&around_a[..], SurroundingsOfOne, &around_a[..1]) {
            let counted = around_b.iter().filter(|&&b| a != b && filter.relation(a, b) != Relation::Adjacent);
            found.extend(counted.map(|&b| (a.min(b), a.max(b))));
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
