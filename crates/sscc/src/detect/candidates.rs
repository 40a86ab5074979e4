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
    /// The two buckets share no vertex and no groups apply, so that none of their triangle pairs is adjacent. Then neither masks
    /// nor vertex classes, which are far apart in memory, are read.
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
}
