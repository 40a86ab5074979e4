//! The colliding pairs of two nodes of a scene in one frame. The pairs of each node with itself are stored elsewhere.

use sscc::Pair;

/// The pairs of two bodies in a frame.
pub(super) struct NodePairs {
    pub frame: usize,
    /// The body of the first triangle of each pair, and the body of the second.
    pub bodies: [usize; 2],
    pub pairs: Vec<Pair>,
    /// Times of impact, one for each pair, of continuous checks.
    pub impacts: Vec<f32>,
    /// The segments of their contact curves.
    pub segments: Vec<[f32; 6]>,
}

impl NodePairs {
    /// Returns the size of the pairs and segments in a report (bytes).
    pub fn bytes(&self) -> usize {
        12 * self.pairs.len() + 4 * self.impacts.len() + 24 * self.segments.len()
    }
}

/// Returns the pairs of a frame. `all` is in the order of frames.
pub(super) fn of_frame(all: &[NodePairs], frame: usize) -> &[NodePairs] {
    let start = all.partition_point(|pairs| pairs.frame < frame);
    let end = all.partition_point(|pairs| pairs.frame <= frame);
    &all[start..end]
}
