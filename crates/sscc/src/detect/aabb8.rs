//! `Aabb8`, a packet of eight AABBs side by side: one AABB is compared with all of them at once. Also the AABB and the
//! set of lanes that go with it.
//!
//! [`Vec4`] is one SSE2 or NEON register. Every x86-64 and AArch64 processor has those, so no instruction set is chosen
//! at run time.

use glam::Vec4;

/// AABBs in a packet.
pub(crate) const LANES: usize = 8;

/// An AABB in the single-precision coordinates of an [`F32Frame`](crate::detect::f32_frame::F32Frame): lower and upper
/// corner; the fourth components mean nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AabbF32 {
    pub(crate) lower: Vec4,
    pub(crate) upper: Vec4,
}

impl AabbF32 {
    /// Contains nothing, and overlaps no AABB with finite corners.
    pub(crate) const EMPTY: Self = Self { lower: Vec4::INFINITY, upper: Vec4::NEG_INFINITY };

    /// Contains everything.
    pub(crate) const ALL: Self = Self { lower: Vec4::MIN, upper: Vec4::MAX };

    /// The AABB of a triangle whose corners are at `E` ends of a motion.
    #[inline]
    pub(crate) fn of_triangle<const E: usize>(corners: [[Vec4; E]; 3]) -> Self {
        let [a, b, c] = corners.map(|ends| {
            let first = Self { lower: ends[0], upper: ends[0] };
            let others = right_or!(&ends[1..], SweptTrianglesAtStart, &ends[..0]);
            others.iter().fold(first, |all, x| Self { lower: all.lower.min(*x), upper: all.upper.max(*x) })
        });
        a.union(&b).union(&c)
    }

    /// An AABB larger by this much on both sides of each axis, up to a rounding.
    #[inline]
    pub(crate) fn widened(&self, by: Vec4) -> Self {
        Self { lower: self.lower - by, upper: self.upper + by }
    }

    /// Whether the AABBs have a point in common.
    #[inline]
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let apart = self.lower.cmpgt(other.upper) | other.lower.cmpgt(self.upper);
        apart.bitmask() & 0b111 == 0
    }

    /// The smallest AABB that contains both.
    #[inline]
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }
}

/// Up to eight AABBs: for each axis the lower and the upper ends of all lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Aabb8 {
    lower: [[f32; LANES]; 3],
    upper: [[f32; LANES]; 3],
}

impl Aabb8 {
    /// A packet of empty AABBs.
    pub(crate) const EMPTY: Self =
        Self { lower: [[f32::INFINITY; LANES]; 3], upper: [[f32::NEG_INFINITY; LANES]; 3] };

    /// Sets the AABB of one lane.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, b: &AabbF32) {
        for axis in 0..3 {
            self.lower[axis][lane] = b.lower[axis];
            self.upper[axis][lane] = b.upper[axis];
        }
    }

    /// The lanes whose AABB overlaps a given one.
    #[inline]
    pub(crate) fn overlapping(&self, other: &AabbF32) -> Lanes {
        let (lower, upper) = (other.lower, other.upper);
        self.compare(
            [lower.x, lower.y, lower.z].map(Vec4::splat),
            [upper.x, upper.y, upper.z].map(Vec4::splat),
        )
    }

    /// The lanes whose AABB overlaps that of one lane of another packet.
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

/// A set of lanes: bit i for lane i. As an iterator, the numbers of its lanes, ascending.
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
                AabbF32::of_triangle([[a], [b], [b]])
            };
            let boxes: [AabbF32; 5] = std::array::from_fn(|_| one());
            let mut packet = Aabb8::EMPTY;
            boxes.iter().enumerate().for_each(|(lane, b)| packet.set(lane, b));
            let other = one();
            let mut expected = 0;
            for (lane, b) in boxes.iter().enumerate() {
                let meet =
                    |axis: usize| b.lower[axis] <= other.upper[axis] && other.lower[axis] <= b.upper[axis];
                expected |= u32::from((0..3).all(meet)) << lane;
            }
            assert_eq!(packet.overlapping(&other), Lanes(expected));
            for (lane, b) in boxes.iter().enumerate() {
                assert_eq!(packet.overlapping_lane(&packet, lane), packet.overlapping(b));
            }
            assert_eq!(Lanes(expected).map(|lane| 1 << lane).sum::<u32>(), expected);
            overlaps += expected.count_ones();
        }
        assert!((1000..9000).contains(&overlaps), "{overlaps}");
        assert_eq!(Aabb8::EMPTY.overlapping(&AabbF32::ALL), Lanes(0));
    }
}
