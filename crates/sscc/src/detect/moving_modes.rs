//! The modes that move each vertex or node. A bone moves few vertices of a skin, so that most displacements are zero, and sums can skip
//! them.

use std::ops::Range;

use crate::parallel;

/// For each item the modes that move it, ascending, and the range of its numbers in an array with one number for each mode of each
/// item.
#[derive(Clone, Default)]
pub(crate) struct MovingModes {
    rank: usize,
    /// The start of the modes of each item, then the end; empty if each item has all modes.
    starts: Vec<usize>,
    modes: Vec<u32>,
}

impl MovingModes {
    /// Returns all modes for each item.
    pub(crate) fn all(rank: usize) -> Self {
        Self { rank, ..Self::default() }
    }

    /// Returns listed modes, a list for each item.
    pub(crate) fn listed(rank: usize, lists: impl IntoIterator<Item = Vec<u32>>) -> Self {
        let (mut starts, mut modes) = (vec![0], Vec::new());
        for list in lists {
            modes.extend(list);
            starts.push(modes.len());
        }
        Self { rank, starts, modes }
    }

    /// Returns the modes of groups as new items: for each group the modes that move any of its items.
    pub(crate) fn of_groups(&self, groups: &[Vec<u32>]) -> Self {
        if !self.are_listed() {
            return Self::all(self.rank);
        }
        let union = |items: &Vec<u32>| -> Vec<u32> {
            let mut is_moving = vec![false; self.rank];
            for item in with_mutant!(&items[..], MovingModesOfOneVertex, &items[..1]) {
                self.modes[self.range(*item)].iter().for_each(|k| is_moving[*k as usize] = true);
            }
            (0..self.rank as u32).filter(|k| is_moving[*k as usize]).collect()
        };
        let lists: Vec<Vec<u32>> = parallel::map(groups, union);
        Self::listed(self.rank, lists)
    }

    /// Whether modes are listed; otherwise each item has all modes.
    pub(crate) fn are_listed(&self) -> bool {
        !self.starts.is_empty()
    }

    /// Returns the range of the numbers of an item.
    #[inline]
    pub(crate) fn range(&self, item: u32) -> Range<usize> {
        let item = item as usize;
        if self.are_listed() {
            self.starts[item]..self.starts[item + 1]
        } else {
            item * self.rank..(item + 1) * self.rank
        }
    }

    /// Returns the listed modes of an item; `None` if it has all modes.
    #[inline]
    pub(crate) fn list(&self, item: u32) -> Option<&[u32]> {
        self.are_listed().then(|| &self.modes[self.range(item)])
    }

    /// Returns the modes of an item, ascending.
    pub(crate) fn of_item(&self, item: u32) -> impl Iterator<Item = u32> + '_ {
        let list = self.list(item);
        let count = list.map_or(self.rank, <[u32]>::len);
        (0..count).map(move |i| list.map_or(i as u32, |list| list[i]))
    }
}
