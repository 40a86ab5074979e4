//! The search for the ratio of a set of pairs of triangles: the largest `|V_j - V_i| / s_ij` of any two corners, where
//! `V = E W^-1` are the residuals' images and `|.|` is the largest singular value. Branch and bound over pairs of nodes.

use glam::DVec3;

use super::corner_gaps::{CornerGaps, TightPair};
use super::patch::Patch;
use crate::hierarchy::BUCKET_TRIANGLES;
use crate::vectors::{InstructionSet, Kernel, LANES, Vectors};

/// A pair of nodes whose bound is at most this many times the largest ratio found is not split.
const ACCEPTED: f32 = 1.1;

/// Pairs of parts visited between two checks for cancellation; a visit of two leaves with many modes takes some 100 us.
const VISITS_PER_CHECK: u32 = 1024;

/// Covers the rounding of norms of images, which are sums of `3 r` squares, and of quotients.
const ROUND_UP: f32 = 1.0 + 1e-4;

/// A node of the patch with the images of its vertices.
#[derive(Clone, Copy, Default)]
struct Part {
    node: u32,
    first_child: u32,
    child_count: u32,
    triangle_count: u32,
    center: DVec3,
    radius: f64,
    /// The radius of the ball of images about their mean.
    spread: f32,
}

/// The parts and images of one patch. Owns its memory.
#[derive(Default)]
pub(super) struct StrainSearch {
    instructions: InstructionSet,
    /// A node and all nodes below it, breadth first; then likewise each other node that was added.
    parts: Vec<Part>,
    /// The vertices of the parts that are leaves, by their numbers in the patch.
    vertices: Vec<u32>,
    /// For each part the start of its vertices, and the end.
    vertex_starts: Vec<u32>,
    width: usize,
    pub(super) images: Vec<f32>,
    /// For each part the mean image.
    means: Vec<f32>,
    /// The largest change of the difference of two images by rounding to single precision.
    image_error: f32,
    stack: Vec<(u32, u32)>,
    /// Pairs of parts visited in all searches.
    visits: u32,
    components: [Vec<f64>; 2],
    /// The smallest gap that a ratio of the patch assumes, whichever images it was found with.
    pub(super) smallest_gap: f64,
}

impl StrainSearch {
    /// Loads a patch of these nodes, which have no triangle in common. Returns the part of each node.
    pub(super) fn load(
        &mut self,
        gaps: &CornerGaps<'_>,
        patch: &Patch,
        nodes: impl Iterator<Item = u32>,
    ) -> Vec<u32> {
        let all = gaps.hierarchy.nodes();
        self.width = 3 * patch.row_len;
        self.parts.clear();
        self.vertices.clear();
        self.vertex_starts.clear();
        self.vertex_starts.push(0);
        self.smallest_gap = f64::INFINITY;
        let mut roots = Vec::new();
        let part = |n: u32| {
            let (node, sphere) = (&all[n as usize], gaps.spheres[n as usize]);
            Part {
                node: n,
                child_count: node.child_count,
                triangle_count: node.triangle_count,
                center: sphere.center,
                radius: sphere.radius,
                ..Part::default()
            }
        };
        for root in nodes {
            let mut next = self.parts.len();
            roots.push(next as u32);
            self.parts.push(part(root));
            while next < self.parts.len() {
                self.parts[next].first_child = self.parts.len() as u32;
                let n = self.parts[next].node;
                self.parts.extend(all[n as usize].children().map(part));
                self.vertices.extend(gaps.vertices(n).iter().map(|v| patch.numbers[*v as usize]));
                self.vertex_starts.push(self.vertices.len() as u32);
                next += 1;
            }
        }
        roots
    }

    /// Computes the means and spreads of the images, whose largest norm is given.
    pub(super) fn begin(&mut self, largest_image: f64) {
        // Squares below the range of single precision are lost, too.
        self.image_error = with_mutant!((largest_image * 1.2e-7 + 1e-18) as f32, LocalImagesUnrounded, 0.0);
        let instructions = self.instructions;
        instructions.run(Means(self));
    }

    /// Returns the largest ratio of some pairs of vertices, by their numbers in the patch.
    pub(super) fn largest_ratio(&self, pairs: &[TightPair]) -> f32 {
        let mut largest = 0.0;
        for TightPair { i, j, gap } in pairs {
            self.compare(self.image(*i), *j, *gap, &mut largest);
        }
        largest
    }

    /// Returns an upper bound of the ratio of all pairs within a part, not below `floor`; infinite or NaN if none was
    /// found, or the computation was cancelled.
    pub(super) fn within(&mut self, gaps: &CornerGaps<'_>, part: u32, floor: f32) -> f32 {
        let instructions = self.instructions;
        instructions.run(Search { search: self, gaps, start: (part, part), floor })
    }

    /// Returns an upper bound of the ratio of two parts, at most [`ACCEPTED`] times `floor` if the ratio is below `floor`; infinite
    /// if the computation was cancelled.
    pub(super) fn between(&mut self, gaps: &CornerGaps<'_>, parts: (u32, u32), floor: f32) -> f32 {
        let instructions = self.instructions;
        instructions.run(Search { search: self, gaps, start: parts, floor })
    }

    /// Returns the node of a part, and its children's parts, which are None for a bucket.
    pub(super) fn node(&self, part: u32) -> (u32, Option<std::ops::Range<u32>>) {
        let Part { node, first_child, child_count, triangle_count, .. } = self.parts[part as usize];
        let is_bucket = triangle_count as usize <= BUCKET_TRIANGLES;
        (node, (!is_bucket).then_some(first_child..first_child + child_count))
    }

    #[inline(always)]
    fn image(&self, i: u32) -> &[f32] {
        &self.images[self.width * i as usize..][..self.width]
    }

    #[inline(always)]
    fn mean(&self, part: u32) -> &[f32] {
        &self.means[self.width * part as usize..][..self.width]
    }

    #[inline(always)]
    fn leaf_vertices(&self, part: u32) -> &[u32] {
        let [start, end] = [part, part + 1].map(|p| self.vertex_starts[p as usize] as usize);
        &self.vertices[start..end]
    }

    /// Raises `largest` to the ratio of two vertices, if that is larger. `x` is the image of the first one.
    #[inline(always)]
    fn compare(&self, x: &[f32], j: u32, gap: f32, largest: &mut f32) {
        let y = self.image(j);
        // NaN is compared, too, and proves nothing.
        if self.is_at_most(squared_distance(x, y), 0.0, *largest * gap) {
            return;
        }
        let ratio = (largest_singular_value(x, y) * ROUND_UP + self.image_error) / gap * ROUND_UP;
        *largest = larger(*largest, ratio);
    }

    /// Whether the sum of `more` and a distance of images, given by its computed square, is surely at most a limit.
    #[inline(always)]
    fn is_at_most(&self, square: f32, more: f32, limit: f32) -> bool {
        let share = with_mutant!(1.0 / ROUND_UP, LocalLimitsWidened, ROUND_UP);
        let left = (limit - (more + self.image_error) * ROUND_UP) * share;
        left > 0.0 && square <= left * left * (1.0 / ROUND_UP)
    }
}

/// Computes the mean image and the spread of each part, from the leaves up.
struct Means<'s>(&'s mut StrainSearch);

impl Kernel for Means<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        let Self(search) = self;
        let width = search.width;
        let mut means = std::mem::take(&mut search.means);
        means.clear();
        means.resize(width * search.parts.len(), 0.0);
        for p in (0..search.parts.len()).rev() {
            let part = search.parts[p];
            let (before, after) = means.split_at_mut(width * (p + 1));
            let mean = &mut before[width * p..];
            let mut spread = 0.0_f32;
            if part.child_count == 0 {
                let list = search.leaf_vertices(p as u32);
                let weight = 1.0 / list.len() as f32;
                list.iter().for_each(|i| add_scaled(mean, weight, search.image(*i)));
                for i in list {
                    spread = larger(spread, squared_distance(mean, search.image(*i)).sqrt());
                }
            } else {
                let children = part.first_child as usize..(part.first_child + part.child_count) as usize;
                let child_mean = |c: usize| &after[width * (c - p - 1)..][..width];
                let weight = 1.0 / part.child_count as f32;
                children.clone().for_each(|c| add_scaled(mean, weight, child_mean(c)));
                for c in children {
                    let distance = squared_distance(mean, child_mean(c)).sqrt();
                    spread = larger(spread, distance * ROUND_UP + search.parts[c].spread);
                }
            }
            search.parts[p].spread = with_mutant!(spread * ROUND_UP, LocalSpreadToNearest, spread);
        }
        search.means = means;
    }
}

struct Search<'s, 'g> {
    search: &'s mut StrainSearch,
    gaps: &'s CornerGaps<'g>,
    start: (u32, u32),
    floor: f32,
}

impl Kernel for Search<'_, '_> {
    type Output = f32;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> f32 {
        let Self { search, gaps, start, floor } = self;
        let (mut largest, mut accepted) = (floor, 0.0_f32);
        let mut stack = std::mem::take(&mut search.stack);
        let mut components = std::mem::take(&mut search.components);
        stack.clear();
        stack.push(start);
        while let Some((x, y)) = stack.pop() {
            search.visits = search.visits.wrapping_add(1);
            if search.visits.is_multiple_of(VISITS_PER_CHECK) && gaps.is_cancelled() {
                largest = f32::INFINITY;
                break;
            }
            let (a, b) = (search.parts[x as usize], search.parts[y as usize]);
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
                let distance = (b.center - a.center).length() * (1.0 - 1e-14)
                    - a.radius
                    - with_mutant!(b.radius, LocalSphereOfOne, 0.0);
                if distance > 1e-9 {
                    let difference = squared_distance(search.mean(x), search.mean(y)).sqrt();
                    let spread = with_mutant!(b.spread, LocalSpreadOfOne, 0.0);
                    let bound = (difference + a.spread + spread) * ROUND_UP + search.image_error;
                    let ratio = bound / distance as f32 * ROUND_UP;
                    if ratio <= ACCEPTED * largest {
                        accepted = with_mutant!(larger(accepted, ratio), LocalAcceptedForgotten, accepted);
                        let gap = with_mutant!(distance, LocalAcceptedGapForgotten, f64::INFINITY);
                        search.smallest_gap = search.smallest_gap.min(gap);
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
            let (x, y) = if a.node <= b.node { (x, y) } else { (y, x) };
            let leaves = (a.node.min(b.node), a.node.max(b.node));
            let range = |p: u32| {
                let [start, end] = [p, p + 1].map(|p| search.vertex_starts[p as usize] as usize);
                start..end
            };
            let (of_x, of_y) = (range(x), range(y));
            match gaps.near(leaves) {
                None => {
                    let Some(gap) = gaps.components(leaves, &mut components) else {
                        largest = f32::INFINITY;
                        break;
                    };
                    let difference = squared_distance(search.mean(x), search.mean(y)).sqrt();
                    let bound = (difference + a.spread + b.spread) * ROUND_UP + search.image_error;
                    let ratio = bound / gap as f32 * ROUND_UP;
                    search.smallest_gap = search.smallest_gap.min(gap);
                    if ratio <= ACCEPTED * largest {
                        accepted = larger(accepted, ratio);
                        continue;
                    }
                    for (u, s) in of_x.zip(&components[0]) {
                        for (v, t) in of_y.clone().zip(&components[1]) {
                            // The quotient by the gap is rounded up by 1e-4, and the gap by less than 1e-7.
                            let gap = CornerGaps::gap_between(*s, *t) as f32;
                            let gap = with_mutant!(gap.next_down(), LocalComponentsToNearest, gap);
                            search.compare(
                                search.image(search.vertices[u]),
                                search.vertices[v],
                                gap,
                                &mut largest,
                            );
                        }
                    }
                }
                Some(None) => {
                    largest = with_mutant!(f32::INFINITY, LocalTouchingFree, largest);
                    break;
                }
                Some(Some(table)) => {
                    search.smallest_gap = search.smallest_gap.min(f64::from(table.smallest));
                    let (len, mean, spread) = (of_y.len(), search.mean(y), search.parts[y as usize].spread);
                    for ((u, row), smallest) in of_x.zip(table.gaps.chunks_exact(len)).zip(&table.of_rows) {
                        let image = search.image(search.vertices[u]);
                        if search.is_at_most(squared_distance(image, mean), spread, largest * smallest) {
                            continue;
                        }
                        for (v, gap) in of_y.clone().zip(row) {
                            if *gap < f32::INFINITY {
                                search.compare(image, search.vertices[v], *gap, &mut largest);
                            }
                        }
                    }
                }
            }
        }
        search.stack = stack;
        search.components = components;
        larger(largest, accepted)
    }
}

/// Returns the larger of two numbers, and NaN if one is NaN.
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    with_mutant!(if b <= a { a } else { b + 0.0 * a }, LocalNanIgnored, a.max(b))
}

#[inline(always)]
fn add_scaled(out: &mut [f32], weight: f32, x: &[f32]) {
    out.iter_mut().zip(x).for_each(|(out, x)| *out += weight * x);
}

/// Returns `|x - y|^2`, in eight sums, so that it has the same bits in any instruction set.
#[inline(always)]
fn squared_distance(x: &[f32], y: &[f32]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    for (x, y) in x.as_chunks::<LANES>().0.iter().zip(y.as_chunks::<LANES>().0) {
        for i in 0..LANES {
            let d = x[i] - y[i];
            sums[i] += d * d;
        }
    }
    ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

/// Returns an upper bound of the largest singular value of the difference of three rows, up to the rounding of sums and at most
/// 7% above it: by the sum of the 16th powers of the eigenvalues of the Gram matrix.
#[inline(always)]
fn largest_singular_value(x: &[f32], y: &[f32]) -> f32 {
    let row_len = x.len() / 3;
    let mut sums = [[0.0_f32; LANES]; 6];
    let [x0, x1, x2] = [0, 1, 2].map(|c| x[c * row_len..][..row_len].as_chunks::<LANES>().0);
    let [y0, y1, y2] = [0, 1, 2].map(|c| y[c * row_len..][..row_len].as_chunks::<LANES>().0);
    for k in 0..x0.len() {
        for i in 0..LANES {
            let [a, b, c] = [y0[k][i] - x0[k][i], y1[k][i] - x1[k][i], y2[k][i] - x2[k][i]];
            sums[0][i] += a * a;
            sums[1][i] += b * b;
            sums[2][i] += c * c;
            sums[3][i] += a * b;
            sums[4][i] += a * c;
            sums[5][i] += b * c;
        }
    }
    let [xx, yy, zz, xy, xz, yz] = sums.map(|lanes| lanes.iter().map(|x| f64::from(*x)).sum::<f64>());
    // The longest of three rows may be shorter than the singular value by a factor of up to the root of three.
    let trace = with_mutant!(xx + yy + zz, LocalRowsAlone, return (xx.max(yy).max(zz)).sqrt() as f32);
    if trace.is_nan() || trace <= 0.0 {
        return if trace == 0.0 { 0.0 } else { f32::INFINITY };
    }
    let mut power = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| row.map(|x| x / trace));
    for _ in 0..3 {
        power =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| power[i][k] * power[k][j]).sum()));
    }
    // The trace of the 16th power.
    let sum: f64 = power.iter().flatten().map(|x| x * x).sum();
    // The rounding of a Gram matrix in single precision is relative to its trace.
    ((sum.sqrt().sqrt().sqrt().sqrt() + 1e-5) * trace).sqrt() as f32
}

#[cfg(test)]
mod tests;
