//! The numbers of local certificates, and how they are computed from a model.
//!
//! A node N with its ring K (the buckets outside of N that share a vertex with it) is a *patch*. About the configuration
//! `q_0` of the certificates, in the unit of half the shape's size, its vertices are at `x_v = p_v + U_v f`. The factor
//! `f_k = (q - q_0)_k s_k` counts the largest displacement `s_k` by mode k. Take any gradient G (a 3 x 3 matrix for each
//! mode) and the residuals `E_v = U_v - U_0 - G (p_v - p_0)` that it leaves. Then for two vertices
//!
//! ```text
//! x_j - x_i = F (p_j - p_i) + (E_j - E_i) f,    F = I + G f
//! ```
//!
//! For two triangles take a unit direction n with `s_ij = n.(p_j - p_i) > 0` at all nine pairs of corners. Along
//! `m = F^-T n` the gap of two corners is `s_ij + m.(E_j - E_i) f`, and `|m| <= 1 / sigma_min(F)`. So the plane across m
//! separates the triangles if `|(E_j - E_i) f| < sigma_min(F) s_ij` at all nine. One matrix W for all pairs of the patch,
//! with `|(E_j - E_i) f| <= s_ij (kappa |W f| + rho T)` and `T = sum_k |f_k|`, makes this one comparison:
//!
//! ```text
//! kappa |W f| + rho T + eta / s  <  sigma_min(F)
//! ```
//!
//! where s is the smallest `s_ij`, and eta bounds how far computed positions are from the exact ones. It proves all pairs
//! that count within N and between N and K, except for the exceptions. It proves nothing about two triangles of K.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::patch::PatchBuilder;
use crate::ReducedModel;
use crate::filter::PairFilter;
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::model::mode_rows::padded_rank;

/// Models of more modes have no local certificates: their matrices would take more memory than the mesh.
pub(super) const MAX_RANK: usize = 60;

/// Numbers in a vector.
pub(super) const LANES: usize = crate::vectors::LANES;

/// The entries of the gradient of one mode.
pub(super) const GRADIENT: usize = 9;

/// The local certificates of a model's nodes.
#[derive(Clone, Debug)]
pub(crate) struct LocalCertificates {
    /// The configuration about which factors are measured.
    pub(super) configuration: Vec<f64>,
    /// For each mode its largest displacement over half the size of the shape.
    pub(super) sizes: Vec<f64>,
    /// One over half the size of the shape.
    pub(super) scale: f64,
    /// An upper bound of the magnitude of every term of every position at the configuration.
    pub(super) reach: f64,
    /// For each node its certificate; [`NONE`] for none.
    indices: Vec<u32>,
    /// For each mode where its column starts within a certificate, and the length of all columns.
    pub(super) starts: Vec<usize>,
    /// For each certificate its columns.
    columns: Vec<[f32; LANES]>,
    bounds: Vec<LocalBounds>,
    /// For each node its buckets, as a range of positions in the order of triangles.
    pub(super) buckets: Vec<Range<u32>>,
    /// For each node its ring: where it starts, and the end.
    ring_starts: Vec<u32>,
    /// Positions of buckets, ascending in each ring.
    rings: Vec<u32>,
}

/// What a certificate has beside its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalBounds {
    /// `kappa`
    pub(super) residual: f64,
    /// The factor of T: `rho`, and the error of F and of `W f` in single precision.
    pub(super) per_factor: f64,
    /// `1 / s`
    pub(super) per_error: f64,
}

pub(super) const NONE: u32 = u32::MAX;

/// The certificate of one node.
pub(super) struct LocalCertificate {
    pub(super) columns: Vec<[f32; LANES]>,
    pub(super) bounds: LocalBounds,
}

/// A model in the unit of half its size, about its centre.
pub(super) struct UnitModel {
    pub(super) rank: usize,
    /// The length of a row: the rank, padded with zeros.
    pub(super) row_len: usize,
    pub(super) positions: Vec<DVec3>,
    /// For each vertex three rows over the modes (x, y, z).
    modes: Vec<f64>,
}

impl LocalCertificates {
    /// The certificates of all nodes down to buckets about a configuration, on the threads of the current pool. None where the
    /// shape has no size, or there are too many modes.
    pub(crate) fn compute(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        filter: &PairFilter,
        configuration: &[f64],
    ) -> Option<Self> {
        let rank = model.rank();
        let reach = model.check_coordinates(configuration).ok().filter(|_| rank <= MAX_RANK)?;
        let (unit, half) = UnitModel::new(model, configuration)?;
        let scale = 1.0 / half;
        let sizes: Vec<f64> = (0..rank).map(|k| model.mode_displacement_bound(k, 1.0) * scale).collect();
        let is_normal = |x: f64| x == 0.0 || x.is_normal();
        if !scale.is_normal() || !sizes.iter().all(|size| is_normal(*size)) {
            return None;
        }
        let starts = column_starts(rank);
        let builder = PatchBuilder::new(&unit, hierarchy, filter);
        let nodes = hierarchy.nodes();
        let within = hierarchy.nodes_within_buckets();
        let wanted: Vec<u32> = (0..nodes.len() as u32).filter(|n| !within[*n as usize]).collect();
        let certificates: Vec<(u32, Option<LocalCertificate>)> = wanted
            .par_iter()
            .map_init(|| builder.scratch(), |scratch, n| (*n, builder.certify(*n, scratch)))
            .collect();
        let mut indices = vec![NONE; nodes.len()];
        let (mut columns, mut bounds) = (Vec::new(), Vec::new());
        for (n, certificate) in certificates {
            if let Some(certificate) = certificate {
                indices[n as usize] = bounds.len() as u32;
                columns.extend(certificate.columns);
                bounds.push(certificate.bounds);
            }
        }
        let configuration = configuration.to_vec();
        let buckets = bucket_ranges(hierarchy, &within);
        let (mut ring_starts, mut rings) = (vec![0], Vec::new());
        for n in 0..nodes.len() as u32 {
            let start = rings.len();
            let ring = if indices[n as usize] == NONE { Vec::new() } else { builder.ring(n) };
            rings.extend(ring.into_iter().map(|m| buckets[m as usize].start));
            rings[start..].sort_unstable();
            ring_starts.push(rings.len() as u32);
        }
        Some(Self {
            configuration,
            sizes,
            scale,
            reach,
            indices,
            starts,
            columns,
            bounds,
            buckets,
            ring_starts,
            rings,
        })
    }

    /// The number of certificates.
    pub(crate) fn count(&self) -> usize {
        self.bounds.len()
    }

    /// Memory of the certificates in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.columns) + size_of_val(&*self.bounds) + size_of_val(&*self.indices)
    }

    /// The certificate of a node.
    #[inline]
    pub(super) fn index_of(&self, node: u32) -> Option<usize> {
        let index = self.indices[node as usize];
        (index != NONE).then_some(index as usize)
    }

    /// The columns of a certificate, those of mode k from `starts[k]` on: the gradient, then W down to the diagonal.
    #[inline]
    pub(super) fn columns(&self, index: usize) -> &[[f32; LANES]] {
        let len = self.starts[self.sizes.len()];
        &self.columns[index * len..][..len]
    }

    /// Whether a bucket, by its position, is in the patch of a node.
    #[inline]
    pub(super) fn has_bucket(&self, node: u32, bucket: u32) -> bool {
        let [start, end] = [node, node + 1].map(|n| self.ring_starts[n as usize] as usize);
        self.buckets[node as usize].contains(&bucket) || self.rings[start..end].binary_search(&bucket).is_ok()
    }

    #[inline]
    pub(super) fn bounds(&self, index: usize) -> &LocalBounds {
        &self.bounds[index]
    }
}

/// For each mode where its column starts, in vectors, and the end.
fn column_starts(rank: usize) -> Vec<usize> {
    let mut starts = vec![0];
    for k in 0..rank {
        starts.push(starts[k] + (GRADIENT + k + 1).div_ceil(LANES));
    }
    starts
}

impl UnitModel {
    /// The model at a configuration, and half its size; none where that is no normal number.
    fn new(model: &ReducedModel, configuration: &[f64]) -> Option<(Self, f64)> {
        let (mesh, rank) = (model.mesh(), model.rank());
        let used = mesh.used_vertices();
        let Aabb { lower, upper } = Aabb::of_points(used.iter().map(|&v| model.position(v, configuration)));
        let center = lower * 0.5 + upper * 0.5;
        let half = (upper - center).max(center - lower).max_element();
        if !half.is_normal() {
            return None;
        }
        let count = mesh.rest_positions().len();
        let row_len = padded_rank(rank);
        let mut unit = Self {
            rank,
            row_len,
            positions: vec![DVec3::ZERO; count],
            modes: vec![0.0; 3 * row_len * count],
        };
        for v in used {
            unit.positions[v as usize] = (model.position(v, configuration) - center) / half;
            let rows = &mut unit.modes[3 * row_len * v as usize..][..3 * row_len];
            for (k, u) in model.modes().of_vertex(v).iter().enumerate() {
                let size = model.mode_displacement_bound(k, 1.0);
                let u = if size > 0.0 { *u / size } else { DVec3::ZERO };
                [rows[k], rows[row_len + k], rows[2 * row_len + k]] = u.to_array();
            }
        }
        Some((unit, half))
    }

    /// The three rows of a vertex.
    #[inline]
    pub(super) fn modes(&self, vertex: u32) -> &[f64] {
        &self.modes[3 * self.row_len * vertex as usize..][..3 * self.row_len]
    }
}

/// For each node the positions of its buckets in the order of triangles; for a node within a bucket that of the bucket.
fn bucket_ranges(hierarchy: &Hierarchy, within: &[bool]) -> Vec<Range<u32>> {
    let nodes = hierarchy.nodes();
    let is_bucket = |n: usize| !within[n] && nodes[n].fits_in_bucket();
    let mut first: Vec<u32> =
        (0..nodes.len()).filter(|n| is_bucket(*n)).map(|n| nodes[n].first_triangle).collect();
    first.sort_unstable();
    let position = |triangle: u32| first.partition_point(|start| *start <= triangle) as u32;
    nodes
        .iter()
        .map(|node| {
            position(node.first_triangle) - 1..position(node.first_triangle + node.triangle_count - 1)
        })
        .collect()
}
