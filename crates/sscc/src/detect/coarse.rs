//! Positions in single precision: boxes are made from them, so that exact ones are computed for the few triangles only
//! that may meet.

use std::ops::Range;

use glam::{Mat4, Vec4};

use crate::detect::buckets::Clusters;
use crate::detect::quantization::{Motion, Units};
use crate::detect::vertices::Vertices;

/// Rest positions and modes of the vertices of each cluster. Vertices of several clusters are there several times (of
/// the dragon, 1.7): what is read together lies together.
#[derive(Default)]
pub(crate) struct Rough {
    /// For each cluster where its groups of four vertices begin, and the end.
    starts: Vec<u32>,
    /// `[group * (rank + 1) + mode][axis]`, as [`Units`] tells: one lane for each vertex.
    shares: Vec<[[i16; GROUP]; 3]>,
    /// The corners of the triangle at each place, among the vertices of its cluster.
    corners: Vec<[u8; 3]>,
}

/// Vertices side by side.
const GROUP: usize = 4;

impl Rough {
    pub(crate) fn new(units: &Units, clusters: &Clusters, vertices: &Vertices) -> Self {
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
                for (lane, &v) in group.iter().enumerate() {
                    for (k, x) in
                        units.shares(vertices.rest(v), vertices.modes(v).iter().copied()).enumerate()
                    {
                        if lane == 0 {
                            shares.push([[0; GROUP]; 3]);
                        }
                        (0..3).for_each(|axis| shares[first + k][axis][lane] = x[axis]);
                    }
                }
            }
            starts.push(starts[cluster as usize] + own.len().div_ceil(GROUP) as u32);
        }
        Self { starts, shares, corners }
    }

    /// Whether there is anything.
    pub(crate) fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Memory for the positions of all clusters.
    pub(crate) fn memory<const E: usize>(&self) -> Vec<[Vec4; E]> {
        vec![[Vec4::ZERO; E]; GROUP * self.starts.last().map_or(0, |end| *end as usize)]
    }

    /// Where the groups of a cluster are.
    fn groups(&self, cluster: u32) -> Range<usize> {
        self.starts[cluster as usize] as usize..self.starts[cluster as usize + 1] as usize
    }

    /// Moves a cluster's vertices.
    pub(crate) fn move_cluster<const E: usize>(
        &self,
        cluster: u32,
        motion: &Motion<E>,
        positions: &mut [[Vec4; E]],
    ) {
        let (groups, modes) = (self.groups(cluster), motion.factors.len());
        let positions = &mut positions[groups.start * GROUP..groups.end * GROUP];
        let shares = self.shares[groups.start * modes..groups.end * modes].chunks_exact(modes);
        let shift = motion.shift.map(|x| [0, 1, 2].map(|axis| Vec4::splat(x[axis])));
        for (group, positions) in shares.zip(positions.as_chunks_mut::<GROUP>().0) {
            let mut sums = shift;
            for (share, factors) in group.iter().zip(&motion.factors) {
                for end in 0..E {
                    for axis in 0..3 {
                        sums[end][axis] += Vec4::from_array(share[axis].map(f32::from)) * factors[end];
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
    pub(crate) fn corners<const E: usize>(
        &self,
        cluster: u32,
        place: usize,
        positions: &[[Vec4; E]],
    ) -> [[Vec4; E]; 3] {
        let first = self.starts[cluster as usize] as usize * GROUP;
        self.corners[place].map(|v| positions[first + v as usize])
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::detect::frame::Frame;
    use crate::detect::volumes::margin;
    use crate::query::kinetic::tests::Random;
    use crate::{Method, Modes, Query, ReducedModel, Scope, TriMesh};

    /// Also where modes have very different sizes, cancel each other, or move nothing, and far from the origin. That
    /// the bound is not wasted is asserted, too.
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
                (0..rank).map(|k| random.signed() / [1.0, 1e-30, 1.0, 1e5, 1e-3][(k + case) % 5]).collect();
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
            let (mut motion, mut positions) = (Motion::default(), tables.rough.memory());
            if !tables.units.begin(&mut motion, ends, &frame, rounding) {
                unused += 1;
                continue;
            }
            used += 1;
            let mut largest = 0.0_f64;
            for cluster in 0..tables.clusters.count() as u32 {
                tables.rough.move_cluster(cluster, &motion, &mut positions);
                for place in tables.clusters.blocks(cluster).flat_map(|block| tables.clusters.places(block)) {
                    let corners = tables.rough.corners(cluster, place, &positions);
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
