//! `Aabb8`, a packet of eight AABBs side by side: one AABB is compared with all of them at once. The file also has the
//! AABB in single precision and sets of lanes.
//!
//! Two packets are compared by the instruction set that is chosen at run time. A comparison of one AABB takes less time than
//! a call by instruction set, so it uses [`Vec4`], one SSE2 or NEON register.

use glam::{Mat4, Vec4};

use crate::vectors::{InstructionSet, Kernel, Vectors};

/// AABBs in a packet.
pub(crate) use crate::vectors::LANES;

/// An AABB in the single-precision coordinates of an [`F32Frame`](crate::detect::f32_frame::F32Frame): lower and upper
/// corner; the fourth components are unused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AabbF32 {
    pub(crate) lower: Vec4,
    pub(crate) upper: Vec4,
}

impl AabbF32 {
    /// The AABB that contains no point, and overlaps no AABB with finite corners.
    pub(crate) const EMPTY: Self = Self { lower: Vec4::INFINITY, upper: Vec4::NEG_INFINITY };

    /// The AABB that contains all points.
    pub(crate) const ALL: Self = Self { lower: Vec4::MIN, upper: Vec4::MAX };

    /// Returns the AABB of a triangle by its corners at `E` configurations.
    #[inline]
    pub(crate) fn of_triangle<const E: usize>(corners: [[Vec4; E]; 3]) -> Self {
        let [a, b, c] = corners.map(|ends| {
            let first = Self { lower: ends[0], upper: ends[0] };
            let others = with_mutant!(&ends[1..], SweptTrianglesAtStart, &ends[..0]);
            others.iter().fold(first, |all, x| Self { lower: all.lower.min(*x), upper: all.upper.max(*x) })
        });
        a.union(&b).union(&c)
    }

    /// Returns an AABB that is larger by this distance on both sides of each axis, up to a rounding.
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

    /// Returns the smallest AABB that contains both.
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

    /// Sets the AABBs of the first four lanes (`half` 0) or of the last four (1).
    #[inline]
    pub(crate) fn set_half(&mut self, half: usize, [a, b, c, d]: &[AabbF32; LANES / 2]) {
        let lower = Mat4::from_cols(a.lower, b.lower, c.lower, d.lower).transpose();
        let upper = Mat4::from_cols(a.upper, b.upper, c.upper, d.upper).transpose();
        for (axis, ends) in self.lower.iter_mut().enumerate() {
            ends.as_chunks_mut().0[half] = lower.col(axis).to_array();
        }
        for (axis, ends) in self.upper.iter_mut().enumerate() {
            ends.as_chunks_mut().0[half] = upper.col(axis).to_array();
        }
    }

    /// Sets the AABB of one lane.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, b: &AabbF32) {
        for axis in 0..3 {
            self.lower[axis][lane] = b.lower[axis];
            self.upper[axis][lane] = b.upper[axis];
        }
    }

    /// Returns the lanes whose AABB overlaps a given one.
    #[inline]
    pub(crate) fn overlapping(&self, other: &AabbF32) -> Lanes {
        let (lower, upper) = (other.lower, other.upper);
        self.compare(
            [lower.x, lower.y, lower.z].map(Vec4::splat),
            [upper.x, upper.y, upper.z].map(Vec4::splat),
        )
    }

    /// Returns the lanes among the first four whose AABB overlaps a given one.
    #[inline]
    pub(crate) fn overlapping_of_four(&self, other: &AabbF32) -> Lanes {
        let (lower, upper) = (other.lower, other.upper);
        let apart = self.beyond_half(
            0,
            [lower.x, lower.y, lower.z].map(Vec4::splat),
            [upper.x, upper.y, upper.z].map(Vec4::splat),
        );
        Lanes(!apart & 0xf)
    }

    /// Returns the lanes among the first four whose AABB overlaps that of one lane of another packet.
    #[inline]
    pub(crate) fn overlapping_lane_of_four(&self, other: &Self, lane: usize) -> Lanes {
        let apart = self.beyond_half(
            0,
            [0, 1, 2].map(|axis| Vec4::splat(other.lower[axis][lane])),
            [0, 1, 2].map(|axis| Vec4::splat(other.upper[axis][lane])),
        );
        Lanes(!apart & 0xf)
    }

    #[inline(always)]
    fn compare(&self, lower: [Vec4; 3], upper: [Vec4; 3]) -> Lanes {
        let apart = self.beyond_half(0, lower, upper) | self.beyond_half(4, lower, upper) << 4;
        Lanes(!apart & 0xff)
    }

    /// Returns which of the four lanes that begin at `from` are disjoint from an AABB.
    #[inline(always)]
    fn beyond_half(&self, from: usize, lower: [Vec4; 3], upper: [Vec4; 3]) -> u32 {
        let of = |ends: &[f32; LANES]| Vec4::from_slice(&ends[from..from + 4]);
        let beyond =
            |axis: usize| of(&self.lower[axis]).cmpgt(upper[axis]) | of(&self.upper[axis]).cmplt(lower[axis]);
        (beyond(0) | beyond(1) | beyond(2)).bitmask()
    }
}

/// Two packets whose overlapping pairs of lanes are to be found.
#[derive(Clone, Copy)]
pub(crate) struct PacketPair<'p> {
    pub(crate) first: &'p Aabb8,
    pub(crate) second: &'p Aabb8,
    /// The lanes of the first packet to compare.
    pub(crate) rows: u32,
    /// The pairs to omit: bit `8 i + j` for lane i of the first and lane j of the second packet.
    pub(crate) masked: u64,
}

/// The overlapping pairs of lanes of two packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Overlaps {
    /// Bit `8 i + j` for lane i of the first and lane j of the second packet.
    pub(crate) pairs: u64,
    /// The number of lanes of the first packet that were compared.
    pub(crate) rows: u32,
}

impl PacketPair<'_> {
    /// Returns the pairs of lanes whose AABBs overlap. Lanes of the first packet whose pairs are all omitted are not compared.
    #[inline]
    pub(crate) fn overlaps(self, instructions: InstructionSet) -> Overlaps {
        instructions.run(self)
    }

    /// Returns the same pairs if all lanes of each packet are within one lane of an outer packet. Only lanes that overlap the
    /// outer lane of the other packet are compared. `rows` is not used.
    #[inline]
    pub(crate) fn overlaps_within(
        self,
        instructions: InstructionSet,
        outer: [(&Aabb8, usize); 2],
    ) -> Overlaps {
        instructions.run(NestedPacketPair { pair: self, outer })
    }
}

impl Kernel for PacketPair<'_> {
    type Output = Overlaps;

    #[inline(always)]
    fn run<V: Vectors>(self, v: V) -> Overlaps {
        let mut overlaps = Overlaps::default();
        for row in Lanes(self.rows) {
            let open = !(self.masked >> (LANES as u32 * row)) as u32 & 0xff;
            if open == 0 {
                continue;
            }
            overlaps.rows += 1;
            let lanes = self.second.compare_all(v, self.first, row as usize) & open;
            overlaps.pairs |= u64::from(lanes) << (LANES as u32 * row);
        }
        overlaps
    }
}

/// Two packets, and for each the outer packet and the lane whose AABB contains all of its AABBs.
struct NestedPacketPair<'p> {
    pair: PacketPair<'p>,
    outer: [(&'p Aabb8, usize); 2],
}

impl Kernel for NestedPacketPair<'_> {
    type Output = Overlaps;

    #[inline(always)]
    fn run<V: Vectors>(self, v: V) -> Overlaps {
        let Self { mut pair, outer: [first, second] } = self;
        pair.rows = pair.first.compare_all(v, second.0, second.1);
        if pair.rows == 0 {
            return Overlaps::default();
        }
        let columns = pair.second.compare_all(v, first.0, first.1);
        let clear = with_mutant!(!columns & 0xff, PacketColumnsSwapped, columns & 0xff);
        pair.masked |= u64::from(clear) * 0x0101_0101_0101_0101;
        pair.run(v)
    }
}

impl Aabb8 {
    /// Returns the lanes whose AABB overlaps that of one lane of another packet.
    #[inline(always)]
    fn compare_all<V: Vectors>(&self, v: V, other: &Self, lane: usize) -> u32 {
        let x = self.beyond(v, other, lane, 0);
        let y = self.beyond(v, other, lane, 1);
        let z = self.beyond(v, other, lane, 2);
        !v.bits(v.or(v.or(x, y), z)) & 0xff
    }

    /// Returns the lanes that are disjoint from a lane of another packet along an axis.
    #[inline(always)]
    fn beyond<V: Vectors>(&self, v: V, other: &Self, lane: usize, axis: usize) -> V::Mask {
        let (lower, upper) = (v.splat(other.lower[axis][lane]), v.splat(other.upper[axis][lane]));
        v.or(v.greater(v.load(&self.lower[axis]), upper), v.greater(lower, v.load(&self.upper[axis])))
    }
}

/// A set of lanes: bit i for lane i. Its iterator returns the numbers of its lanes, ascending.
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

/// A set of pairs of lanes: bit `8 i + j` for the pair `(i, j)`. Its iterator returns its pairs, ascending.
#[derive(Clone, Copy)]
pub(crate) struct PairsOfLanes(pub(crate) u64);

impl Iterator for PairsOfLanes {
    type Item = (usize, usize);

    #[inline]
    fn next(&mut self) -> Option<(usize, usize)> {
        let bit = (self.0 != 0).then(|| self.0.trailing_zeros() as usize)?;
        self.0 &= self.0 - 1;
        Some((bit / LANES, bit % LANES))
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
            let mut in_halves = Aabb8::EMPTY;
            in_halves.set_half(0, &[boxes[0], boxes[1], boxes[2], boxes[3]]);
            in_halves.set_half(1, &[boxes[4], AabbF32::EMPTY, AabbF32::EMPTY, AabbF32::EMPTY]);
            assert_eq!(in_halves, packet);
            let other = one();
            let mut expected = 0;
            for (lane, b) in boxes.iter().enumerate() {
                let meet =
                    |axis: usize| b.lower[axis] <= other.upper[axis] && other.lower[axis] <= b.upper[axis];
                expected |= u32::from((0..3).all(meet)) << lane;
            }
            assert_eq!(packet.overlapping(&other), Lanes(expected));
            for (lane, b) in boxes.iter().enumerate() {
                let of_four = Lanes(packet.overlapping(b).0 & 0xf);
                assert_eq!(packet.overlapping_of_four(b), of_four);
                assert_eq!(packet.overlapping_lane_of_four(&packet, lane), of_four);
            }
            compare_pairs(&packet, &boxes, &other, u64::from(expected).wrapping_mul(0x9e37_79b9_7f4a_7c15));
            assert_eq!(Lanes(expected).map(|lane| 1 << lane).sum::<u32>(), expected);
            overlaps += expected.count_ones();
        }
        assert!((1000..9000).contains(&overlaps), "{overlaps}");
        assert_eq!(Aabb8::EMPTY.overlapping(&AabbF32::ALL), Lanes(0));
    }

    /// Checks that both instruction sets find the overlapping pairs of two packets.
    fn compare_pairs(packet: &Aabb8, boxes: &[AabbF32], other: &AabbF32, masked: u64) {
        let mut second = Aabb8::EMPTY;
        boxes.iter().rev().enumerate().for_each(|(lane, b)| {
            second.set(lane + 3, &AabbF32 { lower: b.lower.min(other.lower), upper: b.upper });
        });
        let rows = masked as u32 >> 3 & 0xff;
        let pair = PacketPair { first: packet, second: &second, rows, masked };
        let (mut expected, mut within) = (Overlaps::default(), Overlaps::default());
        let mut whole = Aabb8::EMPTY;
        [packet, &second].into_iter().zip(0..).for_each(|(one, lane)| {
            let union = |ends: [f32; LANES], of: fn(f32, f32) -> f32| ends.into_iter().reduce(of).unwrap();
            for axis in 0..3 {
                whole.lower[axis][lane] = union(one.lower[axis], f32::min);
                whole.upper[axis][lane] = union(one.upper[axis], f32::max);
            }
        });
        for row in 0..LANES {
            let open = !(masked >> (8 * row)) as u32 & 0xff;
            let one = |ends: &[[f32; LANES]; 3]| Vec4::new(ends[0][row], ends[1][row], ends[2][row], 0.0);
            let other = AabbF32 { lower: one(&packet.lower), upper: one(&packet.upper) };
            let lanes = second.overlapping(&other).0 & open;
            if rows >> row & 1 != 0 && open != 0 {
                expected.rows += 1;
                expected.pairs |= u64::from(lanes) << (8 * row);
            }
            within.pairs |= u64::from(lanes) << (8 * row);
        }
        for instructions in [InstructionSet::default(), InstructionSet::Baseline] {
            assert_eq!(pair.overlaps(instructions), expected);
            let found = pair.overlaps_within(instructions, [(&whole, 0), (&whole, 1)]);
            assert_eq!(found.pairs, within.pairs);
            assert!(found.rows <= LANES as u32);
        }
    }
}
