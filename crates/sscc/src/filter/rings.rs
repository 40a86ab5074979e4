//! Rings of a mesh: how far apart two triangles are on the surface.

use super::pair_filter::PairFilter;
use crate::Error;

/// Finds the triangles that lie within a number of rings of a triangle. Triangles with a common vertex are one ring
/// apart, those with a common neighbour of this kind are two rings apart, and so on; welded vertices count as one.
#[derive(Clone)]
pub(crate) struct Rings {
    rings: u32,
    /// For each vertex class its first entry in `triangles`, and the end.
    starts: Vec<u32>,
    triangles: Vec<u32>,
    /// The triangle whose rings are marked.
    center: Option<u32>,
    /// The marked triangles: the centre first, then ring by ring.
    marked: Vec<u32>,
    /// For each triangle the number of the last search that reached it.
    reached: Vec<u32>,
    /// For each vertex class the number of the last search that reached it.
    reached_classes: Vec<u32>,
    /// The number of the last search.
    search: u32,
}

impl Rings {
    pub(crate) fn new(filter: &PairFilter, rings: u32) -> Self {
        let faces = filter.faces().len() as u32;
        let mut starts = vec![0_u32; filter.class_count() + 1];
        let all = || (0..faces).flat_map(|t| filter.vertex_classes(t).map(|class| (class as usize, t)));
        all().for_each(|(class, _)| starts[class + 1] += 1);
        for class in 1..starts.len() {
            starts[class] += starts[class - 1];
        }
        let (mut next, mut triangles) = (starts.clone(), vec![0; 3 * faces as usize]);
        for (class, t) in all() {
            triangles[next[class] as usize] = t;
            next[class] += 1;
        }
        let reached_classes = vec![0; starts.len()];
        Self {
            rings,
            starts,
            triangles,
            center: None,
            marked: Vec::new(),
            reached: vec![0; faces as usize],
            reached_classes,
            search: 0,
        }
    }

    /// Whether two triangles are at most that many rings apart. A call with the same `a` as the last one is fast.
    pub(crate) fn contain(&mut self, filter: &PairFilter, a: u32, b: u32) -> bool {
        if self.center != Some(a) {
            self.mark(filter, a);
        }
        self.reached[b as usize] == self.search
    }

    /// Returns the triangles within the rings around one: itself first, then ring by ring.
    pub(super) fn around(&mut self, filter: &PairFilter, center: u32) -> &[u32] {
        if self.center != Some(center) {
            self.mark(filter, center);
        }
        &self.marked
    }

    /// Marks the triangles within the rings around one.
    fn mark(&mut self, filter: &PairFilter, center: u32) {
        if self.search == u32::MAX {
            self.reached.fill(0);
            self.reached_classes.fill(0);
            self.search = 0;
        }
        self.search += 1;
        self.center = Some(center);
        self.reached[center as usize] = self.search;
        self.marked.clear();
        self.marked.push(center);
        let mut ring = 0..1;
        for _ in 0..with_mutant!(self.rings, RingsOneMore, self.rings + 1) {
            for i in ring.clone() {
                for class in filter.vertex_classes(self.marked[i]).map(|class| class as usize) {
                    if std::mem::replace(&mut self.reached_classes[class], self.search) == self.search {
                        continue;
                    }
                    for &t in &self.triangles[self.starts[class] as usize..self.starts[class + 1] as usize] {
                        if std::mem::replace(&mut self.reached[t as usize], self.search) != self.search {
                            self.marked.push(t);
                        }
                    }
                }
            }
            ring = ring.end..self.marked.len();
            if ring.is_empty() {
                return;
            }
        }
    }
}

/// The pairs of triangles within a number of rings of each other, for many threads to look up.
pub(crate) struct RingPairs {
    /// For each triangle the start of its entries in `later`, and the end; empty for [`RingPairs::NONE`].
    starts: Vec<usize>,
    /// The triangles of higher numbers within its rings, ascending.
    later: Vec<u32>,
}

/// Maximum number of listed pairs of a mesh; these take 256 MiB.
const MAX_LISTED: usize = 1 << 26;

impl RingPairs {
    /// No pairs.
    pub(crate) const NONE: Self = Self { starts: Vec::new(), later: Vec::new() };

    /// Creates the pairs of a mesh.
    ///
    /// # Errors
    /// If there are more than 2^26 pairs.
    pub(crate) fn new(filter: &PairFilter, rings: u32) -> Result<Self, Error> {
        let mut search = Rings::new(filter, rings);
        let (mut starts, mut later) = (vec![0], Vec::new());
        for a in 0..filter.faces().len() as u32 {
            later.extend(search.around(filter, a).iter().filter(|b| **b > a));
            if later.len() > MAX_LISTED {
                return Err(Error::TooManyRings { most: MAX_LISTED, rings });
            }
            let start = starts[a as usize];
            later[start..].sort_unstable();
            starts.push(later.len());
        }
        Ok(Self { starts, later })
    }

    /// Whether two triangles are within the rings of each other.
    pub(crate) fn contain(&self, a: u32, b: u32) -> bool {
        let (first, second) = (a.min(b), a.max(b));
        if self.starts.is_empty() {
            return false;
        }
        let [start, end] = [0, 1].map(|next| self.starts[first as usize + next]);
        with_mutant!(self.later[start..end].binary_search(&second).is_ok(), RingsOfClearanceForgotten, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ContactFilter;

    #[test]
    fn pairs_are_within_as_many_rings_as_steps_lead_over() {
        // A strip, and a triangle for itself. Of the strip two triangles share a vertex if their numbers differ by at most 2.
        let mut faces: Vec<[u32; 3]> = (0..10).map(|i| [i, i + 1, i + 2]).collect();
        faces.push([20, 21, 22]);
        let filter = PairFilter::with_classes(&faces, None, &ContactFilter::default());
        for rings in 1..4 {
            let pairs = RingPairs::new(&filter, rings).unwrap();
            for (a, b) in (0..11).flat_map(|a| (0..11).map(move |b| (a, b))).filter(|(a, b)| a != b) {
                let expected = a.max(b) < 10 && u32::abs_diff(a, b) <= 2 * rings;
                assert_eq!(pairs.contain(a, b), expected, "{a} {b}, {rings} rings");
            }
        }
    }
}
