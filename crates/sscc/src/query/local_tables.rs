//! The positions of the numbers of local certificates, by node, by list, and by bucket.

use std::sync::Arc;

use super::affine_modes::AffineModes;
use super::region_rates::RegionRates;
use crate::Metric;
use crate::certificates::{EllipsoidBlocks, FactorScales, LocalCertificates, PatchModel, gradient_len};
use crate::hierarchy::Hierarchy;
use crate::vectors::LANES;

/// The index for a node without a certificate.
const NONE: u32 = u32::MAX;

/// Local certificates, and the positions of the numbers of each node's certificate.
#[derive(Clone)]
pub(super) struct LocalTables {
    pub(super) certificates: Arc<LocalCertificates>,
    pub(super) center: Vec<f64>,
    pub(super) scales: FactorScales,
    /// For each node its certificate; [`NONE`] if it has none.
    of_node: Vec<u32>,
    /// For each certificate the positions at which its gradients and its ellipsoid start, in SIMD vectors.
    pub(super) starts: Vec<[u32; 2]>,
    /// Bounds of the changes of numbers of certificates in regions; `None` before [`Self::add_region_rates`], and for dense metrics.
    pub(super) rates: Option<RegionRates>,
    /// Combinations of modes that move the whole shape by affine maps; `None` before [`Self::add_affine_modes`].
    pub(super) affine: Option<AffineModes>,
    /// For each certificate the [bits](list_bit) of the nodes of its list: most nodes are on no list.
    list_bits: Vec<u64>,
    /// For each node its buckets, as a range of positions in the order of triangles.
    pub(super) buckets: Vec<std::ops::Range<u32>>,
}

impl LocalTables {
    /// Returns the tables; `None` if there are no certificates.
    pub(super) fn new(
        certificates: &Arc<LocalCertificates>,
        hierarchy: &Hierarchy,
        center: &[f64],
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
        let (certificates, center) = (Arc::clone(certificates), center.to_vec());
        let buckets = bucket_ranges(hierarchy);
        Some(Self {
            certificates,
            center,
            scales,
            of_node,
            starts,
            rates: None,
            affine: None,
            list_bits,
            buckets,
        })
    }

    /// Adds the rates that proofs in regions need. There are none for a dense metric: its factor may be nearly singular.
    pub(super) fn add_region_rates(&mut self, metric: &Metric) {
        let rates = || RegionRates::new(&self.certificates, &self.scales, &metric.scales());
        self.rates = metric.dense_factor().is_none().then(rates);
    }

    /// Adds the combinations of modes that move the whole shape by affine maps, if there are any.
    pub(super) fn add_affine_modes(&mut self, model: &PatchModel<'_>) {
        self.affine = AffineModes::new(model);
    }

    #[inline]
    pub(super) fn certificate_of(&self, node: u32) -> Option<usize> {
        let index = self.of_node[node as usize];
        (index != NONE).then_some(index as usize)
    }

    /// Returns the ratio of the pairs of a certificate's node with another node; `None` if that node is not on its
    /// list.
    #[inline]
    pub(super) fn ratio_with(&self, certificate: usize, node: u32) -> Option<f32> {
        if self.list_bits[certificate] & list_bit(node) == 0 {
            return None;
        }
        let LocalCertificates { list_starts, list_nodes, list_ratios, .. } = &*self.certificates;
        let [start, end] = [certificate, certificate + 1].map(|i| list_starts[i] as usize);
        let at = list_nodes[start..end].binary_search(&node).ok()?;
        Some(list_ratios[start + at])
    }
}

/// Returns one of 64 bits for each node. After multiplication by an odd number, consecutive numbers have different upper bits (Knuth).
#[inline]
fn list_bit(node: u32) -> u64 {
    1 << (node.wrapping_mul(0x9e37_79b9) >> 26)
}

/// Returns for each node the positions of its buckets in the order of triangles; for a node within a bucket that of the bucket.
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

/// Returns, for tests, the tables of certificates of a shape of one bucket, in units of its size and of the largest displacements, and
/// its hierarchy.
#[cfg(test)]
pub(super) fn tables_of(
    local: &LocalCertificates,
    center: &[f64],
    metric: &Metric,
) -> (LocalTables, Hierarchy) {
    let (model, _) = crate::test_models::strips(&mut crate::test_models::Random(1), 0);
    let hierarchy = Hierarchy::build(&model, model.metric());
    let scales = FactorScales { sizes: vec![1.0; center.len()], scale: 1.0, reach: 1.0 };
    let mut tables = LocalTables::new(&Arc::new(local.clone()), &hierarchy, center, scales).unwrap();
    tables.add_region_rates(metric);
    (tables, hierarchy)
}

#[cfg(test)]
mod tests;
