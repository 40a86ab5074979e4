//! Positions in single precision with a bound of their error. Boxes are made from them, so that exact positions are
//! computed for the few triangles only whose boxes overlap.
//!
//! Half the bytes and four vertices side by side: moving vertices is what queries take longest for, and it waits for
//! memory.

use std::ops::Range;

use glam::{DVec3, Mat4, Vec4};

use super::clusters::Clusters;
use super::frame::Frame;
use super::vertices::Vertices;
use crate::ReducedModel;
use crate::hierarchy::bounding_box;

/// Rest positions and modes of the vertices of each cluster. The rest pose is one more mode, the first, whose
/// coordinate is 1; each is given as a share of its largest displacement.
#[derive(Default)]
pub(super) struct Rough {
    /// The middle of the rest pose, and the largest distance from it along an axis.
    center: DVec3,
    half: f64,
    /// The largest displacement by each mode.
    sizes: Vec<f64>,
    /// For each cluster where its groups of four vertices begin, and the end.
    starts: Vec<u32>,
    /// `[group * (rank + 1) + mode][axis]`: one lane for each vertex.
    shares: Vec<[Vec4; 3]>,
    /// The corners of the triangle at each place, among the vertices of its cluster.
    corners: Vec<[u8; 3]>,
}

/// Vertices side by side.
const GROUP: usize = 4;

/// A larger error, in the coordinates of the frame, is not worth the time that it saves.
const WORST_MARGIN: f64 = 1.0 / 2048.0;

/// How vertices move in a query: what each share is multiplied by.
#[derive(Clone)]
pub(super) struct Motion<const E: usize> {
    /// Where the middle of the rest pose is in the frame.
    shift: [[Vec4; 3]; E],
    /// For each mode the same number in all lanes.
    factors: Vec<[Vec4; E]>,
    /// How far along an axis positions may be from the exact ones, mapped to the frame.
    pub(super) margin: f32,
    /// Of the vertices of each cluster, if they have been moved in this query.
    positions: Vec<[Vec4; E]>,
}

impl<const E: usize> Motion<E> {
    pub(super) fn new(rough: &Rough) -> Self {
        let groups = rough.starts.last().map_or(0, |end| *end as usize);
        let positions = vec![[Vec4::ZERO; E]; groups * GROUP];
        Self { shift: [[Vec4::ZERO; 3]; E], factors: Vec::new(), margin: 0.0, positions }
    }
}

impl Rough {
    pub(super) fn new(model: &ReducedModel, clusters: &Clusters, vertices: &Vertices) -> Self {
        let rank = model.rank();
        let at_rest = (0..vertices.count() as u32).map(|place| vertices.rest(place));
        let (lower, upper) = if vertices.count() == 0 { Default::default() } else { bounding_box(at_rest) };
        let center = lower * 0.5 + upper * 0.5;
        let half = (upper - center).max(center - lower).max_element();
        let sizes: Vec<f64> = (0..rank).map(|k| model.moved_by(k, 1.0)).collect();
        let share = |u: DVec3, size: f64| if size > 0.0 { (u / size).as_vec3() } else { glam::Vec3::ZERO };
        let (mut starts, mut shares, mut corners) = (vec![0], Vec::new(), Vec::new());
        let mut numbers = vec![0_u8; vertices.count()];
        for cluster in 0..clusters.count() as u32 {
            let own = clusters.vertices(cluster);
            own.iter().enumerate().for_each(|(i, v)| numbers[*v as usize] = i as u8);
            for block in clusters.blocks(cluster) {
                let places = &clusters.corners()[clusters.places(block)];
                corners.extend(places.iter().map(|places| places.map(|v| numbers[v as usize])));
            }
            for group in own.chunks(GROUP) {
                let first = shares.len();
                shares.resize(first + rank + 1, [Vec4::ZERO; 3]);
                for (lane, &v) in group.iter().enumerate() {
                    let rest = share(vertices.rest(v) - center, half);
                    let modes = vertices.modes(v).iter().zip(&sizes).map(|(u, size)| share(*u, *size));
                    for (to, x) in shares[first..].iter_mut().zip(std::iter::once(rest).chain(modes)) {
                        (0..3).for_each(|axis| to[axis][lane] = x[axis]);
                    }
                }
            }
            starts.push((shares.len() / (rank + 1)) as u32);
        }
        Self { center, half, sizes, starts, shares, corners }
    }

    /// Takes up a query in a frame whose box contains all positions; `rounding` is how far computed positions may be
    /// from those of real numbers. False where single precision would not do.
    ///
    /// With u = 2^-24 and d the sum of all factors, none of the r + 1 rounded sums is beyond 1 + 2 d: the middle of the
    /// rest pose is within 1 + d of that of the frame, because each vertex is within 1 of the latter. Each sum adds
    /// u of that; shares, factors and products add 3 u d, the shift, the mapped position and the box's widening u (3 + d).
    pub(super) fn begin<const E: usize>(
        &self,
        motion: &mut Motion<E>,
        q: [&[f64]; E],
        frame: &Frame,
        rounding: f64,
    ) -> bool {
        if self.starts.is_empty() {
            return false;
        }
        let unit = f64::from(f32::EPSILON) / 2.0;
        let scale = frame.scale();
        let rest = self.half * scale;
        let mut most = 0.0_f64;
        motion.factors.clear();
        motion.factors.push([Vec4::splat(rest as f32); E]);
        let mut sums = [rest; E];
        for (k, size) in self.sizes.iter().enumerate() {
            let factors = q.map(|q| q[k] * size * scale);
            (0..E).for_each(|end| sums[end] += factors[end].abs());
            motion.factors.push(factors.map(|x| Vec4::splat(x as f32)));
        }
        for sum in sums {
            // Also where it is no number.
            most = if sum <= most { most } else { sum };
        }
        let margin = unit * (q[0].len() + 12) as f64 * (1.0 + 2.0 * most) * 1.1 + 4.0 * rounding * scale;
        let shift = frame.linear(self.center);
        motion.shift = [[shift.x, shift.y, shift.z].map(|x| Vec4::splat(x as f32)); E];
        motion.margin = (margin * (1.0 + 1e-6)) as f32;
        margin <= WORST_MARGIN
    }

    /// Where all vertices of a cluster are kept.
    fn groups(&self, cluster: u32) -> Range<usize> {
        self.starts[cluster as usize] as usize..self.starts[cluster as usize + 1] as usize
    }

    /// Moves a cluster's vertices.
    pub(super) fn move_cluster<const E: usize>(&self, cluster: u32, motion: &mut Motion<E>) {
        let (groups, modes) = (self.groups(cluster), motion.factors.len());
        let positions = &mut motion.positions[groups.start * GROUP..groups.end * GROUP];
        let shares = self.shares[groups.start * modes..groups.end * modes].chunks_exact(modes);
        for (group, positions) in shares.zip(positions.as_chunks_mut::<GROUP>().0) {
            let mut sums = motion.shift;
            for (share, factors) in group.iter().zip(&motion.factors) {
                for end in 0..E {
                    for axis in 0..3 {
                        sums[end][axis] += share[axis] * factors[end];
                    }
                }
            }
            let columns = sums.map(|[x, y, z]| Mat4::from_cols(x, y, z, Vec4::ZERO).transpose());
            *positions = std::array::from_fn(|lane| columns.map(|columns| columns.col(lane)));
        }
    }

    /// The corners of the triangle at a place of a cluster whose vertices have been moved, in the frame; their fourth
    /// components mean nothing.
    #[inline]
    pub(super) fn corners<const E: usize>(
        &self,
        cluster: u32,
        place: usize,
        motion: &Motion<E>,
    ) -> [[Vec4; E]; 3] {
        let first = self.starts[cluster as usize] as usize * GROUP;
        self.corners[place].map(|v| motion.positions[first + v as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::boxes::margin;
    use crate::{Method, Modes, Query, Scope, TriMesh};

    struct Random(u64);

    impl Random {
        /// In [-1, 1).
        fn number(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / 2.0_f64.powi(52) - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.number(), self.number(), self.number())
        }
    }

    /// Also where modes have very different sizes, cancel each other, or move nothing, and far from the origin. That the
    /// bound is not wasted is asserted, too.
    #[test]
    fn positions_are_as_near_as_they_say() {
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
                (0..rank).map(|k| random.number() / [1.0, 1e-30, 1.0, 1e5, 1e-3][(k + case) % 5]).collect();
            q.iter_mut().for_each(|q| *q *= [1.0, 0.01, 0.0, 100.0][case / 4 % 4] / rank as f64);
            (5..rank).step_by(6).for_each(|k| q[k] = -q[k - 1]);
            let faces = (0..88).map(|i| [i, i + 1, i + 2]).collect();
            let model =
                ReducedModel::new(TriMesh::new(rest, faces).unwrap(), Modes::new(rank, modes).unwrap());
            let model = model.unwrap();
            let query = Query::without_certificates(&model, Scope::of(&model), Method::BdTree).unwrap();
            let tables = &query.discrete.boxes.tables;
            let later: Vec<f64> = q.iter().map(|q| q * 1.5).collect();
            let ends = [&q[..], &later[..]];
            let rounding = margin(model.check_coordinates(&later).unwrap(), rank);
            let frame = Frame::of(tables.bd_tree.root(ends, DVec3::splat(rounding)));
            let mut motion = Motion::new(&tables.rough);
            if !tables.rough.begin(&mut motion, ends, &frame, rounding) {
                unused += 1;
                continue;
            }
            used += 1;
            let mut largest = 0.0_f64;
            for cluster in 0..tables.clusters.count() as u32 {
                tables.rough.move_cluster(cluster, &mut motion);
                for place in tables.clusters.blocks(cluster).flat_map(|block| tables.clusters.places(block)) {
                    let corners = tables.rough.corners(cluster, place, &motion);
                    for (v, rough) in tables.clusters.corners()[place].into_iter().zip(corners) {
                        for (x, rough) in tables.vertices.position(v, ends).into_iter().zip(rough) {
                            let off = (rough.truncate().as_dvec3() - frame.linear(x)).abs().max_element();
                            let mapped = (rough - frame.map(x)).truncate().abs().max_element();
                            largest = largest.max(off).max(f64::from(mapped));
                        }
                    }
                }
            }
            assert!(largest <= f64::from(motion.margin), "case {case}: {largest:e} {:e}", motion.margin);
            worst = worst.max(largest / f64::from(motion.margin));
        }
        assert!(used > 300 && unused > 2 && worst > 0.05, "{used} {unused} {worst}");
    }
}
