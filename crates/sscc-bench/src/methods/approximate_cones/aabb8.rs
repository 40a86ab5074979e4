//! Packets of eight AABBs in single precision, all compared with one AABB at once.

use glam::{DVec3, Vec4};

/// Number of AABBs in an [`Aabb8`].
pub const LANES: usize = 8;

/// An AABB in the coordinates of a [`Frame`]. The fourth components have no meaning.
#[derive(Clone, Copy)]
pub struct Aabb {
    lower: Vec4,
    upper: Vec4,
}

/// A map of coordinates to single precision: a shift, a scale and a conversion, each monotone. If two mapped AABBs are
/// disjoint, the exact AABBs are disjoint.
pub struct Frame {
    center: DVec3,
    scale: f64,
}

/// Eight AABBs: for each axis the lower ends of all, and the upper ends of all.
#[derive(Clone)]
pub struct Aabb8 {
    lower: [[Vec4; 2]; 3],
    upper: [[Vec4; 2]; 3],
}

/// Lanes of an [`Aabb8`], ascending.
#[derive(Clone, Copy)]
pub struct Lanes(u32);

impl Frame {
    /// Returns the frame that maps the AABB of some points to about [-1, 1] along its longest side.
    pub fn around(points: &[DVec3]) -> Self {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lower, upper) = points.iter().fold(empty, |(lower, upper), p| (lower.min(*p), upper.max(*p)));
        let half = (upper * 0.5 - lower * 0.5).max_element();
        Self { center: lower * 0.5 + upper * 0.5, scale: (1.0 / half).clamp(0.0, f64::MAX) }
    }

    /// Maps a point. All coordinates are finite; the fourth one has no meaning.
    #[inline]
    pub fn map(&self, x: DVec3) -> Vec4 {
        ((x - self.center) * self.scale).as_vec3().extend(0.0).clamp(Vec4::MIN, Vec4::MAX)
    }
}

impl Aabb {
    /// The empty AABB.
    pub const EMPTY: Self = Self { lower: Vec4::INFINITY, upper: Vec4::NEG_INFINITY };

    /// Returns the AABB of mapped points.
    #[inline]
    pub fn around([a, b, c]: [Vec4; 3]) -> Self {
        Self { lower: a.min(b).min(c), upper: a.max(b).max(c) }
    }

    /// Returns the smallest AABB that contains both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }
}

impl Aabb8 {
    /// Eight empty AABBs.
    pub const EMPTY: Self = Self { lower: [[Vec4::INFINITY; 2]; 3], upper: [[Vec4::NEG_INFINITY; 2]; 3] };

    /// Sets the AABB of a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, aabb: &Aabb) {
        for axis in 0..3 {
            self.lower[axis][lane / 4][lane % 4] = aabb.lower[axis];
            self.upper[axis][lane / 4][lane % 4] = aabb.upper[axis];
        }
    }

    /// Returns the lanes that overlap an AABB.
    #[inline]
    pub fn overlapping(&self, other: &Aabb) -> Lanes {
        let ends = |x: Vec4| [x.x, x.y, x.z];
        self.compare(ends(other.lower), ends(other.upper))
    }

    /// Returns the lanes that overlap a lane of another packet.
    #[inline]
    pub fn overlapping_lane(&self, other: &Self, lane: usize) -> Lanes {
        let at = |ends: &[[Vec4; 2]; 3]| std::array::from_fn(|axis| ends[axis][lane / 4][lane % 4]);
        self.compare(at(&other.lower), at(&other.upper))
    }

    #[inline]
    fn compare(&self, lower: [f32; 3], upper: [f32; 3]) -> Lanes {
        let half = |half: usize| {
            let axis = |axis: usize| {
                self.lower[axis][half].cmple(Vec4::splat(upper[axis]))
                    & self.upper[axis][half].cmpge(Vec4::splat(lower[axis]))
            };
            (axis(0) & axis(1) & axis(2)).bitmask()
        };
        Lanes(half(0) | half(1) << 4)
    }
}

impl Lanes {
    /// Returns the lanes after a lane.
    #[inline]
    pub fn beyond(self, lane: usize) -> Self {
        Self(self.0 & !0 << (lane + 1))
    }

    /// Returns the lanes in both sets.
    #[inline]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Iterator for Lanes {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros();
        self.0 &= self.0.wrapping_sub(1);
        (lane < u32::BITS).then_some(lane as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_those_that_overlap() {
        let aabb = |lower: [f32; 3], upper: [f32; 3]| Aabb {
            lower: Vec4::from_array([lower[0], lower[1], lower[2], 0.0]),
            upper: Vec4::from_array([upper[0], upper[1], upper[2], 0.0]),
        };
        let cube = |x: f32| aabb([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
        let mut packet = Aabb8::EMPTY;
        (0..6).for_each(|lane| packet.set(lane, &cube(lane as f32)));
        // Touching counts, and empty lanes overlap nothing.
        assert_eq!(packet.overlapping(&cube(2.0)).collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(packet.overlapping_lane(&packet, 5).collect::<Vec<_>>(), [4, 5]);
        let above = aabb([0.0, 1.5, 0.0], [9.0, 2.0, 1.0]);
        assert_eq!(packet.overlapping(&above).count(), 0);
        let all = packet.overlapping(&cube(0.0).union(&cube(5.0)));
        assert_eq!((all.count(), all.beyond(3).collect::<Vec<_>>()), (6, vec![4, 5]));
        assert_eq!(all.and(packet.overlapping(&cube(0.0))).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(all.beyond(7).count(), 0);
    }

    #[test]
    fn mapped_coordinates_keep_their_order() {
        for (from, to) in [(0.0, 1.0), (1e8, 1e8 + 1e-6), (-1e-300, 1e-300), (3.0, 3.0)] {
            let frame = Frame::around(&[DVec3::splat(from), DVec3::splat(to)]);
            let at: Vec<f32> = (-40..60)
                .map(|i| frame.map(DVec3::splat(from + (to - from) * f64::from(i) / 20.0)).x)
                .collect();
            assert!(at.windows(2).all(|pair| pair[0] <= pair[1]), "{at:?}");
            assert!(at.iter().all(|x| x.is_finite()));
        }
    }
}
