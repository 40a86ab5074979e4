//! Pairs of triangles whose AABBs overlap, collected for the separating-axis test, which tests eight side by side.

use super::aabb8::LANES;

/// At most eight pairs of triangles of two buckets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    pub(super) count: usize,
    /// The slots of each pair.
    pub(super) slots: [[usize; 2]; LANES],
    /// The places of the corners of the first and of the second triangles in the positions of their volumes.
    pub(super) corners: [[[u32; 3]; LANES]; 2],
    /// The two buckets are of two meshes, or they share no vertex and no groups apply. Then none of their triangle pairs is
    /// adjacent (groups of two meshes are tested later), and neither masks nor vertex classes, which are far apart in memory, are
    /// read.
    pub(super) share_no_vertex: bool,
}

impl Candidates {
    /// Adds a pair. Returns whether there are eight pairs now, which must be tested before another one is added.
    #[inline]
    pub(super) fn push(&mut self, slots: [usize; 2], [first, second]: [[u32; 3]; 2]) -> bool {
        let lane = self.count;
        self.slots[lane] = slots;
        self.corners[0][lane] = first;
        self.corners[1][lane] = second;
        self.count += 1;
        self.count == LANES
    }

    /// Removes all pairs and returns their number. All lanes have corners of this search: the unused ones those of the first pair,
    /// because those of an earlier search may be places beyond the end of the positions.
    #[inline]
    pub(super) fn take(&mut self) -> usize {
        let used = std::mem::take(&mut self.count);
        for corners in &mut self.corners {
            let first = corners[0];
            let unused = with_mutant!(used, UnusedLanesKept, LANES);
            corners[unused..].fill(first);
        }
        used
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unused_lanes_have_the_corners_of_the_first_pair() {
        let mut candidates = Candidates::default();
        let corners = |i: u32| [[i, i + 1, i + 2], [2 * i, 3 * i, 4 * i]];
        assert!((0..7).all(|i| !candidates.push([0, 0], corners(100 + i))));
        assert!(candidates.push([3, 4], corners(7)));
        assert_eq!(candidates.take(), LANES);
        assert_eq!(candidates.corners[1][0], corners(100)[1]);
        assert!(!candidates.push([1, 2], corners(5)) && !candidates.push([1, 3], corners(6)));
        assert_eq!(candidates.take(), 2);
        for (side, corners_of_side) in candidates.corners.iter().enumerate() {
            assert_eq!(corners_of_side[1], corners(6)[side]);
            let others = [0, 2, 3, 4, 5, 6, 7].map(|lane| corners_of_side[lane]);
            assert_eq!(others, [corners(5)[side]; 7]);
        }
        assert_eq!(candidates.take(), 0);
    }
}
