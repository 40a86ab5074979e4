//! The gaps between corners along directions that separate triangles, at the centre.
//!
//! For leaves that are near each other a table has, for each two vertices, the smallest gap over all pairs of triangles that
//! have them as corners. Leaves that are farther apart have one direction for all their triangles.

use crate::filter::{PairFilter, Relation, SimplexPair};
use crate::geometry::nearest_to_origin;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::{Error, Progress, parallel};
use glam::DVec3;

/// Leaves have a table if the gap of their spheres is at most this share of the sum of the radii.
const NEAR: f64 = 0.3;

/// The direction between the centroids is accepted without a search for a better one if its smallest gap is more than
/// this share of the distance of the centroids.
const WIDE: f64 = 0.6;

/// Covers the rounding of gaps in the unit of half the shape's size: coordinates are at most about 1, offsets at most `2 sqrt(3)`. A
/// component of a vertex along a direction rounds by 14 units of 2^-53, a gap of two by less than 32 (3.6e-15).
const GAP_ROUNDING: f64 = 1e-14;

/// A gap of at most this proves nothing.
const SMALLEST: f64 = 1e-9;

/// The smallest gaps between the vertices of two near leaves.
pub(super) struct GapTable {
    /// For each vertex of the first leaf its gaps to the vertices of the second, rounded down; infinite where no pair of
    /// triangles counts.
    pub(super) gaps: Vec<f32>,
    /// The smallest gap of each vertex of the first leaf.
    pub(super) of_rows: Vec<f32>,
    pub(super) smallest: f32,
}

/// The two corners of two near leaves whose gap is smallest for their distance, by vertices.
#[derive(Clone, Copy)]
pub(super) struct TightPair {
    pub(super) i: u32,
    pub(super) j: u32,
    pub(super) gap: f32,
}

/// A sphere around the vertices of a node.
#[derive(Clone, Copy, Default)]
pub(super) struct Sphere {
    pub(super) center: DVec3,
    /// The radius, rounded up.
    pub(super) radius: f64,
}

/// The vertices of leaves, spheres of nodes, and the tables of near leaves.
pub(super) struct CornerGaps<'g> {
    pub(super) hierarchy: &'g Hierarchy,
    pub(super) filter: &'g PairFilter,
    positions: &'g [DVec3],
    progress: &'g dyn Progress,
    /// For each node the start of its vertices, which only leaves have, and the end.
    starts: Vec<u32>,
    vertices: Vec<u32>,
    pub(super) spheres: Vec<Sphere>,
    /// For each node the start of its tables with later leaves, which only leaves have, and the end.
    table_starts: Vec<u32>,
    /// The later leaf of each table, ascending for each first one.
    table_leaves: Vec<u32>,
    /// The tables. None if two triangles that count have no gap.
    tables: Vec<Option<GapTable>>,
    /// For each node the start of the tight pairs of these tables, and the end.
    tight_starts: Vec<u32>,
    /// The later leaf of each tight pair, and the pair.
    tight: Vec<(u32, TightPair)>,
}

/// The largest number of near pairs, divided by the number of leaves. Meshes of long thin triangles may have more, and their
/// tables would not fit into the memory (docs/notes/local-certificates.md#near-leaves).
const MAX_NEAR_SHARE: usize = 256;

/// The largest memory of all tables for each triangle of the mesh (bytes), and a memory that is always allowed. Real meshes have 10 to 14
/// near pairs for each leaf: about 2.5 kB a triangle, with 13 vertices and 4.5 triangles in a leaf.
const MAX_BYTES_PER_TRIANGLE: u64 = 4096;
const ALLOWED_BYTES: u64 = 1 << 28;

/// The memory of a table beside its gaps, on any machine.
const BYTES_OF_TABLE: u64 = 64;

/// Returns the largest memory of all tables of a mesh.
fn max_bytes(triangles: usize) -> u64 {
    ALLOWED_BYTES.max(MAX_BYTES_PER_TRIANGLE * triangles as u64)
}

/// Tables between two checks for cancellation; one takes some microseconds.
const TABLES_PER_CHECK: usize = 1 << 12;

impl<'g> CornerGaps<'g> {
    /// Computes all tables. None if more pairs of leaves are near than [`MAX_NEAR_SHARE`] allows, or their tables are too large.
    ///
    /// # Errors
    /// When `progress` cancels.
    pub(super) fn new(
        hierarchy: &'g Hierarchy,
        filter: &'g PairFilter,
        positions: &'g [DVec3],
        progress: &'g dyn Progress,
    ) -> Result<Option<Self>, Error> {
        let nodes = hierarchy.nodes();
        let (mut starts, mut vertices) = (vec![0], Vec::new());
        for node in nodes {
            if node.is_leaf() {
                vertices.extend(hierarchy.vertices(node, filter.faces()));
            }
            starts.push(vertices.len() as u32);
        }
        let mut gaps = Self {
            hierarchy,
            filter,
            positions,
            progress,
            starts,
            vertices,
            spheres: Vec::new(),
            table_starts: Vec::new(),
            table_leaves: Vec::new(),
            tables: Vec::new(),
            tight_starts: Vec::new(),
            tight: Vec::new(),
        };
        gaps.spheres = gaps.node_spheres();
        let leaves = nodes.iter().filter(|node| node.is_leaf()).count();
        let Some(mut near) = gaps.near_leaves(MAX_NEAR_SHARE * leaves) else { return Ok(None) };
        let bytes = |(n, m): &NodePair| {
            let [rows, columns] = [*n, *m].map(|n| gaps.vertices(n).len() as u64);
            BYTES_OF_TABLE + 4 * rows * (columns + 1)
        };
        if near.iter().map(bytes).sum::<u64>() > max_bytes(filter.faces().len()) {
            return Ok(None);
        }
        near.sort_unstable();
        let mut tables: Vec<Option<GapTable>> = Vec::with_capacity(near.len());
        for pairs in near.chunks(TABLES_PER_CHECK) {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            tables.extend(parallel::map(pairs, |pair| gaps.table(*pair)));
        }
        (gaps.tight_starts, gaps.table_starts) = (vec![0; nodes.len() + 1], vec![0; nodes.len() + 1]);
        for (pair, table) in near.iter().zip(&tables) {
            gaps.table_starts[pair.0 as usize + 1] += 1;
            if let Some(tight) = table.as_ref().and_then(|table| gaps.tightest(*pair, table)) {
                gaps.tight.push((pair.1, tight));
                gaps.tight_starts[pair.0 as usize + 1] += 1;
            }
        }
        for n in 0..nodes.len() {
            gaps.tight_starts[n + 1] += gaps.tight_starts[n];
            gaps.table_starts[n + 1] += gaps.table_starts[n];
        }
        gaps.table_leaves = near.into_iter().map(|(_, m)| m).collect();
        gaps.tables = tables;
        Ok(Some(gaps))
    }

    /// Whether the computation should end.
    pub(super) fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }

    /// Returns the vertices of a leaf, ascending.
    #[inline]
    pub(super) fn vertices(&self, leaf: u32) -> &[u32] {
        let [start, end] = [leaf, leaf + 1].map(|n| self.starts[n as usize] as usize);
        &self.vertices[start..end]
    }

    /// Returns the tight pairs of a leaf and later leaves, each with the later leaf.
    pub(super) fn tight(&self, leaf: u32) -> &[(u32, TightPair)] {
        let [start, end] = [leaf, leaf + 1].map(|n| self.tight_starts[n as usize] as usize);
        &self.tight[start..end]
    }

    /// Returns the tightest pair of a table.
    fn tightest(&self, (n, m): NodePair, table: &GapTable) -> Option<TightPair> {
        let [x, y] = [n, m].map(|n| self.vertices(n));
        let pairs = x.iter().flat_map(|i| y.iter().map(|j| (*i, *j))).zip(&table.gaps);
        let distance = |i: u32, j: u32| (self.positions[j as usize] - self.positions[i as usize]).length();
        let tight = pairs
            .filter(|(_, gap)| **gap < f32::INFINITY)
            .map(|((i, j), gap)| (f64::from(*gap) / distance(i, j), TightPair { i, j, gap: *gap }));
        tight.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, pair)| pair)
    }

    /// Returns the table of two leaves, the smaller number first, if they are near.
    #[inline]
    pub(super) fn near(&self, (n, m): NodePair) -> Option<&Option<GapTable>> {
        let [start, end] = [n, n + 1].map(|n| self.table_starts[n as usize] as usize);
        let at = self.table_leaves[start..end].binary_search(&m).ok()?;
        Some(&self.tables[start + at])
    }

    /// Writes the components of all vertices of both leaves, which are not near, along a direction, and returns the smallest gap.
    /// The gap of two vertices is that of their components. None if the direction separates the leaves by too little.
    pub(super) fn components(&self, (n, m): NodePair, out: &mut [Vec<f64>; 2]) -> Option<f64> {
        let [a, b] = [n, m].map(|n| self.spheres[n as usize].center);
        let dir = (b - a).try_normalize()?;
        for (out, leaf) in out.iter_mut().zip([n, m]) {
            out.clear();
            out.extend(self.vertices(leaf).iter().map(|v| dir.dot(self.positions[*v as usize] - a)));
        }
        let last = out[0].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let first = out[1].iter().copied().fold(f64::INFINITY, f64::min);
        let gap = first - last - GAP_ROUNDING;
        (gap > SMALLEST).then_some(gap)
    }

    /// Returns the gap of two components, rounded down.
    #[inline]
    pub(super) fn gap_between(a: f64, b: f64) -> f64 {
        (b - a) * (1.0 - 1e-14) - GAP_ROUNDING
    }

    fn node_spheres(&self) -> Vec<Sphere> {
        let nodes = self.hierarchy.nodes();
        let mut spheres = vec![Sphere::default(); nodes.len()];
        for n in (0..nodes.len()).rev() {
            let node = &nodes[n];
            let (center, radius) = if node.is_leaf() {
                let points = || self.vertices(n as u32).iter().map(|v| self.positions[*v as usize]);
                let center = points().sum::<DVec3>() / points().count() as f64;
                (center, points().map(|p| (p - center).length()).fold(0.0, f64::max))
            } else {
                let children =
                    || node.children().map(|child| (spheres[child as usize], nodes[child as usize]));
                let weight = |count: u32| f64::from(count) / f64::from(node.triangle_count);
                let center = children().map(|(s, c)| s.center * weight(c.triangle_count)).sum::<DVec3>();
                (center, children().map(|(s, _)| (s.center - center).length() + s.radius).fold(0.0, f64::max))
            };
            spheres[n] = Sphere { center, radius: radius * (1.0 + 1e-14) + GAP_ROUNDING };
        }
        spheres
    }

    /// Returns the pairs of near leaves, each leaf with itself included. None if there are more than `most`.
    fn near_leaves(&self, most: usize) -> Option<Vec<NodePair>> {
        let nodes = self.hierarchy.nodes();
        let (mut near, mut stack) = (Vec::new(), vec![(0, 0)]);
        while let Some((n, m)) = stack.pop() {
            if near.len() > most {
                return None;
            }
            let [a, b] = [n, m].map(|n| nodes[n as usize]);
            if n != m {
                let [x, y] = [n, m].map(|n| self.spheres[n as usize]);
                if (y.center - x.center).length() > (1.0 + NEAR) * (x.radius + y.radius) {
                    continue;
                }
            }
            if n == m {
                if a.is_leaf() {
                    near.push((n, n));
                } else {
                    stack.extend(a.children().map(|c| (c, c)));
                    stack.extend(a.child_pairs());
                }
            } else if a.is_leaf() && b.is_leaf() {
                near.push((n.min(m), n.max(m)));
            } else if b.is_leaf() || (!a.is_leaf() && a.triangle_count >= b.triangle_count) {
                stack.extend(a.children().map(|c| (c, m)));
            } else {
                stack.extend(b.children().map(|c| (n, c)));
            }
        }
        Some(near)
    }

    fn table(&self, (n, m): NodePair) -> Option<GapTable> {
        let [x, y] = [n, m].map(|n| self.vertices(n));
        let mut gaps = vec![f32::INFINITY; x.len() * y.len()];
        let [list_a, list_b] = [n, m].map(|n| self.hierarchy.triangles(&self.hierarchy.nodes()[n as usize]));
        for (index, &s) in list_a.iter().enumerate() {
            for &t in if n == m { &list_b[index + 1..] } else { list_b } {
                let is_excluded = with_mutant!(self.filter.is_excluded(s, t), LocalExceptionsKept, false);
                if self.filter.relation(s, t) == Relation::Adjacent || is_excluded {
                    continue;
                }
                for SimplexPair { a, b } in self.filter.simplex_pairs(s, t) {
                    let [p, q] = [a, b].map(|corners| corners.map(|v| self.positions[v as usize]));
                    let found = widest_gaps(&std::array::from_fn(|ij| q[ij % 3] - p[ij / 3]))?;
                    for (ij, gap) in found.into_iter().enumerate() {
                        let i = x.binary_search(&a[ij / 3]).ok()?;
                        let j = y.binary_search(&b[ij % 3]).ok()?;
                        let entry = &mut gaps[i * y.len() + j];
                        // The share alone is more than the rounding to single precision.
                        let share = with_mutant!(1.0 - 1e-6, LocalTableLonger, 1.0 + 1e-6);
                        let shortened = (gap * share) as f32;
                        *entry =
                            entry.min(with_mutant!(shortened.next_down(), LocalTableToNearest, shortened));
                    }
                }
            }
        }
        let smallest = |gaps: &[f32]| gaps.iter().copied().fold(f32::INFINITY, f32::min);
        let of_rows: Vec<f32> = gaps.chunks_exact(y.len()).map(smallest).collect();
        let smallest = smallest(&of_rows);
        Some(GapTable { gaps, of_rows, smallest })
    }
}

/// Returns the gap of each two corners along one unit direction, rounded down. None if no direction found separates all of them.
fn widest_gaps(differences: &[DVec3; 9]) -> Option<[f64; 9]> {
    let along = |dir: DVec3| {
        let dir = dir.try_normalize()?;
        let gaps = differences.map(|d| {
            let between = with_mutant!(d, LocalGapOfCentroids, differences.iter().sum::<DVec3>() / 9.0);
            let gap = dir.dot(between);
            with_mutant!(gap * (1.0 - 1e-14) - GAP_ROUNDING, LocalGapsExact, gap)
        });
        let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        (smallest > SMALLEST).then_some((smallest, gaps))
    };
    let centroids: DVec3 = differences.iter().sum::<DVec3>() / 9.0;
    let first = along(centroids);
    if let Some((smallest, gaps)) = first
        && smallest * smallest > WIDE * WIDE * centroids.length_squared()
    {
        return Some(gaps);
    }
    let second = along(nearest_to_origin(differences).point);
    match (first, second) {
        (Some((s, a)), Some((t, b))) => Some(if s >= t { a } else { b }),
        (Some((_, gaps)), None) | (None, Some((_, gaps))) => Some(gaps),
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests;
