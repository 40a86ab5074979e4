//! Patches: a node with the buckets around it that share a vertex with it, and the certificate of one.

use glam::DVec3;

use super::gap_tables::GapTables;
use super::local_certificates::{GRADIENT, LANES, LocalBounds, LocalCertificate, UnitModel};
use super::residual_ellipsoid::ResidualEllipsoid;
use super::strain_bound::{HotPairs, StrainBound, StrainSearch};
use crate::bounds::AffineFit;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// Rounds in which the ellipsoid is fitted to the pairs that decided the one before.
const ROUNDS: usize = 2;

/// Certificates beyond these numbers prove nothing.
const LARGEST: f64 = 1e12;

/// What all patches of a model have in common.
pub(super) struct PatchBuilder<'t> {
    pub(super) unit: &'t UnitModel,
    pub(super) hierarchy: &'t Hierarchy,
    pub(super) filter: &'t PairFilter,
    /// For each vertex class where its buckets start, and the end.
    class_starts: Vec<u32>,
    class_buckets: Vec<u32>,
    pub(super) gaps: GapTables,
}

/// Memory of one thread.
pub(super) struct Scratch {
    instructions: InstructionSet,
    fit: AffineFit,
    /// For each vertex its number in the patch.
    pub(super) numbers: Vec<u32>,
    vertices: Vec<u32>,
    offsets: Vec<DVec3>,
    /// The gradient, in single precision.
    gradient: Vec<f64>,
    /// For each vertex of the patch three rows: its residual, then its image under the ellipsoid.
    residuals: Vec<f64>,
    images: Vec<f64>,
    search: StrainSearch,
}

impl<'t> PatchBuilder<'t> {
    pub(super) fn new(unit: &'t UnitModel, hierarchy: &'t Hierarchy, filter: &'t PairFilter) -> Self {
        let within = hierarchy.nodes_within_buckets();
        let is_bucket = |n: &u32| !within[*n as usize] && hierarchy.nodes()[*n as usize].fits_in_bucket();
        let buckets: Vec<u32> = (0..within.len() as u32).filter(is_bucket).collect();
        let mut of_classes: Vec<(u32, u32)> = Vec::new();
        for &bucket in &buckets {
            let triangles = hierarchy.triangles(&hierarchy.nodes()[bucket as usize]);
            of_classes.extend(
                triangles.iter().flat_map(|&t| filter.vertex_classes(t)).map(|class| (class, bucket)),
            );
        }
        of_classes.sort_unstable();
        of_classes.dedup();
        let mut class_starts = vec![0; filter.class_count() + 1];
        for (class, _) in &of_classes {
            class_starts[*class as usize + 1] += 1;
        }
        for class in 0..filter.class_count() {
            class_starts[class + 1] += class_starts[class];
        }
        let class_buckets = of_classes.into_iter().map(|(_, bucket)| bucket).collect();
        let gaps = GapTables::new(unit, hierarchy, filter);
        Self { unit, hierarchy, filter, class_starts, class_buckets, gaps }
    }

    pub(super) fn scratch(&self) -> Scratch {
        Scratch {
            instructions: InstructionSet::default(),
            fit: AffineFit::new(self.unit.row_len),
            numbers: vec![u32::MAX; self.unit.positions.len()],
            vertices: Vec::new(),
            offsets: Vec::new(),
            gradient: Vec::new(),
            residuals: Vec::new(),
            images: Vec::new(),
            search: StrainSearch::new(self.hierarchy.nodes().len()),
        }
    }

    /// The ring of a node: the buckets outside of it that share a vertex class with it, ascending.
    pub(super) fn ring(&self, n: u32) -> Vec<u32> {
        let nodes = self.hierarchy.nodes();
        let node = &nodes[n as usize];
        let own = node.first_triangle..node.first_triangle + node.triangle_count;
        let classes = self.hierarchy.triangles(node).iter().flat_map(|&t| self.filter.vertex_classes(t));
        let mut ring: Vec<u32> = classes
            .flat_map(|class| {
                let [start, end] = [class, class + 1].map(|class| self.class_starts[class as usize] as usize);
                self.class_buckets[start..end].iter().copied()
            })
            .filter(|bucket| !own.contains(&nodes[*bucket as usize].first_triangle))
            .collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    /// The certificate of a node's patch; none where none would prove anything.
    pub(super) fn certify(&self, n: u32, scratch: &mut Scratch) -> Option<LocalCertificate> {
        let ring = self.ring(n);
        let parts = || std::iter::once(n).chain(ring.iter().copied());
        scratch.vertices.clear();
        for part in parts() {
            for &t in self.hierarchy.triangles(&self.hierarchy.nodes()[part as usize]) {
                for v in self.filter.faces()[t as usize] {
                    if scratch.numbers[v as usize] == u32::MAX {
                        scratch.numbers[v as usize] = scratch.vertices.len() as u32;
                        scratch.vertices.push(v);
                    }
                }
            }
        }
        let certificate = self.certify_vertices(n, &ring, scratch);
        scratch.vertices.iter().for_each(|v| scratch.numbers[*v as usize] = u32::MAX);
        certificate
    }

    fn certify_vertices(&self, n: u32, ring: &[u32], scratch: &mut Scratch) -> Option<LocalCertificate> {
        let UnitModel { rank, row_len, positions, .. } = self.unit;
        let (rank, row_len) = (*rank, *row_len);
        let Scratch { instructions, fit, numbers, vertices, offsets, gradient, residuals, images, search } =
            scratch;
        let first = positions[vertices[0] as usize];
        offsets.clear();
        offsets.extend(vertices.iter().map(|v| positions[*v as usize] - first));
        gradient.clear();
        gradient.resize(9 * row_len, 0.0);
        if fit.fit(offsets, |i| self.unit.modes(vertices[i])) {
            // As it is stored.
            gradient.iter_mut().zip(fit.gradient()).for_each(|(g, x)| *g = f64::from(*x as f32));
        }
        let steepest = (0..rank)
            .map(|k| (0..9).map(|e| gradient[e * row_len + k].powi(2)).sum::<f64>())
            .fold(0.0, f64::max);
        let steepest = steepest.sqrt() * (1.0 + 1e-12);
        let longest = offsets.iter().map(|d| d.length()).fold(0.0, f64::max);
        instructions.run(Residuals { unit: self.unit, vertices, offsets, gradient, residuals });
        search.load(self, n, ring, vertices, numbers);
        let mut hot = HotPairs::default();
        let mut blocks = search.first_blocks(residuals, offsets, row_len);
        let mut found = None;
        for round in 0..=ROUNDS {
            let ellipsoid = ResidualEllipsoid::around(&blocks, rank, row_len)?;
            images.clone_from(residuals);
            instructions.run(Divide { ellipsoid: &ellipsoid, images });
            hot.clear();
            let bound = search.run(self, &*instructions, images, numbers, row_len, &mut hot)?;
            if round < ROUNDS {
                hot.add_blocks(&mut blocks, residuals, row_len);
            }
            found = Some((ellipsoid, bound));
        }
        let (ellipsoid, StrainBound { residual, smallest_gap, largest_image }) = found?;
        let per_error = (1.0 + 1e-12) / smallest_gap;
        let widest = ellipsoid.largest_column();
        // `local_certificates.rs` names the terms: the error of residuals, that of substitution, then those of single precision.
        let unit = f64::EPSILON / 2.0;
        let of_residuals = 64.0 * unit * (2.0 + steepest * longest) * per_error;
        let of_images = 4.0 * (rank as f64 + 4.0) * unit * largest_image * widest * per_error;
        let single = 2.0 * (rank as f64 + 4.0) * f64::from(f32::EPSILON);
        let residual = residual * (1.0 + 1e-9) + 32.0 * unit * largest_image * per_error;
        let per_factor = of_residuals + of_images + single * (steepest + residual * widest);
        let is_useful = [residual, per_factor, per_error, steepest].iter().all(|x| *x < LARGEST);
        is_useful.then(|| LocalCertificate {
            columns: columns(rank, row_len, gradient, &ellipsoid),
            bounds: LocalBounds { residual, per_factor, per_error },
        })
    }
}

/// For each mode the gradient, column by column, then W down to the diagonal.
fn columns(
    rank: usize,
    row_len: usize,
    gradient: &[f64],
    ellipsoid: &ResidualEllipsoid,
) -> Vec<[f32; LANES]> {
    let mut columns = Vec::new();
    for k in 0..rank {
        // The rows are `G_cj` at 3 c + j.
        let gradient = (0..GRADIENT).map(|e| gradient[(3 * (e % 3) + e / 3) * row_len + k]);
        let column: Vec<f32> =
            gradient.chain((0..=k).map(|i| ellipsoid.entry(i, k))).map(|x| x as f32).collect();
        columns.extend(column.chunks(LANES).map(|part| {
            let mut lanes = [0.0; LANES];
            lanes[..part.len()].copy_from_slice(part);
            lanes
        }));
    }
    columns
}

/// The residuals of all vertices.
struct Residuals<'r> {
    unit: &'r UnitModel,
    vertices: &'r [u32],
    offsets: &'r [DVec3],
    gradient: &'r [f64],
    residuals: &'r mut Vec<f64>,
}

impl Kernel for Residuals<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        let Self { unit, vertices, offsets, gradient, residuals } = self;
        let row_len = unit.row_len;
        residuals.clear();
        residuals.resize(3 * row_len * vertices.len(), 0.0);
        let first = unit.modes(vertices[0]);
        for ((v, d), rows) in vertices.iter().zip(offsets).zip(residuals.chunks_exact_mut(3 * row_len)) {
            let modes = unit.modes(*v);
            for c in 0..3 {
                let row = c * row_len..(c + 1) * row_len;
                let g: [&[f64]; 3] = std::array::from_fn(|j| &gradient[(3 * c + j) * row_len..][..row_len]);
                let terms =
                    modes[row.clone()].iter().zip(&first[row.clone()]).zip(g[0].iter().zip(g[1]).zip(g[2]));
                for (e, ((u, first), ((x, y), z))) in rows[row].iter_mut().zip(terms) {
                    *e = (u - first) - (d.x * x + d.y * y + d.z * z);
                }
            }
        }
    }
}

/// The images of all residuals under the ellipsoid.
struct Divide<'d> {
    ellipsoid: &'d ResidualEllipsoid,
    images: &'d mut [f64],
}

impl Kernel for Divide<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        self.ellipsoid.divide(self.images);
    }
}
