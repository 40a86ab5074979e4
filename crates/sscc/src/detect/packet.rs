//! Eight boxes side by side, so that one box is compared with all of them at once.
//!
//! [`Vec4`] is one SSE2 (or NEON) register, which every 64-bit processor of the kind has: nothing has to be chosen at
//! run time.

use glam::Vec4;

/// Boxes in a pack.
pub(crate) const LANES: usize = 8;

/// A box in the single-precision coordinates of a [`Frame`](crate::detect::frame::Frame): lower and upper corner; the fourth
/// components mean nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Box32 {
    pub(crate) lower: Vec4,
    pub(crate) upper: Vec4,
}

impl Box32 {
    /// Contains nothing, and overlaps no box with finite corners.
    pub(crate) const EMPTY: Self = Self { lower: Vec4::INFINITY, upper: Vec4::NEG_INFINITY };

    /// Contains everything.
    pub(crate) const ALL: Self = Self { lower: Vec4::MIN, upper: Vec4::MAX };

    /// The box of three points, around all the places where each is.
    #[inline]
    pub(crate) fn around<const E: usize>(corners: [[Vec4; E]; 3]) -> Self {
        let [a, b, c] = corners.map(|ends| {
            let first = Self { lower: ends[0], upper: ends[0] };
            let others = right_or!(&ends[1..], SweptTrianglesAtOneEnd, &ends[..0]);
            others.iter().fold(first, |all, x| Self { lower: all.lower.min(*x), upper: all.upper.max(*x) })
        });
        a.union(&b).union(&c)
    }

    /// A box larger by this much on both sides of each axis, up to a rounding.
    #[inline]
    pub(crate) fn widened(&self, by: Vec4) -> Self {
        Self { lower: self.lower - by, upper: self.upper + by }
    }

    /// Whether the boxes have a point in common.
    #[inline]
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let apart = self.lower.cmpgt(other.upper) | other.lower.cmpgt(self.upper);
        apart.bitmask() & 0b111 == 0
    }

    /// The least box that contains both.
    #[inline]
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }
}

/// Up to eight boxes: for each axis the lower and the upper ends of all.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Pack {
    lower: [[f32; LANES]; 3],
    upper: [[f32; LANES]; 3],
}

impl Pack {
    /// Eight empty boxes.
    pub(crate) const EMPTY: Self =
        Self { lower: [[f32::INFINITY; LANES]; 3], upper: [[f32::NEG_INFINITY; LANES]; 3] };

    /// Puts a box in one of the lanes.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, b: &Box32) {
        for axis in 0..3 {
            self.lower[axis][lane] = b.lower[axis];
            self.upper[axis][lane] = b.upper[axis];
        }
    }

    /// Which of the eight overlap a box: bit i for lane i.
    #[inline]
    pub(crate) fn overlapping(&self, other: &Box32) -> Lanes {
        let (lower, upper) = (other.lower, other.upper);
        self.compare(
            [lower.x, lower.y, lower.z].map(Vec4::splat),
            [upper.x, upper.y, upper.z].map(Vec4::splat),
        )
    }

    /// Which of the eight overlap one of another pack.
    #[inline]
    pub(crate) fn overlapping_lane(&self, other: &Self, lane: usize) -> Lanes {
        self.compare(
            [0, 1, 2].map(|axis| Vec4::splat(other.lower[axis][lane])),
            [0, 1, 2].map(|axis| Vec4::splat(other.upper[axis][lane])),
        )
    }

    #[inline(always)]
    fn compare(&self, lower: [Vec4; 3], upper: [Vec4; 3]) -> Lanes {
        let half = |from: usize| {
            let of = |ends: &[f32; LANES]| Vec4::from_slice(&ends[from..from + 4]);
            let beyond = |axis: usize| {
                of(&self.lower[axis]).cmpgt(upper[axis]) | of(&self.upper[axis]).cmplt(lower[axis])
            };
            (beyond(0) | beyond(1) | beyond(2)).bitmask()
        };
        Lanes(!(half(0) | half(4) << 4) & 0xff)
    }
}

/// One bit for each lane of a pack; as an iterator, the numbers of those that are set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lanes(pub(crate) u32);

impl Iterator for Lanes {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros());
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_compared_one_by_one() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 61) as f32
        };
        let mut overlaps = 0;
        for _ in 0..2000 {
            let mut one = || {
                let [a, b] = [(); 2].map(|()| Vec4::new(random(), random(), random(), random()));
                Box32::around([[a], [b], [b]])
            };
            let boxes: [Box32; 5] = std::array::from_fn(|_| one());
            let mut pack = Pack::EMPTY;
            boxes.iter().enumerate().for_each(|(lane, b)| pack.set(lane, b));
            let other = one();
            let mut expected = 0;
            for (lane, b) in boxes.iter().enumerate() {
                let meet =
                    |axis: usize| b.lower[axis] <= other.upper[axis] && other.lower[axis] <= b.upper[axis];
                expected |= u32::from((0..3).all(meet)) << lane;
            }
            assert_eq!(pack.overlapping(&other), Lanes(expected));
            for (lane, b) in boxes.iter().enumerate() {
                assert_eq!(pack.overlapping_lane(&pack, lane), pack.overlapping(b));
            }
            assert_eq!(Lanes(expected).map(|lane| 1 << lane).sum::<u32>(), expected);
            overlaps += expected.count_ones();
        }
        assert!((1000..9000).contains(&overlaps), "{overlaps}");
        assert_eq!(Pack::EMPTY.overlapping(&Box32::ALL), Lanes(0));
    }
}
