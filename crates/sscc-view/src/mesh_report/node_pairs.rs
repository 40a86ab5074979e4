//! The colliding pairs of two nodes of a scene in one frame, beside those of each node with itself.

use sscc::Pair;

/// The pairs of two bodies in a frame.
pub(super) struct NodePairs {
    pub frame: usize,
    /// The body of the first triangle of each pair, and that of the second.
    pub bodies: [usize; 2],
    pub pairs: Vec<Pair>,
    /// Times of impact, one for each pair, of continuous checks.
    pub impacts: Vec<f32>,
    /// The segments of their contact curves.
    pub segments: Vec<[f32; 6]>,
}

impl NodePairs {
    /// Size of the pairs and segments in a report (bytes).
    pub fn bytes(&self) -> usize {
        12 * self.pairs.len() + 4 * self.impacts.len() + 24 * self.segments.len()
    }
}

/// Returns those of a frame; all are in the order of their frames.
pub(super) fn of_frame(all: &[NodePairs], frame: usize) -> &[NodePairs] {
    let start = all.partition_point(|pairs| pairs.frame < frame);
    let end = all.partition_point(|pairs| pairs.frame <= frame);
    &all[start..end]
}
