//! The computation of local certificates.

use super::corner_gaps::{CornerGaps, TightPair};
use super::local_certificates::{
    LEAST_PROVEN_SHARE, LocalBounds, LocalCertificates, MOST_MODES, gradient_len,
};
use super::patch::Patch;
use super::patch_model::PatchModel;
use super::residual_ellipsoid::FitEllipsoid;
use super::strain_search::{StrainSearch, larger};
use super::touching_nodes::TouchingNodes;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::model::mode_rows::squared_distance;
use crate::parallel;
use crate::vectors::{InstructionSet, LANES};
use crate::{Error, Neighbours, Progress, ReducedModel};
use glam::DVec3;

/// Error of the difference of two residuals, relative to displacements and images of offsets: along each axis 4 units u = 2^-53 of
/// displacements and 5 u of the image of an offset, for two vertices and three axes: less than 18 u.
const RESIDUAL_ERROR: f64 = 64.0 * (f64::EPSILON / 2.0);

/// Maximum number of vertices to which the ellipsoid is fitted.
const VERTEX_BLOCKS: usize = 16;

/// Maximum number of parts into which the list of tight pairs is cut. The ellipsoid is fitted to the pair of the
/// largest ratio in each part, and to half as many pairs of the largest ratios in all.
const TIGHT_BLOCKS: usize = 48;

/// Certificates with numbers of at least this prove nothing.
const LARGEST: f64 = 1e12;

/// Ratios with other nodes that are below this share of the ratio within the node are not distinguished.
const OWN_SHARE: f32 = 1.0;

/// The largest memory of all certificates, whatever the budget: starts of modes, lists and matrices have 32 bits.
const MOST_BYTES: u64 = 1 << 34;

/// Entries of lists take the least memory, eight bytes each.
const _: () = assert!(MOST_BYTES / 8 <= u32::MAX as u64);

/// Smaller bounds of heights are not distinguished: a rotation costs a multiple of them.
const LEAST_FLATNESS: f32 = 1e-3;

/// The certificate of one node.
struct LocalCertificate {
    modes: Vec<u32>,
    gradients: Vec<f32>,
    ellipsoid: Vec<u16>,
    bounds: LocalBounds,
    /// Nodes, and the ratio with each.
    list: Vec<(u32, f32)>,
}

/// Computes the certificates of nodes down to buckets about the centre, on the threads of the current pool. Those of fewest modes
/// are kept while they fit into `most_bytes`. `filter` leaves out exceptions. There are no certificates if `most_bytes`
/// is 0, [`PatchModel::new`] or [`CornerGaps::new`] returns None, pairs that share an edge count, or the certificates kept would
/// cover too few triangles ([`LEAST_PROVEN_SHARE`]).
///
/// # Errors
/// When `progress` cancels.
pub(crate) fn compute_local_certificates(
    model: &ReducedModel,
    hierarchy: &Hierarchy,
    filter: &PairFilter,
    center: &[f64],
    most_bytes: usize,
    progress: &dyn Progress,
) -> Result<LocalCertificates, Error> {
    if most_bytes == 0 || filter.neighbours() == Neighbours::IncludeFolded {
        return Ok(LocalCertificates::default());
    }
    let Some(patch_model) = PatchModel::new(model, center) else { return Ok(LocalCertificates::default()) };
    let Some(gaps) = CornerGaps::new(hierarchy, filter, &patch_model.positions, progress)? else {
        return Ok(LocalCertificates::default());
    };
    let touching = TouchingNodes::new(hierarchy, filter);
    let builder = Builder { model: &patch_model, gaps: &gaps, touching: &touching };
    let mut wanted = certified_nodes(hierarchy);
    wanted.sort_by_key(|n| std::cmp::Reverse(hierarchy.nodes()[*n as usize].triangle_count));
    let scratch = || Scratch::new(patch_model.positions.len());
    let certify = |scratch: &mut Scratch, n: u32| {
        if gaps.is_cancelled() { None } else { Some((n, builder.certify(n, scratch)?)) }
    };
    let certified = parallel::map_with(wanted, usize::MAX, scratch, certify);
    // Certificates of a cancelled computation prove less than they could, or are missing.
    if progress.is_cancelled() {
        return Err(Error::Cancelled);
    }
    let mut found: Vec<(u32, LocalCertificate)> = certified.into_iter().flatten().collect();
    keep_within(&mut found, hierarchy, most_bytes);
    if found.is_empty() {
        return Ok(LocalCertificates::default());
    }
    let mut all =
        LocalCertificates { mode_starts: vec![0], list_starts: vec![0], ..LocalCertificates::default() };
    for (n, certificate) in found {
        all.nodes.push(n);
        all.modes.extend(certificate.modes);
        all.mode_starts.push(all.modes.len() as u32);
        all.gradients.extend(certificate.gradients);
        all.ellipsoids.extend(certificate.ellipsoid);
        all.bounds.push(certificate.bounds);
        all.list_nodes.extend(certificate.list.iter().map(|(m, _)| m));
        all.list_ratios.extend(certificate.list.iter().map(|(_, ratio)| ratio));
        all.list_starts.push(all.list_nodes.len() as u32);
    }
    Ok(all)
}

/// Returns the part of a memory whose numbers have starts of 32 bits.
fn addressed_bytes(most_bytes: usize) -> usize {
    let addressed = usize::try_from(MOST_BYTES).unwrap_or(usize::MAX);
    with_mutant!(most_bytes.min(addressed), LocalBytesUnlimited, most_bytes)
}

/// Keeps the certificates of fewest modes, and at equal numbers of modes those of the largest nodes, while they fit into the
/// memory. Keeps no certificate if they cover less than [`LEAST_PROVEN_SHARE`] of all triangles. `found` has the largest nodes
/// first, and is sorted by node afterwards.
fn keep_within(found: &mut Vec<(u32, LocalCertificate)>, hierarchy: &Hierarchy, most_bytes: usize) {
    let most_bytes = addressed_bytes(most_bytes);
    let mut bytes = 0;
    found.sort_by_key(|(_, certificate)| certificate.modes.len());
    found.retain(|(_, certificate)| {
        bytes += LocalCertificates::bytes_of(certificate.modes.len()) + 8 * certificate.list.len();
        bytes <= most_bytes
    });
    let mut is_covered = vec![false; hierarchy.order().len()];
    for (n, _) in &*found {
        let node = &hierarchy.nodes()[*n as usize];
        is_covered[node.first_triangle as usize..][..node.triangle_count as usize].fill(true);
    }
    let covered = is_covered.iter().filter(|is_covered| **is_covered).count();
    if (covered as f64) < LEAST_PROVEN_SHARE * is_covered.len() as f64 {
        found.clear();
    }
    found.sort_unstable_by_key(|(n, _)| *n);
}

/// Returns the nodes that get a certificate: buckets, the nodes directly above them, nodes at every second height beyond, and the
/// root.
fn certified_nodes(hierarchy: &Hierarchy) -> Vec<u32> {
    let (nodes, within) = (hierarchy.nodes(), hierarchy.nodes_within_buckets());
    // The height of each node above the farthest bucket below it.
    let mut heights = vec![0_u32; nodes.len()];
    for n in (0..nodes.len()).rev().filter(|n| !nodes[*n].fits_in_bucket()) {
        heights[n] = 1 + nodes[n].children().map(|child| heights[child as usize]).max().unwrap_or(0);
    }
    let is_wanted = |n: usize| !within[n] && (n == 0 || heights[n] == 0 || heights[n] % 2 == 1);
    (0..nodes.len() as u32).filter(|n| is_wanted(*n as usize)).collect()
}

struct Builder<'b> {
    model: &'b PatchModel<'b>,
    gaps: &'b CornerGaps<'b>,
    touching: &'b TouchingNodes<'b>,
}

/// The memory of one thread.
struct Scratch {
    instructions: InstructionSet,
    patch: Patch,
    search: StrainSearch,
    images: Vec<f64>,
}

impl Scratch {
    fn new(vertices: usize) -> Self {
        Self {
            instructions: InstructionSet::default(),
            patch: Patch::new(vertices),
            search: StrainSearch::default(),
            images: Vec::new(),
        }
    }
}

impl Builder<'_> {
    /// Computes the certificate of a node. None if more than [`MOST_MODES`] modes move its patch, numbers of the ellipsoid are
    /// out of range, or the certificate would prove nothing.
    fn certify(&self, n: u32, scratch: &mut Scratch) -> Option<LocalCertificate> {
        let Scratch { instructions, patch, search, images } = scratch;
        let around = self.touching.around(n);
        let top = || around.iter().copied().filter(|m| !self.touching.has_parent(*m, &around));
        let nodes = || std::iter::once(n).chain(top());
        let CornerGaps { hierarchy, filter, .. } = self.gaps;
        patch.load(self.model, hierarchy, filter.faces(), nodes(), MOST_MODES)?;
        let parts = search.load(self.gaps, patch, nodes());
        let rank = patch.modes.len();
        let blocks = self.blocks(n, patch);
        let ellipsoid = instructions.run(FitEllipsoid { blocks: &blocks, rank, row_len: patch.row_len })?;
        let largest_image = patch.images(&ellipsoid, images, &mut search.images);
        search.begin(largest_image);
        let floor = search.largest_ratio(&self.tight_within(n, patch));
        let ratio = infinite_for_nan(search.within(self.gaps, 0, floor));
        let mut list = Vec::new();
        for part in &parts[1..] {
            self.list(search, &around, *part, OWN_SHARE * ratio, &mut list);
        }
        list.iter_mut().for_each(|(_, ratio)| *ratio = infinite_for_nan(*ratio));
        list.sort_unstable_by_key(|(m, _)| *m);
        let (across, flatness) = self.flatness(search, patch, &parts);
        let (steepest, widest) = (patch.steepest(), ellipsoid.largest_column());
        let per_error = (1.0 + 1e-12) / search.smallest_gap.min(1.0);
        // The error of residuals, then that of their images.
        let of_residuals = RESIDUAL_ERROR * (2.0 + steepest * patch.longest()) * per_error;
        let of_images = 2.0 * ellipsoid.defect() * patch.largest_residual() * per_error;
        let bounds = LocalBounds {
            ratio: f64::from(ratio),
            per_factor: with_mutant!(
                of_residuals + of_images,
                LocalResidualsExact,
                of_images,
                LocalDefectForgotten,
                of_residuals
            ),
            per_error,
            steepest,
            widest,
            across: across.to_array(),
            flatness: f64::from(flatness),
        };
        let numbers = [bounds.per_factor, per_error, steepest, widest];
        numbers.iter().all(|x| *x < LARGEST).then(|| LocalCertificate {
            gradients: gradients(patch),
            ellipsoid: ellipsoid.numbers().collect(),
            modes: patch.modes.clone(),
            bounds,
            list,
        })
    }

    /// Returns a direction across a patch that is nearly flat, and the largest quotient of the height of one corner
    /// above another along this direction and of their gap. Returns zero and infinity for other patches.
    fn flatness(&self, search: &mut StrainSearch, patch: &Patch, parts: &[u32]) -> (DVec3, f32) {
        let Some(across) = patch.across() else { return (DVec3::ZERO, f32::INFINITY) };
        let highest = patch.heights(across, &mut search.images);
        search.begin(with_mutant!(highest, LocalHeightsUnrounded, 0.0));
        let within = search.within(self.gaps, 0, LEAST_FLATNESS);
        let others: &[u32] = with_mutant!(&parts[1..], LocalHeightsOfNodeAlone, &[]);
        let others = others.iter().map(|part| search.between(self.gaps, (0, *part), LEAST_FLATNESS));
        (across, infinite_for_nan(others.fold(within, larger)))
    }

    /// Adds the ratios of the patch's node with a part and with the nodes below the part, down to buckets, as far as
    /// they share a vertex with the patch's node. Returns the ratio with the part.
    fn list(
        &self,
        search: &mut StrainSearch,
        around: &[u32],
        part: u32,
        floor: f32,
        list: &mut Vec<(u32, f32)>,
    ) -> f32 {
        let (node, children) = search.node(part);
        let is_touching = |node: u32| around.binary_search(&node).is_ok();
        if !is_touching(node) {
            return search.between(self.gaps, (0, part), floor);
        }
        let Some(children) = children else {
            let ratio = search.between(self.gaps, (0, part), floor);
            list.push((node, ratio));
            return ratio;
        };
        let mut ratio = floor;
        for is_first in [true, false] {
            for child in children.clone() {
                if is_touching(search.node(child).0) != is_first {
                    continue;
                }
                let floor = if is_first { floor } else { ratio };
                let of_child = self.list(search, around, child, floor, list);
                ratio = with_mutant!(larger(ratio, of_child), LocalListOfLastPart, of_child);
            }
        }
        list.push((node, ratio));
        ratio
    }

    /// Returns the blocks to which the ellipsoid is fitted: residuals of some vertices over their distances from the first one,
    /// and differences of residuals over the gap for the tight pairs within the patch for which they are largest.
    fn blocks(&self, n: u32, patch: &Patch) -> Vec<f64> {
        let width = 3 * patch.row_len;
        let residual = |i: u32| &patch.residuals[width * i as usize..][..width];
        let mut blocks = Vec::new();
        for i in (1..patch.offsets.len()).step_by(patch.offsets.len().div_ceil(VERTEX_BLOCKS)) {
            let distance = patch.offsets[i].length();
            if distance > 0.0 {
                blocks.extend(residual(i as u32).iter().map(|e| e / distance));
            }
        }
        let with_ratio = |(_, pair): (u32, TightPair)| {
            let ratio = squared_distance(residual(pair.i), residual(pair.j)).sqrt() / f64::from(pair.gap);
            (ratio, pair)
        };
        let mut tight: Vec<(f64, TightPair)> = self.tight(n, patch).into_iter().map(with_ratio).collect();
        // Chooses the largest of each part, so that no single crease decides, and the largest of all.
        let larger = |a: &(f64, TightPair), b: &(f64, TightPair)| b.0.total_cmp(&a.0);
        let mut chosen: Vec<_> = tight
            .chunks(tight.len().div_ceil(TIGHT_BLOCKS).max(1))
            .filter_map(|part| part.iter().min_by(|a, b| larger(a, b)).copied())
            .collect();
        tight.sort_by(larger);
        chosen.extend(tight.into_iter().take(TIGHT_BLOCKS / 2));
        for (_, TightPair { i, j, gap }) in chosen {
            blocks.extend(residual(i).iter().zip(residual(j)).map(|(x, y)| (y - x) / f64::from(gap)));
        }
        blocks
    }

    /// Returns the tight pairs of the node's leaves with later leaves if both vertices are in the patch, by the numbers of the
    /// vertices there, and the later leaf of each.
    fn tight(&self, n: u32, patch: &Patch) -> Vec<(u32, TightPair)> {
        let nodes = self.gaps.hierarchy.nodes();
        let (mut tight, mut stack) = (Vec::new(), vec![n]);
        while let Some(n) = stack.pop() {
            stack.extend(nodes[n as usize].children());
            for (leaf, pair) in self.gaps.tight(n) {
                let [i, j] = [pair.i, pair.j].map(|v| patch.numbers[v as usize]);
                if i.max(j) != u32::MAX {
                    tight.push((*leaf, TightPair { i, j, gap: pair.gap }));
                }
            }
        }
        tight
    }

    /// Returns the tight pairs of two leaves of the node: the ratio of all pairs within the node is at least that of these pairs.
    fn tight_within(&self, n: u32, patch: &Patch) -> Vec<TightPair> {
        let nodes = self.gaps.hierarchy.nodes();
        let node = &nodes[n as usize];
        let own = node.first_triangle..node.first_triangle + node.triangle_count;
        let mut tight = self.tight(n, patch);
        tight.retain(|(leaf, _)| own.contains(&nodes[*leaf as usize].first_triangle));
        tight.into_iter().map(|(_, pair)| pair).collect()
    }
}

/// Replaces NaN by infinity: neither ratio proves anything.
fn infinite_for_nan(ratio: f32) -> f32 {
    if ratio.is_nan() { f32::INFINITY } else { ratio }
}

/// Returns the gradients in the layout of [`LocalCertificates::gradients`].
fn gradients(patch: &Patch) -> Vec<f32> {
    let count = patch.modes.len();
    // The rows are `G_cj` at 3 c + j; entry e of a column is `G_cj` with c = e % 3, j = e / 3.
    let entry = |e: usize, k: usize| patch.gradient[(3 * (e % 3) + e / 3) * patch.row_len + k] as f32;
    let mut numbers: Vec<f32> = (0..count).flat_map(|k| (0..LANES).map(move |e| entry(e, k))).collect();
    numbers.extend((0..count).map(|k| entry(LANES, k)));
    numbers.resize(gradient_len(count), 0.0);
    numbers
}

#[cfg(test)]
mod tests;
