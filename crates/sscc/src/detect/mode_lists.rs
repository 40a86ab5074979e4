//! Which modes move each vertex or node. A bone moves few vertices of a skin, a blendshape a part of a face: what their
//! other modes leave where it is costs nothing.

use std::ops::Range;

/// For each item its modes, ascending, and where its numbers are in an array with one for each mode of each item. Where most modes
/// move most items, no lists are stored, and each item has all modes.
#[derive(Clone, Default)]
pub(crate) struct ModeLists {
    rank: usize,
    /// Where the list of each item starts, and the end; none where each item has all modes.
    starts: Vec<usize>,
    modes: Vec<u32>,
}

impl ModeLists {
    /// All modes for each item.
    pub(crate) fn all(rank: usize) -> Self {
        Self { rank, ..Self::default() }
    }

    /// These lists.
    pub(crate) fn of_lists(rank: usize, lists: impl Iterator<Item = Vec<u32>>) -> Self {
        let (mut starts, mut modes) = (vec![0], Vec::new());
        for list in lists {
            modes.extend(list);
            starts.push(modes.len());
        }
        Self { rank, starts, modes }
    }

    /// The modes of some of these items together, for each new item.
    pub(crate) fn of_unions<I: AsRef<[u32]>>(&self, new_items: impl Iterator<Item = I>) -> Self {
        if !self.has_lists() {
            return Self::all(self.rank);
        }
        let union = |items: I| {
            let items = items.as_ref();
            let items = right_or!(items, ListedModesOfOneVertex, &items[..1]);
            let mut modes: Vec<u32> =
                items.iter().flat_map(|item| &self.modes[self.range(*item)]).copied().collect();
            modes.sort_unstable();
            modes.dedup();
            modes
        };
        Self::of_lists(self.rank, new_items.map(union))
    }

    /// Whether there are lists: else each item has all modes.
    pub(crate) fn has_lists(&self) -> bool {
        !self.starts.is_empty()
    }

    /// Where the numbers of an item are.
    #[inline]
    pub(crate) fn range(&self, item: u32) -> Range<usize> {
        let item = item as usize;
        if self.has_lists() {
            self.starts[item]..self.starts[item + 1]
        } else {
            item * self.rank..(item + 1) * self.rank
        }
    }

    /// The list of an item; none where it has all modes.
    #[inline]
    pub(crate) fn list(&self, item: u32) -> Option<&[u32]> {
        self.has_lists().then(|| &self.modes[self.range(item)])
    }

    /// The modes of an item, ascending.
    pub(crate) fn modes(&self, item: u32) -> impl Iterator<Item = u32> + '_ {
        let list = self.list(item);
        let count = list.map_or(self.rank, <[u32]>::len);
        (0..count).map(move |i| list.map_or(i as u32, |list| list[i]))
    }
}
