//! Coarse positions of the vertices of buckets, from quantized modes. Boxes are computed from them, so that exact positions
//! are needed only for the few triangles that the narrow phase tests.

use std::ops::Range;

use glam::{Mat4, Vec4};

use super::buckets::Buckets;
use super::quantization::{CoarseMotion, Quantization};
use super::vertex_store::VertexStore;

/// Quantized rest positions and modes of the vertices of each bucket. A vertex of several buckets is stored in each of
/// them, so that a bucket is read from contiguous memory (docs/notes/2026-11-23-packets-of-buckets.md).
#[derive(Default)]
pub(crate) struct CoarseVertices {
    /// For each bucket its first group of four vertices, and the end.
    starts: Vec<u32>,
    /// `[group * (rank + 1) + mode][axis]`, see [`Quantization`]: one lane for each vertex.
    quantized: Vec<[[i16; GROUP]; 3]>,
    /// For each slot the corners of its triangle, as numbers among the vertices of its bucket.
    corners: Vec<[u8; 3]>,
}

/// Vertices side by side.
const GROUP: usize = 4;

impl CoarseVertices {
    pub(crate) fn new(quantization: &Quantization, buckets: &Buckets, vertices: &VertexStore) -> Self {
        let (mut starts, mut quantized, mut corners) = (vec![0], Vec::new(), Vec::new());
        let mut numbers = vec![0_u8; vertices.count()];
        for bucket in 0..buckets.count() as u32 {
            let own = buckets.vertices(bucket);
            own.iter().enumerate().for_each(|(i, v)| numbers[*v as usize] = i as u8);
            for packet in buckets.packets(bucket) {
                let in_slots = &buckets.corners()[buckets.slots(packet)];
                corners.extend(in_slots.iter().map(|corners| corners.map(|v| numbers[v as usize])));
            }
            for group in own.chunks(GROUP) {
                let first = quantized.len();
                for (lane, &v) in group.iter().enumerate() {
                    for (k, x) in
                        quantization.quantize(vertices.rest(v), vertices.modes(v).iter().copied()).enumerate()
                    {
                        if lane == 0 {
                            quantized.push([[0; GROUP]; 3]);
                        }
                        (0..3).for_each(|axis| quantized[first + k][axis][lane] = x[axis]);
                    }
                }
            }
            starts.push(starts[bucket as usize] + own.len().div_ceil(GROUP) as u32);
        }
        Self { starts, quantized, corners }
    }

    /// Whether nothing is stored: then queries must use exact positions.
    pub(crate) fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Memory for the coarse positions of all buckets.
    pub(crate) fn new_positions<const E: usize>(&self) -> Vec<[Vec4; E]> {
        vec![[Vec4::ZERO; E]; GROUP * self.starts.last().map_or(0, |end| *end as usize)]
    }

    /// The groups of a bucket.
    fn groups(&self, bucket: u32) -> Range<usize> {
        self.starts[bucket as usize] as usize..self.starts[bucket as usize + 1] as usize
    }

    /// Moves the vertices of a bucket.
    pub(crate) fn move_bucket<const E: usize>(
        &self,
        bucket: u32,
        motion: &CoarseMotion<E>,
        positions: &mut [[Vec4; E]],
    ) {
        let (groups, modes) = (self.groups(bucket), motion.factors.len());
        let positions = &mut positions[groups.start * GROUP..groups.end * GROUP];
        let quantized = self.quantized[groups.start * modes..groups.end * modes].chunks_exact(modes);
        let shift = motion.shift.map(|x| [0, 1, 2].map(|axis| Vec4::splat(x[axis])));
        for (group, positions) in quantized.zip(positions.as_chunks_mut::<GROUP>().0) {
            let mut sums = shift;
            for (displacement, factors) in group.iter().zip(&motion.factors) {
                for end in 0..E {
                    for axis in 0..3 {
                        sums[end][axis] += Vec4::from_array(displacement[axis].map(f32::from)) * factors[end];
                    }
                }
            }
            let columns = sums.map(|[x, y, z]| Mat4::from_cols(x, y, z, Vec4::ZERO).transpose());
            *positions = std::array::from_fn(|lane| columns.map(|columns| columns.col(lane)));
        }
    }

    /// The corners of the triangle in a slot of a bucket whose vertices have been moved, in the frame; their fourth
    /// components are unused.
    #[inline]
    pub(crate) fn corners<const E: usize>(
        &self,
        bucket: u32,
        slot: usize,
        positions: &[[Vec4; E]],
    ) -> [[Vec4; E]; 3] {
        let first = self.starts[bucket as usize] as usize * GROUP;
        let [a, b, c] = self.corners[slot];
        [positions[first + a as usize], positions[first + b as usize], positions[first + c as usize]]
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::detect::f32_frame::F32Frame;
    use crate::detect::layout::{Layout, Needs};
    use crate::detect::vertex_motion::rounding_bound;
    use crate::filter::PairFilter;
    use crate::hierarchy::Hierarchy;
    use crate::test_models::Random;
    use crate::{ContactFilter, Modes, ReducedModel, TriMesh};

    /// Also where modes have very different sizes, cancel each other, or move nothing, and far from the origin. That
    /// the bound is not wasted is asserted, too.
    #[test]
    fn coarse_positions_are_within_their_error_bound() {
        let random = &mut Random(3);
        let (mut used, mut unused, mut worst) = (0, 0, 0.0_f64);
        for case in 0..400 {
            let rank = [1, 3, 30, 200][case % 4];
            let unit = 2.0_f64.powi([0, -150, 150, 20, -1000][case % 5]);
            let far =
                if case % 7 == 0 { random.vector() * 10.0_f64.powi((case % 11) as i32) } else { DVec3::ZERO };
            let rest: Vec<DVec3> = (0..90).map(|_| (random.vector() + far) * unit).collect();
            let mut modes = Vec::new();
            for _ in 0..rest.len() {
                for k in 0..rank {
                    let size = [1.0, 1e-30, 0.0, 1e5, 1e-3][(k + case) % 5];
                    modes.push(if k % 6 == 5 {
                        *modes.last().unwrap()
                    } else {
                        random.vector() * size * unit
                    });
                }
            }
            let mut q: Vec<f64> =
                (0..rank).map(|k| random.signed() / [1.0, 1e-30, 1.0, 1e5, 1e-3][(k + case) % 5]).collect();
            q.iter_mut().for_each(|q| *q *= [1.0, 0.01, 0.0, 100.0][case / 4 % 4] / rank as f64);
            (5..rank).step_by(6).for_each(|k| q[k] = -q[k - 1]);
            let faces = (0..88).map(|i| [i, i + 1, i + 2]).collect();
            let model =
                ReducedModel::new(TriMesh::new(rest, faces).unwrap(), Modes::new(rank, modes).unwrap());
            let model = model.unwrap();
            let hierarchy = Hierarchy::build(&model, model.metric());
            let filter = PairFilter::new(&model, &ContactFilter::default());
            let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
            let later: Vec<f64> = q.iter().map(|q| q * 1.5).collect();
            let ends = [&q[..], &later[..]];
            let rounding = rounding_bound(model.check_coordinates(&later).unwrap(), rank);
            let frame = F32Frame::around(layout.bd_tree.root(ends, DVec3::splat(rounding)));
            let (mut motion, mut positions) = (CoarseMotion::default(), layout.coarse.new_positions());
            if !layout.quantization.begin(&mut motion, ends, &frame, rounding) {
                unused += 1;
                continue;
            }
            used += 1;
            let mut largest = 0.0_f64;
            for bucket in 0..layout.buckets.count() as u32 {
                layout.coarse.move_bucket(bucket, &motion, &mut positions);
                for slot in layout.buckets.packets(bucket).flat_map(|packet| layout.buckets.slots(packet)) {
                    let corners = layout.coarse.corners(bucket, slot, &positions);
                    for (v, coarse) in layout.buckets.corners()[slot].into_iter().zip(corners) {
                        for (x, coarse) in layout.vertices.position(v, ends).into_iter().zip(coarse) {
                            let off = (coarse.truncate().as_dvec3() - frame.linear(x)).abs().max_element();
                            let mapped = (coarse - frame.map(x)).truncate().abs().max_element();
                            largest = largest.max(off).max(f64::from(mapped));
                        }
                    }
                }
            }
            assert!(largest <= f64::from(motion.error), "case {case}: {largest:e} {:e}", motion.error);
            worst = worst.max(largest / f64::from(motion.error));
        }
        assert!(used > 300 && unused > 2 && worst > 0.05, "{used} {unused} {worst}");
    }
}
