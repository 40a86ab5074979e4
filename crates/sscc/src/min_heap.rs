//! Entries of a `BinaryHeap` that pops the smallest number first, in the same order in every run.
//!
//! `BinaryHeap` pops its largest entry and needs a total order, which f64 does not have: keys compare by
//! `f64::total_cmp`, reversed. Answers must not depend on the order in which entries were pushed, so each entry also
//! has an order among equal keys.

use std::cmp::Ordering;

/// A heap entry; the smallest key is popped first. Equal keys are popped in the order of `order`. `item` is not
/// compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MinHeapEntry<T, I = ()> {
    pub(crate) key: f64,
    pub(crate) order: T,
    pub(crate) item: I,
}

impl<T> MinHeapEntry<T> {
    /// Creates an entry without an item.
    pub(crate) fn new(key: f64, order: T) -> Self {
        Self { key, order, item: () }
    }
}

impl<T: Ord, I> Ord for MinHeapEntry<T, I> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.key.total_cmp(&self.key).then_with(|| other.order.cmp(&self.order))
    }
}

impl<T: Ord, I> PartialOrd for MinHeapEntry<T, I> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T: Ord, I> PartialEq for MinHeapEntry<T, I> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T: Ord, I> Eq for MinHeapEntry<T, I> {}

#[cfg(test)]
mod tests {
    use std::collections::BinaryHeap;

    use super::MinHeapEntry;

    #[test]
    fn smallest_key_pops_first_and_ties_break_by_the_smaller_one() {
        let entries = [(2.0, 1), (f64::INFINITY, 0), (0.5, 9), (2.0, 0), (0.0, 4), (-0.0, 5), (0.5, 8)];
        let mut heap: BinaryHeap<_> =
            entries.iter().map(|&(key, order)| MinHeapEntry { key, order, item: -order }).collect();
        let mut popped = Vec::new();
        while let Some(MinHeapEntry { key, order, item }) = heap.pop() {
            assert_eq!(item, -order);
            popped.push((key, order));
        }
        // -0.0 comes before 0.0.
        assert_eq!(popped, [(-0.0, 5), (0.0, 4), (0.5, 8), (0.5, 9), (2.0, 0), (2.0, 1), (f64::INFINITY, 0)]);
    }
}
