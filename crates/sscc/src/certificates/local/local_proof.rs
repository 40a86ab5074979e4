//! Which local certificates hold at the configuration of a search; each is evaluated at most once.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::local_certificates::{GRADIENT, LANES, LocalBounds, LocalCertificates, MAX_RANK};
use crate::detect::vertex_motion::{VertexMotion, rounding_bound};
use crate::hierarchy::Hierarchy;
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// Vectors in the longest column.
const MAX_VECTORS: usize = (GRADIENT + MAX_RANK).div_ceil(LANES);

/// The root of three, rounded up: errors are along each axis, gaps along any direction.
const DIAGONAL: f64 = 1.7321;

/// Rounds a sum of a handful of non-negative numbers up.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// The local certificates that hold in one search.
#[derive(Clone)]
pub(crate) struct LocalProofs<const E: usize> {
    instructions: InstructionSet,
    search: u32,
    /// For each certificate the search in which it held last.
    nodes: Vec<u32>,
    /// For each bucket, by its position, the search in which it was proven last.
    proven: Vec<(u32, u32)>,
    stack: Vec<u32>,
    pub(crate) evaluated: u64,
    pub(crate) unproven_buckets: u32,
    /// The factors of the modes at each configuration, in single precision.
    factors: [Vec<f32>; E],
    /// `T` at each configuration, rounded up.
    sums: [f64; E],
    /// `eta`
    error: f64,
}

impl<const E: usize> LocalProofs<E> {
    pub(crate) fn new(certificates: &LocalCertificates) -> Self {
        Self {
            instructions: InstructionSet::default(),
            search: 0,
            nodes: vec![0; certificates.count()],
            proven: vec![(0, 0); certificates.buckets[0].end as usize],
            stack: Vec::new(),
            evaluated: 0,
            unproven_buckets: 0,
            factors: [const { Vec::new() }; E],
            sums: [0.0; E],
            error: f64::INFINITY,
        }
    }

    /// Starts a new search: finds from the root down the largest nodes whose certificate holds, among those whose radius is
    /// reached (`is_open`). False where no local certificate was of use.
    pub(crate) fn prove<M: VertexMotion<E>>(
        &mut self,
        certificates: &LocalCertificates,
        hierarchy: &Hierarchy,
        motion: &M,
        is_open: impl Fn(u32) -> bool,
    ) {
        self.search = self.search.wrapping_add(1);
        if self.search == 0 {
            self.proven.fill((0, 0));
            self.nodes.fill(0);
            self.search = 1;
        }
        self.evaluated = 0;
        self.unproven_buckets = 0;
        if !self.begin_motion(certificates, motion) {
            self.unproven_buckets = u32::MAX;
            return;
        }
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        stack.push(0);
        while let Some(n) = stack.pop() {
            if motion.coarse_slack(n).is_none()
                && let Some(index) = certificates.index_of(n)
            {
                self.evaluated += 1;
                if self.evaluate(certificates, index) {
                    let Range { start, end } = certificates.buckets[n as usize];
                    self.nodes[index] = self.search;
                    self.proven[start as usize..end as usize].fill((self.search, n));
                    continue;
                }
            }
            let node = &hierarchy.nodes()[n as usize];
            if node.fits_in_bucket() {
                self.unproven_buckets += 1;
            } else {
                stack.extend(node.children().filter(|child| is_open(*child)));
            }
        }
        self.stack = stack;
            eprintln!(
                "prove {:.1} us evaluated {} unproven {} of {}",
                start.elapsed().as_secs_f64() * 1e6,
                self.evaluated,
                self.unproven_buckets,
                self.proven.len()
            );
        }
    }

    /// Whether a node's own certificate holds. Nodes below it were not evaluated.
    #[inline]
    pub(crate) fn is_node_proven(&self, certificates: &LocalCertificates, n: u32) -> bool {
        certificates.index_of(n).is_some_and(|index| self.nodes[index] == self.search)
    }

    /// Whether a bucket is proven, by its own certificate or that of a larger node: no two of its triangles collide.
    #[inline]
    pub(crate) fn is_bucket_proven(&self, certificates: &LocalCertificates, bucket: u32) -> bool {
        self.proven[certificates.buckets[bucket as usize].start as usize].0 == self.search
    }

    /// Whether the proof of one of two buckets covers their pair: they touch.
    #[inline]
    pub(crate) fn is_pair_proven(&self, certificates: &LocalCertificates, [n, m]: [u32; 2]) -> bool {
        let [a, b] = [n, m].map(|n| certificates.buckets[n as usize].start);
        [(a, b), (b, a)].iter().any(|(a, b)| {
            let (search, node) = self.proven[*a as usize];
            search == self.search && certificates.has_bucket(node, *b)
        })
    }

    /// Sets the factors. False where the positions of the motion are not those of the modes alone.
    fn begin_motion<M: VertexMotion<E>>(&mut self, certificates: &LocalCertificates, motion: &M) -> bool {
        let Some(coordinates) = motion.coarse_coordinates().filter(|_| motion.margin() == 0.0) else {
            return false;
        };
        let LocalCertificates { configuration, sizes, scale, reach, .. } = certificates;
        for (end, q) in coordinates.into_iter().enumerate() {
            self.factors[end].clear();
            let factors = q.iter().zip(configuration).zip(sizes).map(|((q, c), size)| (q - c) * size);
            let mut sum = 0.0;
            self.factors[end].extend(factors.map(|factor| {
                sum += factor.abs();
                factor as f32
            }));
            self.sums[end] = sum * ROUND_UP;
        }
        let rounding = motion.rounding() + rounding_bound(*reach, sizes.len());
        self.error = 2.0 * DIAGONAL * ROUND_UP * rounding * scale + 64.0 * f64::EPSILON;
        self.error.is_finite() && self.sums.iter().all(|sum| sum.is_finite())
    }

    fn evaluate(&self, certificates: &LocalCertificates, index: usize) -> bool {
        let bounds = certificates.bounds(index);
        let at = |end: usize| {
            let (columns, starts) = (certificates.columns(index), &*certificates.starts);
            let sums = self.instructions.run(ColumnSums { columns, starts, factors: &self.factors[end] });
            let (gradient, strain) = sums.parts();
            (DMat3::IDENTITY + gradient, self.residual(bounds, end, strain))
        };
        if E == 1 {
            let (map, residual) = at(0);
            return is_stretched_more(&map, residual);
        }
        let ends: [(DMat3, f64); E] = std::array::from_fn(at);
        let middle = ends.iter().fold(DMat3::ZERO, |sum, (map, _)| sum + *map);
        let Some(turn) = nearest_rotation(&middle) else { return false };
        let turn = turn.transpose();
        ends.iter().all(|(map, residual)| is_definite(&(turn * *map), *residual))
    }

    /// The left side of the comparison, rounded up; `strain`: `|W f|`.
    fn residual(&self, bounds: &LocalBounds, end: usize, strain: f64) -> f64 {
        let LocalBounds { residual, per_factor, per_error } = bounds;
        (residual * strain + per_factor * self.sums[end] + per_error * self.error) * ROUND_UP + 1e-30
    }
}

/// Whether `sigma_min(F) > t`. A Cholesky factorisation of `F'F - t^2` succeeds although the diagonal is lowered by more than
/// all rounding errors, which are relative to the trace (Rump, *Verification of positive definiteness*, 2006). NaN fails.
fn is_stretched_more(map: &DMat3, t: f64) -> bool {
    let gram = map.transpose() * *map;
    let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
    has_cholesky_factor(&gram, t * t * ROUND_UP + 1e-13 * trace)
}

/// Whether the symmetric part of a matrix has no eigenvalue up to t: then `sigma_min(F) > t`, for each matrix on the line
/// between two such ones, too. The rotation is one up to rounding, which the share of the norm covers.
fn is_definite(map: &DMat3, t: f64) -> bool {
    let symmetric = (*map + map.transpose()) * 0.5;
    let norm = [map.x_axis, map.y_axis, map.z_axis].iter().map(|x| x.abs().element_sum()).sum::<f64>();
    has_cholesky_factor(&symmetric, t + 1e-12 * norm)
}

/// Whether the Cholesky factorisation of a symmetric matrix minus `shift` times the identity succeeds.
fn has_cholesky_factor(matrix: &DMat3, shift: f64) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let first = x.x - shift;
    let (b, c) = (x.y / first, x.z / first);
    let second = (y.y - shift) - b * x.y;
    let e = y.z - b * x.z;
    let third = (z.z - shift) - c * x.z - e * e / second;
    first > 0.0 && second > 0.0 && third > 0.0
}

/// Steps of the iteration towards the rotation.
const STEPS: usize = 8;

/// The rotation of the polar decomposition, by Newton's iteration (Higham 1986), as an orthogonal matrix; none near a singular
/// one.
fn nearest_rotation(map: &DMat3) -> Option<DMat3> {
    let mut next = *map;
    for _ in 0..STEPS {
        let inverse = next.inverse().transpose();
        // Scaled towards the rotation: singular values become close to 1.
        let size = |m: &DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>();
        let factor = (size(&inverse) / size(&next)).sqrt().sqrt();
        next = (next * factor + inverse * (1.0 / factor)) * 0.5;
    }
    // Orthogonal to rounding, whatever the iteration did.
    let x = next.x_axis.try_normalize()?;
    let y = (next.y_axis - x * x.dot(next.y_axis)).try_normalize()?;
    let y = (y - x * x.dot(y)).try_normalize()?;
    let z = x.cross(y);
    let z = if z.dot(next.z_axis) < 0.0 { -z } else { z };
    Some(DMat3::from_cols(x, y, z))
}

/// Sums of the columns of a certificate times the factors.
struct ColumnSums<'c> {
    columns: &'c [[f32; LANES]],
    starts: &'c [usize],
    factors: &'c [f32],
}

/// The sums: nine entries of the gradient, then `W f`.
struct Sums([[f32; LANES]; MAX_VECTORS]);

impl Kernel for ColumnSums<'_> {
    type Output = Sums;

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> Sums {
        let mut sums = [vectors.splat(0.0); MAX_VECTORS];
        for (k, factor) in self.factors.iter().enumerate() {
            let factor = vectors.splat(*factor);
            let column = &self.columns[self.starts[k]..self.starts[k + 1]];
            for (sum, entries) in sums.iter_mut().zip(column) {
                *sum = vectors.multiply_add(vectors.load(entries), factor, *sum);
            }
        }
        Sums(sums.map(|sum| vectors.array(sum)))
    }
}

impl Sums {
    /// The gradient, and the norm of `W f`, rounded up beyond the error in single precision.
    #[inline]
    fn parts(&self) -> (DMat3, f64) {
        let numbers = self.0.as_flattened();
        let column = |j: usize| DVec3::from_array(std::array::from_fn(|c| f64::from(numbers[3 * j + c])));
        let square: f64 = numbers[GRADIENT..].iter().map(|x| f64::from(*x) * f64::from(*x)).sum();
        (DMat3::from_cols(column(0), column(1), column(2)), square.sqrt() * ROUND_UP)
    }
}
