//! The surroundings of pairs of triangles, within a mesh and between two.

use super::Detector;
use crate::filter::{surroundings, surroundings_between};
use crate::{Error, Pair};

impl Detector {
    /// Returns these pairs of triangles and all pairs within `rings` rings of them, sorted: one triangle is within the
    /// rings around the first triangle of a pair, the other one within those around the second. Triangles with a common
    /// vertex are one ring apart. Unless `rings` is 0, pairs that never count are left out. Pass the result to
    /// [`ContactFilter::ignoring`](crate::ContactFilter::ignoring) to ignore parts that touch at rest.
    ///
    /// # Errors
    /// When a pair names a triangle that the mesh does not have; unless `rings` is 0, when the result has more than
    /// 2^22 pairs, more than 2^28 pairs must be examined (or 2^24 around one pair), or the search was cancelled.
    pub fn surroundings(&self, pairs: &[Pair], rings: u32) -> Result<Vec<Pair>, Error> {
        let larger = pairs.iter().map(|(a, b)| *a.max(b));
        check_triangles(larger, self.context.filter.faces().len())?;
        surroundings(&self.context.filter, pairs, rings, self.context.cancel.as_ref())
    }
}

/// Returns the surroundings of pairs (triangle of the first detector's mesh, triangle of the second's), as
/// [`Detector::surroundings`]. All pairs between two meshes count.
///
/// # Errors
/// As [`Detector::surroundings`]; the token of the first detector cancels.
pub fn surroundings_between_meshes(
    detectors: [&Detector; 2],
    pairs: &[Pair],
    rings: u32,
) -> Result<Vec<Pair>, Error> {
    let filters = detectors.map(|detector| &*detector.context.filter);
    check_triangles(pairs.iter().map(|pair| pair.0), filters[0].faces().len())?;
    check_triangles(pairs.iter().map(|pair| pair.1), filters[1].faces().len())?;
    surroundings_between(filters, pairs, rings, detectors[0].context.cancel.as_ref())
}

fn check_triangles(of_pairs: impl Iterator<Item = u32>, triangles: usize) -> Result<(), Error> {
    match of_pairs.enumerate().find(|(_, triangle)| *triangle as usize >= triangles) {
        Some((pair, triangle)) => Err(Error::PairIndex { pair, triangle, triangles }),
        None => Ok(()),
    }
}
