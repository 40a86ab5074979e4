//! Sweep and prune: pairs of bodies whose AABBs overlap.

use sscc::parts::Aabb;

/// Finds overlapping AABBs. The order along x is kept for the next search, in which it is nearly the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct SweepAndPrune {
    /// AABB of each body.
    pub boxes: Vec<Aabb>,
    /// Bodies ordered by the lower end of their AABBs along x.
    order: Vec<usize>,
    /// Pairs of bodies whose AABBs overlap, sorted.
    pub candidates: Vec<[usize; 2]>,
}

impl SweepAndPrune {
    /// Finds all candidates.
    pub fn find(&mut self) {
        let boxes = &self.boxes;
        // New bodies come last.
        self.order.retain(|n| *n < boxes.len());
        self.order.extend(self.order.len()..boxes.len());
        self.order.sort_by(|a, b| boxes[*a].lower.x.total_cmp(&boxes[*b].lower.x).then(a.cmp(b)));
        self.candidates.clear();
        for (i, &a) in self.order.iter().enumerate() {
            for &b in &self.order[i + 1..] {
                if boxes[b].lower.x > boxes[a].upper.x {
                    break;
                }
                if !boxes[a].is_disjoint(&boxes[b]) {
                    self.candidates.push([a.min(b), a.max(b)]);
                }
            }
        }
        self.candidates.sort_unstable();
    }
}
