//! The search for kappa: the largest `|V_j - V_i| / s_ij` of any two corners of a patch, where `V = E W^-1` are the residuals'
//! images and `|.|` is the largest singular value. Branch and bound over pairs of nodes.

use glam::DVec3;

use super::patch::PatchBuilder;
use crate::geometry::nearest_to_origin;
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// A pair of nodes whose bound is at most this many times the largest value found is not split.
const ACCEPTED: f64 = 1.1;

/// Pairs that the ellipsoid is fitted to, and what replaces the least of them.
const HOT_PAIRS: usize = 96;

/// A direction whose gap is this share of the distance of the centroids is wide enough.
const WIDE: f64 = 0.6;

/// Covers the rounding of gaps in the unit of half the shape's size: coordinates are at most about 1.
const GAP_ROUNDING: f64 = 1e-14;

/// What the search finds.
pub(super) struct StrainBound {
    /// `kappa`
    pub(super) residual: f64,
    /// The smallest `s_ij`.
    pub(super) smallest_gap: f64,
    /// The largest norm of an image.
    pub(super) largest_image: f64,
}

/// A node of the patch: a sphere around its vertices, and a ball around their images.
#[derive(Clone, Copy, Default)]
struct Part {
    node: u32,
    first_child: u32,
    child_count: u32,
    triangle_count: u32,
    center: DVec3,
    radius: f64,
    /// The radius of the ball of images about its mean.
    spread: f64,
}

/// Memory of searches of one thread.
#[derive(Default)]
pub(super) struct StrainSearch {
    /// The node and all below it, breadth first; then those of each bucket of the ring.
    parts: Vec<Part>,
    /// The parts of the ring's buckets.
    ring: Vec<u32>,
    /// For each part three rows: the mean image of its vertices.
    means: Vec<f64>,
    positions: Vec<DVec3>,
    /// For each leaf its vertices' numbers, by part.
    leaf_vertices: Vec<Vec<u32>>,
    stack: Vec<(u32, u32)>,
}

/// Two corners, by their numbers in the patch, whose gap was small for their images.
#[derive(Clone, Copy)]
struct HotPair {
    ratio: f64,
    i: u32,
    j: u32,
    gap: f64,
}

/// The hottest pairs of a search, not more than one for each two triangles.
#[derive(Default)]
pub(super) struct HotPairs(Vec<HotPair>);

impl HotPairs {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    fn add(&mut self, pair: HotPair) {
        if self.0.len() >= 2 * HOT_PAIRS {
            self.shrink();
        }
        self.0.push(pair);
    }

    fn shrink(&mut self) {
        self.0.sort_unstable_by(|a, b| b.ratio.total_cmp(&a.ratio).then((a.i, a.j).cmp(&(b.i, b.j))));
        self.0.truncate(HOT_PAIRS);
    }

    /// Adds the blocks of these pairs: the differences of residuals over the gap.
    pub(super) fn add_blocks(&mut self, blocks: &mut Vec<f64>, residuals: &[f64], row_len: usize) {
        self.shrink();
        for pair in &self.0 {
            let [x, y] = [pair.i, pair.j].map(|i| &residuals[3 * row_len * i as usize..][..3 * row_len]);
            blocks.extend(x.iter().zip(y).map(|(x, y)| (y - x) / pair.gap));
        }
    }
}

impl StrainSearch {
    pub(super) fn new(_nodes: usize) -> Self {
        Self::default()
    }

    /// Takes a patch.
    pub(super) fn load(
        &mut self,
        builder: &PatchBuilder<'_>,
        n: u32,
        ring: &[u32],
        vertices: &[u32],
        numbers: &[u32],
    ) {
        let nodes = builder.hierarchy.nodes();
        self.positions.clear();
        self.positions.extend(vertices.iter().map(|v| builder.unit.positions[*v as usize]));
        self.parts.clear();
        self.ring.clear();
        self.leaf_vertices.clear();
        for root in std::iter::once(n).chain(ring.iter().copied()) {
            if root != n {
                self.ring.push(self.parts.len() as u32);
            }
            let mut next = self.parts.len();
            self.parts.push(Part { node: root, ..Part::default() });
            while next < self.parts.len() {
                let node = &nodes[self.parts[next].node as usize];
                let first_child = self.parts.len() as u32;
                let part = &mut self.parts[next];
                (part.first_child, part.child_count) = (first_child, node.child_count);
                part.triangle_count = node.triangle_count;
                self.parts.extend(node.children().map(|child| Part { node: child, ..Part::default() }));
                next += 1;
            }
        }
        self.leaf_vertices.resize(self.parts.len(), Vec::new());
        for p in (0..self.parts.len()).rev() {
            let part = self.parts[p];
            let (mut center, mut radius) = (DVec3::ZERO, 0.0_f64);
            if part.child_count == 0 {
                let node = &nodes[part.node as usize];
                let list = &mut self.leaf_vertices[p];
                for &t in builder.hierarchy.triangles(node) {
                    list.extend(builder.filter.faces()[t as usize].map(|v| numbers[v as usize]));
                }
                list.sort_unstable();
                list.dedup();
                list.iter().for_each(|i| center += self.positions[*i as usize]);
                center /= list.len() as f64;
                list.iter()
                    .for_each(|i| radius = radius.max((self.positions[*i as usize] - center).length()));
            } else {
                let children = &self.parts[part.first_child as usize..][..part.child_count as usize];
                let total: f64 = children.iter().map(|child| f64::from(child.triangle_count)).sum();
                center = children.iter().map(|c| c.center * (f64::from(c.triangle_count) / total)).sum();
                radius = children.iter().map(|c| (c.center - center).length() + c.radius).fold(0.0, f64::max);
            }
            (self.parts[p].center, self.parts[p].radius) = (center, radius + GAP_ROUNDING);
        }
    }

    /// Blocks to begin with: the residual of each vertex over its distance from the first one.
    pub(super) fn first_blocks(&self, residuals: &[f64], offsets: &[DVec3], row_len: usize) -> Vec<f64> {
        let step = offsets.len().div_ceil(HOT_PAIRS);
        let mut blocks = Vec::new();
        for (rows, d) in residuals.chunks_exact(3 * row_len).zip(offsets).skip(1).step_by(step) {
            let distance = d.length();
            if distance > 0.0 {
                blocks.extend(rows.iter().map(|e| e / distance));
            }
        }
        blocks
    }

    /// Searches kappa for these images. None where two triangles that count have no gap.
    pub(super) fn run(
        &mut self,
        builder: &PatchBuilder<'_>,
        instructions: &InstructionSet,
        images: &[f64],
        numbers: &[u32],
        row_len: usize,
        hot: &mut HotPairs,
    ) -> Option<StrainBound> {
        instructions.run(Search { search: self, builder, images, numbers, row_len, hot })
    }
}

struct Search<'s, 'b> {
    search: &'s mut StrainSearch,
    builder: &'s PatchBuilder<'b>,
    images: &'s [f64],
    numbers: &'s [u32],
    row_len: usize,
    hot: &'s mut HotPairs,
}

impl Kernel for Search<'_, '_> {
    type Output = Option<StrainBound>;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> Option<StrainBound> {
        let Self { search, builder, images, numbers, row_len, hot } = self;
        let width = 3 * row_len;
        let image = |i: u32| &images[width * i as usize..][..width];
        let largest = images.chunks_exact(width).map(square).fold(0.0, f64::max).sqrt() * (1.0 + 1e-12);
        let StrainSearch { parts, ring, means, positions, leaf_vertices, stack } = search;
        // Means and spreads, from below.
        means.clear();
        means.resize(width * parts.len(), 0.0);
        for p in (0..parts.len()).rev() {
            let part = parts[p];
            let mut spread = 0.0_f64;
            let (before, after) = means.split_at_mut(width * (p + 1));
            let mean = &mut before[width * p..];
            if part.child_count == 0 {
                let list = &leaf_vertices[p];
                let weight = 1.0 / list.len() as f64;
                list.iter().for_each(|i| mean.iter_mut().zip(image(*i)).for_each(|(m, x)| *m += weight * x));
                for i in list {
                    spread = spread.max(squared_difference(mean, image(*i)));
                }
                spread = spread.sqrt();
            } else {
                let range = part.first_child as usize..(part.first_child + part.child_count) as usize;
                let child_mean = |c: usize| &after[width * (c - p - 1)..][..width];
                let weight = 1.0 / f64::from(part.child_count);
                for c in range.clone() {
                    mean.iter_mut().zip(child_mean(c)).for_each(|(m, x)| *m += weight * x);
                }
                for c in range {
                    spread = spread.max(squared_difference(mean, child_mean(c)).sqrt() + parts[c].spread);
                }
            }
            parts[p].spread = spread * (1.0 + 1e-12);
        }
        let mean = |p: u32| &means[width * p as usize..][..width];
        let (mut residual, mut gap) = (0.0_f64, f64::INFINITY);
        let mut accepted = 0.0_f64;
        stack.clear();
        stack.push((0, 0));
        stack.extend(ring.iter().map(|p| (0, *p)));
        while let Some((x, y)) = stack.pop() {
            let (a, b) = (parts[x as usize], parts[y as usize]);
            if x == y {
                if a.child_count > 0 {
                    let children = a.first_child..a.first_child + a.child_count;
                    for c in children.clone() {
                        stack.push((c, c));
                        stack.extend((c + 1..children.end).map(|d| (c, d)));
                    }
                    continue;
                }
            } else {
                let distance = (b.center - a.center).length() * (1.0 - 1e-14) - a.radius - b.radius;
                if distance > 0.0 {
                    let difference = squared_difference(mean(x), mean(y)).sqrt();
                    let ratio = (difference + a.spread + b.spread) / distance;
                    if ratio <= ACCEPTED * residual {
                        accepted = accepted.max(ratio);
                        gap = gap.min(distance);
                        continue;
                    }
                }
                if a.child_count > 0 && (b.child_count == 0 || a.triangle_count >= b.triangle_count) {
                    stack.extend((a.first_child..a.first_child + a.child_count).map(|c| (c, y)));
                    continue;
                }
                if b.child_count > 0 {
                    stack.extend((b.first_child..b.first_child + b.child_count).map(|c| (x, c)));
                    continue;
                }
            }
            let distance = (b.center - a.center).length() * (1.0 - 1e-14) - a.radius - b.radius;
            let Some(table) = builder.gaps.get(a.node, b.node) else {
                // Far apart: the spheres decide.
                if distance <= 0.0 {
                    return None;
                }
                let ratio = (squared_difference(mean(x), mean(y)).sqrt() + a.spread + b.spread) / distance;
                residual = residual.max(ratio);
                gap = gap.min(distance);
                continue;
            };
            let table = table.as_ref()?;
            gap = gap.min(f64::from(table.smallest));
            let (first, second) = if a.node <= b.node { (a, b) } else { (b, a) };
            let [list_a, list_b] = [first, second].map(|part| &builder.gaps.vertices[part.node as usize]);
            for (u, row) in list_a.iter().zip(table.gaps.chunks_exact(list_b.len())) {
                let i = numbers[*u as usize];
                for (v, s) in list_b.iter().zip(row) {
                    if *s == f32::INFINITY {
                        continue;
                    }
                    let (s, j) = (f64::from(*s), numbers[*v as usize]);
                    let frobenius = squared_difference(image(i), image(j));
                    if frobenius > (residual * s) * (residual * s) {
                        residual = residual.max(largest_singular_value(image(i), image(j)) / s);
                    }
                    if frobenius > (0.5 * residual * s) * (0.5 * residual * s) {
                        hot.add(HotPair { ratio: frobenius.sqrt() / s, i, j, gap: s });
                    }
                }
            }
        }
        if gap == f64::INFINITY {
            gap = 1.0;
        }
        Some(StrainBound { residual: residual.max(accepted), smallest_gap: gap, largest_image: largest })
    }
}

/// The gap of each two corners along one unit direction, rounded down; none where no direction found separates all of them.
pub(super) fn widest_gaps(differences: &[DVec3; 9]) -> Option<[f64; 9]> {
    let along = |dir: DVec3| {
        let dir = dir.try_normalize()?;
        let gaps = differences.map(|d| dir.dot(d) * (1.0 - 1e-14) - GAP_ROUNDING);
        let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        (smallest > 0.0).then_some((smallest, gaps))
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

#[inline(always)]
fn square(x: &[f64]) -> f64 {
    crate::model::mode_rows::dot(x, x)
}

#[inline(always)]
fn squared_difference(x: &[f64], y: &[f64]) -> f64 {
    crate::model::mode_rows::squared_distance(x, y)
}

/// An upper bound of the largest singular value of the difference of three rows, at most 7% above it: by the sum of the 16th
/// powers of the eigenvalues of the Gram matrix.
#[inline(always)]
fn largest_singular_value(x: &[f64], y: &[f64]) -> f64 {
    let row_len = x.len() / 3;
    let mut gram = [[0.0_f64; 3]; 3];
    for k in 0..row_len {
        let d: [f64; 3] = std::array::from_fn(|c| y[c * row_len + k] - x[c * row_len + k]);
        for i in 0..3 {
            for j in i..3 {
                gram[i][j] += d[i] * d[j];
            }
        }
    }
    let trace = gram[0][0] + gram[1][1] + gram[2][2];
    if trace.is_nan() || trace <= 0.0 {
        return if trace == 0.0 { 0.0 } else { f64::INFINITY };
    }
    let mut power: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| gram[i.min(j)][i.max(j)] / trace));
    for _ in 0..3 {
        power =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| power[i][k] * power[k][j]).sum()));
    }
    let sum: f64 = power.iter().flatten().map(|x| x * x).sum();
    // sum = trace of the 16th power; root by repeated square roots.
    (sum.sqrt().sqrt().sqrt().sqrt() * trace).sqrt() * (1.0 + 1e-11)
}
