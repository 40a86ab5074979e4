//! An interval tree of AABBs: it finds those near another one without a comparison of all pairs.

use std::ops::Range;

use sscc::parts::Aabb;

use super::node_boxes::are_apart;

/// AABBs in the order of their lower ends along one axis. The middle of a range of them is the root of a subtree, and both halves
/// are its children, again and again; each subtree has its largest upper end (Cormen et al., *Introduction to Algorithms*,
/// section on interval trees).
///
/// A sweep along the axis finds the same pairs in the order of the axis. The tree finds them box by box, so that errors and
/// answers come in the order of the boxes, and no list of all pairs is needed.
pub(super) struct IntervalTree<'b> {
    boxes: &'b [Aabb],
    axis: usize,
    /// Numbers of the boxes in this order.
    order: Vec<usize>,
    /// The largest upper end in the subtree of each place of `order`.
    uppers: Vec<f64>,
}

impl<'b> IntervalTree<'b> {
    /// Creates the tree along the axis on which the fewest boxes overlap. Costs O(n log n).
    pub fn new(boxes: &'b [Aabb]) -> Self {
        let axis = (0..3).min_by_key(|axis| overlaps(boxes, *axis)).unwrap_or_default();
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|a, b| boxes[*a].lower[axis].total_cmp(&boxes[*b].lower[axis]));
        let mut tree = Self { boxes, axis, uppers: vec![f64::NEG_INFINITY; order.len()], order };
        tree.set_uppers(0..boxes.len());
        tree
    }

    /// Replaces `found` by the numbers of all boxes before `number` that are not farther from it than a distance along any axis,
    /// ascending. Costs O(log n + m log m), where m boxes overlap along the axis of the tree.
    pub fn find_before(&self, number: usize, distance: f64, found: &mut Vec<usize>) {
        found.clear();
        self.search(0..self.order.len(), number, distance, found);
        found.sort_unstable();
    }

    /// Sets the largest upper ends of the subtree of a range, and returns that of its root.
    fn set_uppers(&mut self, range: Range<usize>) -> f64 {
        if range.is_empty() {
            return f64::NEG_INFINITY;
        }
        let root = root_of(&range);
        let below = self.set_uppers(range.start..root);
        let above = self.set_uppers(root + 1..range.end);
        self.uppers[root] = self.boxes[self.order[root]].upper[self.axis].max(below).max(above);
        self.uppers[root]
    }

    /// Appends the boxes of a range. A subtree is left out only if [`are_apart`] holds for all of it: a difference of a larger or
    /// equal number and a smaller or equal one is not rounded to less.
    fn search(&self, range: Range<usize>, number: usize, distance: f64, found: &mut Vec<usize>) {
        if range.is_empty() {
            return;
        }
        let (root, axis, wanted) = (root_of(&range), self.axis, &self.boxes[number]);
        if wanted.lower[axis] - self.uppers[root] > distance {
            return;
        }
        self.search(range.start..root, number, distance, found);
        let other = self.order[root];
        if self.boxes[other].lower[axis] - wanted.upper[axis] > distance {
            return;
        }
        if other < number && !are_apart(&self.boxes[other], wanted, distance) {
            found.push(other);
        }
        self.search(root + 1..range.end, number, distance, found);
    }
}

/// Returns the place of the root of a range that is not empty.
fn root_of(range: &Range<usize>) -> usize {
    range.start + range.len() / 2
}

/// Returns the number of pairs of boxes that overlap along an axis, each counted twice, and each box once with itself.
fn overlaps(boxes: &[Aabb], axis: usize) -> usize {
    let sorted = |mut ends: Vec<f64>| {
        ends.sort_by(f64::total_cmp);
        ends
    };
    let lowers = sorted(boxes.iter().map(|aabb| aabb.lower[axis]).collect());
    let uppers = sorted(boxes.iter().map(|aabb| aabb.upper[axis]).collect());
    // Those that begin before a box ends, without those that end before it begins.
    let overlapping = |aabb: &Aabb| {
        let begun = lowers.partition_point(|lower| *lower <= aabb.upper[axis]);
        begun.saturating_sub(uppers.partition_point(|upper| *upper < aabb.lower[axis]))
    };
    boxes.iter().map(overlapping).fold(0, usize::saturating_add)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Integers from a sequence without a pattern.
    struct Numbers(u64);

    impl Numbers {
        fn below(&mut self, count: u64) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((self.0 >> 33) % count) as f64
        }
    }

    /// Boxes with corners on a grid, so that many touch, scaled by a number that is no power of 2. `sizes` are the largest ones.
    fn boxes(numbers: &mut Numbers, count: usize, space: u64, sizes: [u64; 3]) -> Vec<Aabb> {
        let aabb = |numbers: &mut Numbers| {
            let lower = DVec3::from_array([0, 1, 2].map(|_| numbers.below(space)));
            let size = DVec3::from_array(sizes.map(|size| numbers.below(size)));
            Aabb { lower: lower * 0.1, upper: (lower + size) * 0.1 }
        };
        (0..count).map(|_| aabb(numbers)).collect()
    }

    /// Returns the pairs of all boxes that are not apart, each tested, ordered by the second box.
    fn all_pairs(boxes: &[Aabb], distance: f64) -> Vec<[usize; 2]> {
        let pairs = (0..boxes.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        pairs.filter(|[a, b]| !are_apart(&boxes[*a], &boxes[*b], distance)).collect()
    }

    fn found_pairs(boxes: &[Aabb], distance: f64) -> Vec<[usize; 2]> {
        let (tree, mut before, mut found) = (IntervalTree::new(boxes), Vec::new(), Vec::new());
        for b in 0..boxes.len() {
            tree.find_before(b, distance, &mut before);
            found.extend(before.iter().map(|a| [*a, b]));
        }
        found
    }

    #[test]
    fn the_pairs_and_their_order_are_those_of_all_comparisons() {
        let numbers = &mut Numbers(3);
        let mut count = 0;
        for boxes_count in [0, 1, 2, 3, 7, 40] {
            for sizes in [[1, 1, 1], [4, 4, 4], [30, 1, 2], [3, 30, 30]] {
                for space in [1, 5, 30] {
                    let mut boxes = boxes(numbers, boxes_count, space, sizes);
                    // One box around all others, and an empty one.
                    if boxes_count > 3 {
                        boxes[2] = boxes.iter().fold(Aabb::EMPTY, |all, aabb| all.union(aabb));
                        boxes[3] = Aabb::EMPTY;
                    }
                    for distance in [0.0, 0.1, 0.30000000000000004, 5.0] {
                        let expected = all_pairs(&boxes, distance);
                        count += expected.len();
                        assert_eq!(found_pairs(&boxes, distance), expected, "{sizes:?} {space} {distance}");
                    }
                }
            }
        }
        assert!(count > 10_000, "{count}");
    }

    /// Boxes in a row, and on all of them one wide box.
    #[test]
    fn the_tree_is_along_the_axis_on_which_the_fewest_boxes_overlap() {
        for axis in 0..3 {
            let place = |number: usize| {
                let mut lower = DVec3::ZERO;
                lower[axis] = 2.0 * number as f64;
                Aabb { lower, upper: lower + DVec3::ONE }
            };
            let mut boxes: Vec<Aabb> = (0..9).map(place).collect();
            boxes.push(boxes.iter().fold(Aabb::EMPTY, |all, aabb| all.union(aabb)));
            assert_eq!(
                [0, 1, 2].map(|other| overlaps(&boxes, other) == 10 + 2 * 9),
                [0, 1, 2].map(|k| k == axis)
            );
            assert_eq!(IntervalTree::new(&boxes).axis, axis);
        }
    }
}
