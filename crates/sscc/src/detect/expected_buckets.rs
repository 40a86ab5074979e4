//! Buckets that are moved before several searches begin, for all of them at once.
//!
//! Far from rest, searches of a batch open nearly the same buckets. Those that most searches of the last group opened are
//! moved for the next group, so that modes are read and converted once for all of its configurations. Each search then
//! finds coarse positions that it would have computed itself, with the same bits. So answers and statistics depend neither on
//! groups nor on which buckets were expected (docs/notes/2026-11-25-explicit-vectors.md).

use glam::{DVec3, Vec4};

use super::f32_frame::F32Frame;
use super::frame_map::FrameMap;
use super::layout::Layout;
use super::quantization::CoarseMotion;
use super::vertex_motion::{InWorld, VertexMotion};

/// Searches in a group at most: as many as their sums fit in the registers of AVX2.
pub(crate) const GROUP: usize = 4;

/// The coarse positions of one search.
#[derive(Clone, Default)]
pub(crate) struct CoarsePositions<const E: usize> {
    /// See [`CoarseVertices::new_positions`](super::coarse_vertices::CoarseVertices::new_positions).
    pub(crate) positions: Vec<[Vec4; E]>,
    /// For each bucket whether it has been moved ahead of the search; empty for none.
    pub(crate) moved: Vec<bool>,
}

/// The buckets moved ahead for a group of searches.
pub(crate) struct ExpectedBuckets<const E: usize> {
    motions: Vec<CoarseMotion<E>>,
    positions: Vec<CoarsePositions<E>>,
    /// The buckets that the next group is expected to open.
    expected: Vec<u32>,
    /// For each bucket how many searches of this group have opened it.
    opened: Vec<u8>,
}

impl<const E: usize> ExpectedBuckets<E> {
    pub(crate) fn new(layout: &Layout) -> Self {
        let positions = CoarsePositions { positions: layout.coarse.new_positions(), moved: Vec::new() };
        Self {
            motions: vec![CoarseMotion::default(); GROUP],
            positions: vec![positions; GROUP],
            expected: Vec::new(),
            opened: vec![0; layout.buckets.count()],
        }
    }

    /// Starts a group of at most [`GROUP`] searches: moves the buckets that they are expected to open.
    pub(crate) fn begin<M: VertexMotion<E>>(&mut self, layout: &Layout, searches: &[M]) {
        let begins = |(coarse, motion): (&mut CoarseMotion<E>, &M)| {
            begin_coarse(layout, motion, &F32Frame::around(motion.overall_aabb(layout)), coarse)
        };
        let is_coarse = self.motions.iter_mut().zip(searches).fold(true, |all, both| all & begins(both));
        if right_or!(true, MovedBucketsKept, false) {
            self.positions.iter_mut().for_each(|positions| positions.moved.clear());
        }
        // A search alone gains nothing.
        if !is_coarse || self.expected.is_empty() || searches.len() < 2 {
            return;
        }
        for positions in &mut self.positions[..searches.len()] {
            positions.moved.resize(self.opened.len(), false);
            self.expected.iter().for_each(|bucket| positions.moved[*bucket as usize] = true);
        }
        let [p, q, r, s] = &self.motions[..] else { return };
        for &bucket in right_or!(&self.expected[..], BucketsOfLastGroup, &[]) {
            let coarse = &layout.coarse;
            match &mut self.positions[..searches.len()] {
                [a, b] => coarse.move_bucket_at(bucket, [(p, &mut a.positions), (q, &mut b.positions)]),
                [a, b, c] => coarse.move_bucket_at(
                    bucket,
                    [(p, &mut a.positions), (q, &mut b.positions), (r, &mut c.positions)],
                ),
                [a, b, c, d] => coarse.move_bucket_at(
                    bucket,
                    [
                        (p, &mut a.positions),
                        (q, &mut b.positions),
                        (r, &mut c.positions),
                        (s, &mut d.positions),
                    ],
                ),
                _ => {}
            }
        }
    }

    /// The positions of a search of the group. Exchange them with those of the search before it begins, and again after it.
    pub(crate) fn of_search(&mut self, search: usize) -> &mut CoarsePositions<E> {
        &mut self.positions[search]
    }

    /// Counts the buckets that a search has opened.
    pub(crate) fn count(&mut self, is_open: impl Fn(u32) -> bool) {
        self.opened.iter_mut().zip(0..).for_each(|(opened, bucket)| *opened += u8::from(is_open(bucket)));
    }

    /// Ends a group of so many searches: the next one is expected to open the buckets that at least three quarters of them
    /// have opened.
    pub(crate) fn end(&mut self, searches: usize) {
        self.expected.clear();
        let is_expected = |opened: u8| 4 * usize::from(opened) >= 3 * searches;
        let expected = self.opened.iter().zip(0..).filter(|(opened, _)| is_expected(**opened));
        self.expected.extend(expected.map(|(_, bucket)| bucket));
        self.opened.fill(0);
    }
}

/// Sets the coarse motion of a search. False if it must use exact positions.
pub(crate) fn begin_coarse<const E: usize, M: VertexMotion<E>>(
    layout: &Layout,
    motion: &M,
    frame: &F32Frame,
    coarse: &mut CoarseMotion<E>,
) -> bool {
    coarse.maps = None;
    let Some(q) = motion.coarse_coordinates().filter(|_| !layout.coarse.is_empty()) else { return false };
    let Some(InWorld { maps, own_rounding }) = motion.in_world() else {
        return layout.quantization.begin(coarse, q, frame, motion.rounding());
    };
    let own = F32Frame::around(layout.bd_tree.root(q, DVec3::splat(own_rounding)));
    if !layout.quantization.begin(coarse, q, &own, own_rounding) {
        return false;
    }
    let maps = maps.map(|map| FrameMap::new([&own, frame], map, coarse.error, motion.rounding()));
    if maps.iter().all(Option::is_some) {
        coarse.maps = Some(maps.map(Option::unwrap_or_default));
    }
    coarse.maps.is_some()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::detect::layout::Needs;
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::filter::PairFilter;
    use crate::hierarchy::Hierarchy;
    use crate::{ContactFilter, Modes, ReducedModel, Scope, TriMesh};

    /// A group has the buckets that were expected for it, and no others of an earlier group.
    #[test]
    fn only_expected_buckets_are_moved_ahead() {
        let positions: Vec<DVec3> =
            (0..602).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
        let faces = (0..600).map(|i| [i, i + 1, i + 2]).collect();
        let modes = Modes::new(1, vec![DVec3::Z; positions.len()]).unwrap();
        let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap();
        let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
        let q = [0.01];
        let reach = model.check_coordinates(&q).unwrap();
        let searches = [(); 2].map(|()| DeformedMotion::new([&q[..]], reach));
        let mut ahead = ExpectedBuckets::<1>::new(&layout);
        let count = layout.buckets.count() as u32;
        assert!(count > 2);
        for round in 0..5 {
            let is_opened = |bucket: u32| bucket == round % count;
            ahead.begin(&layout, &searches);
            for i in 0..2 {
                let moved = &ahead.of_search(i).moved;
                let expected = |bucket: u32| round > 0 && bucket == (round - 1) % count;
                let is_right = moved.iter().zip(0..).all(|(moved, bucket)| *moved == expected(bucket));
                assert!(is_right && moved.is_empty() == (round == 0), "{round}: {moved:?}");
                ahead.count(is_opened);
            }
            ahead.end(2);
        }
    }
}
