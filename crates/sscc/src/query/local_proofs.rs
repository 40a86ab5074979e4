//! Which local certificates hold at the configurations of a search.
//!
//! A search goes down from the root before its traversal, and stops at the nodes whose certificate holds: these are *proven*.
//! Then the traversal asks whether a node is proven, and whether the pairs of two nodes are.

use glam::{DMat3, DVec3};

use super::region_rates::RegionRates;
use super::smallest_stretch::{smallest_stretch, stretches_between};
use crate::Metric;
use crate::certificates::{
    EllipsoidBlocks, FactorScales, GRADIENT, LocalCertificates, MOST_MODES, gradient_len,
};
use crate::detect::vertex_motion::{VertexMotion, rounding_bound};
use crate::hierarchy::{Hierarchy, NodePair};
use crate::vectors::{InstructionSet, Kernel, LANES, Vectors};

/// The root of three, rounded up: errors are along each axis, gaps along any direction.
const DIAGONAL: f64 = 1.7321;

/// Rounds a sum of a handful of non-negative numbers up.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// A search stops evaluating certificates from the root down once it has evaluated more than [`MOST_LOST`], one for so many
/// buckets, and one for each proven bucket. Only the time of queries depends on that.
const BUCKETS_OF_EVALUATION: usize = 16;

/// Certificates that a search may evaluate in vain. It evaluates those of buckets for pairs of buckets until so many more
/// proved nothing than proved their pair.
const MOST_LOST: usize = 32;

/// Certificates are asked about pairs of nodes if they prove at least one of so many buckets.
const LEAST_SHARE: usize = 5;

/// Work of a search, in visits of nodes and packets of AABBs, after which it finds proven nodes. Finding them takes about twice as long.
const WORK_BEFORE: u64 = 192;

/// No certificate.
const NONE: u32 = u32::MAX;

/// Local certificates, and where those of a node are.
#[derive(Clone)]
pub(super) struct LocalTables<'a> {
    certificates: &'a LocalCertificates,
    center: &'a [f64],
    scales: FactorScales,
    /// For each node its certificate; [`NONE`] for none.
    of_node: Vec<u32>,
    /// For each certificate where its gradients and its ellipsoid start, in vectors.
    starts: Vec<[u32; 2]>,
    /// For proofs in regions; none where there are none.
    rates: Option<RegionRates>,
    /// For each certificate the [bits](list_bit) of the nodes of its list: most nodes are on none.
    list_bits: Vec<u64>,
    /// For each node its buckets, as a range of positions in the order of triangles.
    buckets: Vec<std::ops::Range<u32>>,
}

impl<'a> LocalTables<'a> {
    /// None where there are no certificates.
    pub(super) fn new(
        certificates: &'a LocalCertificates,
        hierarchy: &Hierarchy,
        center: &'a [f64],
        scales: FactorScales,
    ) -> Option<Self> {
        if certificates.nodes.is_empty() {
            return None;
        }
        let mut of_node = vec![NONE; hierarchy.nodes().len()];
        certificates.nodes.iter().enumerate().for_each(|(i, n)| of_node[*n as usize] = i as u32);
        let mut starts = Vec::new();
        let (mut gradient, mut ellipsoid) = (0, 0);
        for range in certificates.mode_starts.windows(2) {
            starts.push([gradient, ellipsoid]);
            let count = (range[1] - range[0]) as usize;
            gradient += (gradient_len(count) / LANES) as u32;
            ellipsoid += (EllipsoidBlocks(count).len() / LANES) as u32;
        }
        let bits = |range: &[u32]| {
            let list = &certificates.list_nodes[range[0] as usize..range[1] as usize];
            list.iter().fold(0, |bits, node| bits | list_bit(*node))
        };
        let list_bits = certificates.list_starts.windows(2).map(bits).collect();
        let buckets = bucket_ranges(hierarchy);
        Some(Self { certificates, center, scales, of_node, starts, rates: None, list_bits, buckets })
    }

    /// Adds what proofs in regions need. A dense metric has none: its factor may be nearly singular.
    pub(super) fn add_region_rates(&mut self, metric: &Metric) {
        let rates = || RegionRates::new(self.certificates, &self.scales, &metric.scales());
        self.rates = metric.dense_factor().is_none().then(rates);
    }

    #[inline]
    fn certificate_of(&self, node: u32) -> Option<usize> {
        let index = self.of_node[node as usize];
        (index != NONE).then_some(index as usize)
    }

    /// The ratio of the pairs of a certificate's node with another one.
    #[inline]
    fn ratio_with(&self, certificate: usize, node: u32) -> Option<f32> {
        if self.list_bits[certificate] & list_bit(node) == 0 {
            return None;
        }
        let LocalCertificates { list_starts, list_nodes, list_ratios, .. } = self.certificates;
        let [start, end] = [certificate, certificate + 1].map(|i| list_starts[i] as usize);
        let at = list_nodes[start..end].binary_search(&node).ok()?;
        Some(list_ratios[start + at])
    }
}

/// One of 64 bits for each node. Multiplied by an odd number, numbers that follow each other have other upper bits (Knuth).
#[inline]
fn list_bit(node: u32) -> u64 {
    1 << (node.wrapping_mul(0x9e37_79b9) >> 26)
}

/// For each node the positions of its buckets in the order of triangles; for a node within a bucket that of the bucket.
fn bucket_ranges(hierarchy: &Hierarchy) -> Vec<std::ops::Range<u32>> {
    let nodes = hierarchy.nodes();
    let within = hierarchy.nodes_within_buckets();
    let mut first: Vec<u32> = (0..nodes.len())
        .filter(|n| !within[*n] && nodes[*n].fits_in_bucket())
        .map(|n| nodes[n].first_triangle)
        .collect();
    first.sort_unstable();
    let position = |triangle: u32| first.partition_point(|start| *start <= triangle) as u32;
    let range = |n: &crate::hierarchy::Node| {
        position(n.first_triangle) - 1..position(n.first_triangle + n.triangle_count - 1)
    };
    nodes.iter().map(range).collect()
}

/// The local certificates that hold in one search.
#[derive(Clone)]
pub(super) struct LocalProofs<const E: usize> {
    instructions: InstructionSet,
    search: u32,
    /// For each certificate the search in which it was evaluated last, and the ratios that it allowed: those below this.
    allowed: Vec<(u32, f32)>,
    /// For each bucket, by its position, the search in which it was proven last, and by which node.
    proven: Vec<(u32, u32)>,
    stack: Vec<u32>,
    /// The factors of the modes at each configuration, in single precision, padded with zeros.
    factors: [Vec<f32>; E],
    /// `T` at each configuration, rounded up.
    sums: [f64; E],
    /// The radius of the region in z around the segment between the configurations.
    radius: f64,
    /// `eta`
    error: f64,
    is_usable: bool,
    /// Whether this search finds no more proven nodes.
    is_complete: bool,
    /// How many certificates the search evaluated from the root down, and how many buckets they proved.
    evaluated: usize,
    proven_buckets: usize,
    /// How many pairs of buckets were tried by certificates of their own: with a proof, and without.
    won: usize,
    lost: usize,
}

impl<const E: usize> LocalProofs<E> {
    pub(super) fn new(tables: &LocalTables<'_>) -> Self {
        Self {
            instructions: InstructionSet::default(),
            // None of the marks below is of this search.
            search: 1,
            allowed: vec![(0, 0.0); tables.certificates.nodes.len()],
            proven: vec![(0, 0); tables.buckets[0].end as usize],
            stack: Vec::new(),
            factors: [const { Vec::new() }; E],
            sums: [0.0; E],
            radius: 0.0,
            error: f64::INFINITY,
            is_usable: false,
            is_complete: false,
            evaluated: 0,
            proven_buckets: 0,
            won: 0,
            lost: 0,
        }
    }

    /// Whether the certificate of the root proves it.
    pub(super) fn prove_root(&mut self, tables: &LocalTables<'_>) -> bool {
        let Some(index) = tables.certificate_of(0) else { return false };
        tables.certificates.bounds[index].ratio < f64::from(self.allowed(tables, index))
    }

    /// Whether a search that has done so much work, in visits of nodes and packets of AABBs, should find proven nodes now. Short searches
    /// end before it would pay.
    #[inline]
    pub(super) fn is_due(&self, work: u64) -> bool {
        self.is_usable && !self.is_complete && work > WORK_BEFORE
    }

    /// Finds, from the root down, the largest nodes that are proven, among those whose radius is reached at a norm, once in a search. Where few buckets are proven in the end, the certificates are asked no more: pairs of the others
    /// are seldom proven, and asking for each takes longer.
    pub(super) fn prove(
        &mut self,
        tables: &LocalTables<'_>,
        hierarchy: &Hierarchy,
        node_radii: &[f64],
        norm: f64,
    ) {
        let is_open = |n: u32| node_radii[n as usize] <= norm;
        if !self.is_usable || self.is_complete {
            return;
        }
        while let Some(n) = self.stack.pop() {
            if self.evaluated > MOST_LOST + self.proven.len() / BUCKETS_OF_EVALUATION + self.proven_buckets {
                break;
            }
            if let Some(index) = tables.certificate_of(n) {
                self.evaluated += 1;
                let allowed = self.allowed(tables, index);
                if tables.certificates.bounds[index].ratio < f64::from(allowed) {
                    let range = &tables.buckets[n as usize];
                    self.proven[range.start as usize..range.end as usize].fill((self.search, n));
                    self.proven_buckets += range.len();
                    continue;
                }
            }
            let node = &hierarchy.nodes()[n as usize];
            if !node.fits_in_bucket() {
                self.stack.extend(node.children().filter(|child| is_open(*child)));
            }
        }
        self.is_complete = true;
        self.is_usable = self.proven_buckets * LEAST_SHARE >= self.proven.len();
    }

    /// The pairs of nodes that one certificate proves free during a motion, in a search of its own: its node with itself, and with
    /// nodes of its list.
    pub(super) fn claims<M: VertexMotion<E>>(
        &mut self,
        tables: &LocalTables<'_>,
        motion: &M,
        index: usize,
    ) -> Vec<NodePair> {
        if !self.begin(tables, motion) {
            return Vec::new();
        }
        let allowed = self.allowed(tables, index);
        let LocalCertificates { nodes, bounds, list_starts, list_nodes, list_ratios, .. } =
            tables.certificates;
        let range = list_starts[index] as usize..list_starts[index + 1] as usize;
        let own = (bounds[index].ratio < f64::from(allowed)).then_some(nodes[index]);
        let of_list = list_nodes[range.clone()].iter().zip(&list_ratios[range]);
        let others = of_list.filter(|(_, ratio)| **ratio < allowed).map(|(m, _)| *m);
        own.into_iter().chain(others).map(|m| (nodes[index], m)).collect()
    }

    /// Begins a new search: forgets what the last one proved. False where certificates prove nothing about the motion.
    pub(super) fn begin<M: VertexMotion<E>>(&mut self, tables: &LocalTables<'_>, motion: &M) -> bool {
        self.search = right_or!(self.search.wrapping_add(1), LocalProofsKept, self.search);
        if self.search == 0 {
            self.proven.fill((0, 0));
            self.allowed.fill((0, 0.0));
            self.search = 1;
        }
        (self.evaluated, self.proven_buckets, self.won, self.lost) = (0, 0, 0, 0);
        self.is_complete = false;
        self.stack.clear();
        self.stack.push(0);
        self.is_usable = self.begin_motion(tables, motion);
        self.is_usable
    }

    /// Whether most buckets are proven by no certificate.
    pub(super) fn is_mostly_open(&self) -> bool {
        self.proven_buckets * 10 < 6 * self.proven.len()
    }

    /// Whether no two triangles of a node collide.
    #[inline]
    pub(super) fn is_node_proven(&self, tables: &LocalTables<'_>, n: u32) -> bool {
        self.proven_node(tables, n).is_some()
    }

    /// The node whose certificate proves a node.
    #[inline]
    fn proven_node(&self, tables: &LocalTables<'_>, n: u32) -> Option<u32> {
        let range = &tables.buckets[n as usize];
        let (search, by) = self.proven[range.start as usize];
        let is_within = tables.buckets[by as usize].end >= range.end;
        (search == self.search && right_or!(is_within, LocalProofOfOnePart, true)).then_some(by)
    }

    /// Whether no triangle of one node collides with one of the other, by the certificate of one of them or of a proven node
    /// around it.
    #[inline]
    pub(super) fn is_pair_proven(
        &mut self,
        tables: &LocalTables<'_>,
        (n, m): (u32, u32),
        is_last: bool,
    ) -> bool {
        if !(self.is_usable && self.is_complete) {
            return false;
        }
        // A certificate proves nothing about two nodes of its list.
        let of_one_list = right_or!(
            false,
            LocalRingWithRing,
            (0..tables.certificates.nodes.len()).any(|index| {
                let allowed = self.allowed(tables, index);
                [n, m].iter().all(|n| tables.ratio_with(index, *n).is_some_and(|ratio| ratio < allowed))
            })
        );
        if of_one_list {
            return true;
        }
        for (n, m) in [(n, m), (m, n)] {
            let by = self.proven_node(tables, n).unwrap_or(n);
            if let Some(index) = tables.certificate_of(by)
                && let Some(ratio) = tables.ratio_with(index, m)
                && ratio < self.allowed(tables, index)
            {
                return true;
            }
        }
        if is_last && self.lost < MOST_LOST + self.won {
            for (n, m) in [(n, m), (m, n)] {
                if let Some(index) = tables.certificate_of(n)
                    && let Some(ratio) = tables.ratio_with(index, m)
                    && ratio < self.allowed(tables, index)
                {
                    self.won += 1;
                    return true;
                }
            }
            self.lost += 1;
        }
        false
    }

    /// Sets the factors. False where the positions of the motion are not those of the modes alone.
    fn begin_motion<M: VertexMotion<E>>(&mut self, tables: &LocalTables<'_>, motion: &M) -> bool {
        let (Some(coordinates), Some(radius)) = (motion.coarse_coordinates(), motion.region_radius()) else {
            return false;
        };
        self.radius = right_or!(radius, LocalProofsInRegions, 0.0);
        if right_or!(self.radius > 0.0 && tables.rates.is_none(), LocalRegionUnknown, false) {
            return false;
        }
        let FactorScales { sizes, scale, reach } = &tables.scales;
        for (end, q) in coordinates.into_iter().enumerate() {
            let all = &mut self.factors[end];
            all.clear();
            let mut sum = 0.0;
            all.extend(q.iter().zip(tables.center).zip(sizes).map(|((q, c), size)| {
                let factor = (q - c) * size;
                sum += factor.abs();
                factor as f32
            }));
            all.resize(all.len().next_multiple_of(LANES), 0.0);
            self.sums[end] = sum * ROUND_UP;
        }
        let rounding = motion.rounding() + rounding_bound(*reach, sizes.len());
        let error = 2.0 * DIAGONAL * ROUND_UP * rounding * scale + 64.0 * f64::EPSILON;
        self.error = right_or!(error, LocalPositionsExact, 0.0, LocalErrorAlongAxes, error / DIAGONAL);
        self.error.is_finite() && self.sums.iter().all(|sum| *sum < 1e30)
    }

    /// The ratios that a certificate allows: those below this.
    #[inline]
    fn allowed(&mut self, tables: &LocalTables<'_>, index: usize) -> f32 {
        let (search, allowed) = self.allowed[index];
        if search == self.search {
            return allowed;
        }
        let allowed = (self.evaluate(tables, index) as f32).next_down();
        self.allowed[index] = (self.search, allowed);
        allowed
    }

    fn evaluate(&self, tables: &LocalTables<'_>, index: usize) -> f64 {
        let all = tables.certificates;
        let bounds = &all.bounds[index];
        let [start, end] = [index, index + 1].map(|i| all.mode_starts[i] as usize);
        let modes = &all.modes[start..end];
        let [gradient, ellipsoid] = tables.starts[index].map(|start| start as usize);
        let gradients = &all.gradients.as_chunks().0[gradient..][..gradient_len(modes.len()) / LANES];
        let ellipsoid =
            &all.ellipsoids.as_chunks().0[ellipsoid..][..EllipsoidBlocks(modes.len()).len() / LANES];
        let is_dense = modes.len() == tables.center.len();
        // What the numbers may change within the radius.
        let [more_sum, more_map, more_strain] = match &tables.rates {
            Some(rates) if self.radius > 0.0 => {
                let of_certificate = rates.certificates[index];
                [
                    right_or!(rates.sum, LocalRegionSumStill, 0.0),
                    right_or!(of_certificate.map, LocalRegionMapStill, 0.0),
                    right_or!(of_certificate.strain, LocalRegionStrainStill, 0.0),
                ]
                .map(|rate| rate * self.radius)
            }
            _ => [0.0; 3],
        };
        // The error of sums of products in single precision, and of the factors.
        let single = 2.0 * (modes.len() as f64 + 4.0) * f64::from(f32::EPSILON);
        let at = |end: usize| {
            let (mut gathered, mut sum) = ([0.0_f32; MOST_MODES], self.sums[end]);
            let factors = if is_dense {
                &*self.factors[end]
            } else {
                let mut local = 0.0;
                for (g, k) in gathered.iter_mut().zip(modes) {
                    *g = self.factors[end][*k as usize];
                    local += f64::from(g.abs());
                }
                sum = sum.min(local * (1.0 + 1e-6) + 1e-30);
                &gathered[..modes.len().next_multiple_of(LANES)]
            };
            sum += more_sum;
            let (gradient, strain) =
                self.instructions.run(Sums { gradients, ellipsoid, factors, count: modes.len() });
            let rounding = right_or!(single * bounds.widest * sum, LocalStrainExact, 0.0);
            let strain = strain + rounding + more_strain + 1e-30;
            let error = bounds.per_factor * sum
                + bounds.per_error * self.error
                + right_or!(single * bounds.steepest * sum, LocalMapExact, 0.0)
                + more_map
                + 1e-30;
            (DMat3::IDENTITY + gradient, strain * ROUND_UP, error * ROUND_UP)
        };
        let ends: [(DMat3, f64, f64); E] = std::array::from_fn(at);
        let allowed = |stretches: [f64; E], lost: [f64; E]| {
            let each = ends.iter().zip(stretches).zip(lost).map(|(((_, strain, error), stretch), lost)| {
                (stretch - error - lost) / strain * (1.0 - 1e-12)
            });
            each.fold(f64::INFINITY, smaller)
        };
        let maps = ends.map(|(map, _, _)| map);
        let plain = allowed(stretches_of(&maps), [0.0; E]);
        if bounds.flatness == f64::INFINITY {
            return plain;
        }
        // The error of the map is one of its part across, too, and the new map is rounded.
        let (maps, turned) = flat_maps(&maps, DVec3::from_array(bounds.across));
        let lost =
            std::array::from_fn(|end| (bounds.flatness + 1e-14) * (turned[end] + ends[end].2) * ROUND_UP);
        let flat = allowed(stretches_of(&maps), right_or!(lost, LocalPlaneTurnsAlong, [0.0; E]));
        // NaN allows nothing.
        if flat > plain { flat } else { plain }
    }
}

/// The stretches of maps, as [`stretches_between`].
fn stretches_of<const E: usize>(maps: &[DMat3; E]) -> [f64; E] {
    if E == 1 { maps.map(|map| smallest_stretch(&map)) } else { stretches_between(maps) }
}

/// Maps of a flat patch with another image of the direction across it: the same for all, a unit vector across the image of the plane by
/// their mean. Also how far that is from their own images of the direction.
fn flat_maps<const E: usize>(maps: &[DMat3; E], across: DVec3) -> ([DMat3; E], [f64; E]) {
    let mean = maps.iter().fold(DMat3::ZERO, |sum, map| sum + *map);
    let (x, y) = across.any_orthonormal_pair();
    let image = (mean * x).cross(mean * y).normalize_or_zero();
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let turned = maps.map(|map| (map * across - image).length());
    (maps.map(|map| map + outer(image - map * across, across)), turned)
}

/// The smaller of two numbers, and NaN where one is NaN: it allows nothing.
fn smaller(a: f64, b: f64) -> f64 {
    right_or!(if a < b || a.is_nan() { a } else { b }, LocalSweptNanIgnored, a.min(b))
}

/// Vectors of the longest column of W.
const MOST_VECTORS: usize = MOST_MODES.div_ceil(LANES);

/// `G f`, and the norm of `W f` as computed, for the numbers of one certificate.
struct Sums<'c> {
    gradients: &'c [[f32; LANES]],
    ellipsoid: &'c [[u16; LANES]],
    factors: &'c [f32],
    count: usize,
}

impl Kernel for Sums<'_> {
    type Output = (DMat3, f64);

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> Self::Output {
        let Self { gradients, ellipsoid, factors, count } = self;
        let (columns, last) = gradients.split_at(count);
        let mut gradient = [vectors.splat(0.0); 2];
        for (k, (column, factor)) in columns.iter().zip(factors).enumerate() {
            gradient[k & 1] =
                vectors.multiply_add(vectors.load(column), vectors.splat(*factor), gradient[k & 1]);
        }
        let mut ninth = vectors.splat(0.0);
        for (row, factors) in last.iter().zip(factors.as_chunks().0) {
            ninth = vectors.multiply_add(vectors.load(row), vectors.load(factors), ninth);
        }
        let mut image = [[0.0_f32; LANES]; MOST_VECTORS];
        let mut blocks = ellipsoid;
        for (first, image) in (0..count).step_by(LANES).zip(&mut image) {
            let (rows, rest) = blocks.split_at(count - first);
            blocks = rest;
            let mut sums = [vectors.splat(0.0); 2];
            for (i, (column, factor)) in rows.iter().zip(&factors[first..]).enumerate() {
                let column = vectors.load_upper_halves(column);
                sums[i & 1] = vectors.multiply_add(column, vectors.splat(*factor), sums[i & 1]);
            }
            let one = vectors.splat(1.0);
            *image = vectors.array(vectors.multiply_add(sums[0], one, sums[1]));
        }
        let [even, odd] = gradient.map(|sum| vectors.array(sum));
        let entry = |e: usize| f64::from(even[e]) + f64::from(odd[e]);
        let ninth = vectors.array(ninth).iter().map(|x| f64::from(*x)).sum();
        let map = DMat3::from_cols(
            DVec3::new(entry(0), entry(1), entry(2)),
            DVec3::new(entry(3), entry(4), entry(5)),
            DVec3::new(entry(6), entry(7), ninth),
        );
        let used = &image[..count.div_ceil(LANES)];
        let square: f64 = used.as_flattened().iter().map(|x| f64::from(*x) * f64::from(*x)).sum();
        (map, square.sqrt() * ROUND_UP)
    }
}

const _: () = assert!(GRADIENT == LANES + 1);

#[cfg(test)]
mod tests;
