//! Coarse positions of the vertices of buckets, from quantized modes. Boxes are computed from them, so that exact positions
//! are needed only for the few triangles that the narrow phase tests.

use std::ops::Range;

use glam::Vec4;

use super::buckets::Buckets;
use super::quantization::{CoarseMotion, Quantization};
use super::vertex_store::VertexStore;
use crate::vectors::{InstructionSet, Kernel, LANES, Vectors};

/// Quantized rest positions and modes of the vertices of each bucket. A vertex of several buckets is stored in each of
/// them, so that a bucket is read from contiguous memory (docs/notes/broad-phase.md#packets).
#[derive(Default)]
pub(crate) struct CoarseVertices {
    /// For each bucket its first group of eight vertices, then the end.
    starts: Vec<u32>,
    /// `[group * (rank + 1) + mode][axis]`, see [`Quantization`]: one lane for each vertex.
    quantized: Vec<[[i16; LANES]; 3]>,
    /// For each slot the corners of its triangle, as numbers among the vertices of its bucket.
    corners: Vec<[u8; 3]>,
    instructions: InstructionSet,
}

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
            for group in own.chunks(LANES) {
                let first = quantized.len();
                for (lane, &v) in group.iter().enumerate() {
                    for (k, x) in
                        quantization.quantize(vertices.rest(v), vertices.modes(v).iter().copied()).enumerate()
                    {
                        if lane == 0 {
                            quantized.push([[0; LANES]; 3]);
                        }
                        (0..3).for_each(|axis| quantized[first + k][axis][lane] = x[axis]);
                    }
                }
            }
            starts.push(starts[bucket as usize] + own.len().div_ceil(LANES) as u32);
        }
        if starts.last().is_some_and(|groups| !have_places(*groups)) {
            return Self::default();
        }
        Self { starts, quantized, corners, instructions: InstructionSet::default() }
    }

    /// Whether no vertices are stored: then queries must use exact positions.
    pub(crate) fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Allocates memory for the coarse positions of all buckets.
    pub(crate) fn new_positions<const E: usize>(&self) -> Vec<[Vec4; E]> {
        vec![[Vec4::ZERO; E]; LANES * self.starts.last().map_or(0, |end| *end as usize)]
    }

    /// Returns the groups of a bucket.
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
        let groups = self.groups(bucket);
        let modes = motion.factors.len();
        let displacements = &self.quantized[groups.start * modes..groups.end * modes];
        let positions = positions[groups.start * LANES..groups.end * LANES].as_chunks_mut().0;
        self.instructions.run(MoveVertices { displacements, motion, positions });
    }

    /// Returns the positions of the vertices of a bucket that has been moved, in the frame, in the order of its vertices, followed by
    /// unused entries.
    pub(crate) fn of_bucket<'p, const E: usize>(
        &self,
        bucket: u32,
        positions: &'p [[Vec4; E]],
    ) -> &'p [[Vec4; E]] {
        let groups = self.groups(bucket);
        &positions[groups.start * LANES..groups.end * LANES]
    }

    /// Returns the places of the corners of the triangle in a slot of a bucket, in the positions of all buckets.
    #[inline]
    pub(crate) fn corners(&self, bucket: u32, slot: usize) -> [u32; 3] {
        let first = self.starts[bucket as usize] * LANES as u32;
        let [a, b, c] = self.corners[slot];
        [first + u32::from(a), first + u32::from(b), first + u32::from(c)]
    }
}

/// Whether the places of the vertices of this many groups are numbers of 32 bits.
fn have_places(groups: u32) -> bool {
    with_mutant!(groups.checked_mul(LANES as u32).is_some(), CoarsePlacesWrap, true)
}

/// The motion of all groups of a bucket.
struct MoveVertices<'b, const E: usize> {
    displacements: &'b [[[i16; LANES]; 3]],
    motion: &'b CoarseMotion<E>,
    positions: &'b mut [[[Vec4; E]; LANES]],
}

impl<const E: usize> Kernel for MoveVertices<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, v: V) {
        let Self { displacements, motion: CoarseMotion { factors, shift, maps, .. }, positions } = self;
        // These are loops, because maps of arrays are not inlined.
        let mut shifts = [[v.splat(0.0); 3]; E];
        for end in 0..E {
            let shift = shift[end];
            shifts[end] = [v.splat(shift.x), v.splat(shift.y), v.splat(shift.z)];
        }
        for (group, displacements) in displacements.chunks_exact(factors.len()).enumerate() {
            let mut sums = shifts;
            for (axes, factor) in displacements.iter().zip(factors) {
                for axis in 0..3 {
                    let displacement = v.convert(&axes[axis]);
                    for end in 0..E {
                        let factor = v.splat(factor[end]);
                        sums[end][axis] = v.multiply_add(displacement, factor, sums[end][axis]);
                    }
                }
            }
            for end in 0..E {
                let mut sum = sums[end];
                if let Some(maps) = maps {
                    sum = maps[end].apply(v, sum);
                }
                let points = v.points(sum);
                for lane in 0..LANES {
                    positions[group][lane][end] = points[lane];
                }
            }
        }
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

    #[test]
    fn places_are_numbers_of_32_bits() {
        assert!(have_places(0) && have_places((1 << 29) - 1));
        assert!(!have_places(1 << 29) && !have_places(u32::MAX));
    }

    /// The bound holds also if modes have very different sizes, cancel each other, or move no vertex, and far from the
    /// origin. The test also asserts that the bound is not much too large.
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
            // If most modes move few vertices, vertices have lists of modes.
            if layout.coarse.is_empty() || !layout.quantization.begin(&mut motion, ends, &frame, rounding) {
                unused += 1;
                continue;
            }
            used += 1;
            compare_kernels(&layout, ends, &frame, rounding);
            let mut largest = 0.0_f64;
            for bucket in 0..layout.buckets.count() as u32 {
                layout.coarse.move_bucket(bucket, &motion, &mut positions);
                for slot in layout.buckets.packets(bucket).flat_map(|packet| layout.buckets.slots(packet)) {
                    let corners = layout.coarse.corners(bucket, slot).map(|i| positions[i as usize]);
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

    /// Checks that both instruction sets give the same bits.
    fn compare_kernels(layout: &Layout, ends: [&[f64]; 2], frame: &F32Frame, rounding: f64) {
        let mut coarse = CoarseVertices::new(&layout.quantization, &layout.buckets, &layout.vertices);
        let mut motion = CoarseMotion::default();
        layout.quantization.begin(&mut motion, ends, frame, rounding);
        let found = [InstructionSet::default(), InstructionSet::Baseline].map(|instructions| {
            coarse.instructions = instructions;
            let mut positions: Vec<[Vec4; 2]> = coarse.new_positions();
            for bucket in 0..layout.buckets.count() as u32 {
                coarse.move_bucket(bucket, &motion, &mut positions);
            }
            let bits = |x: &Vec4| x.to_array().map(f32::to_bits);
            positions.as_flattened().iter().map(bits).collect::<Vec<_>>()
        });
        assert_eq!(found[0], found[1]);
    }
}
