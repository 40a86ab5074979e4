//! The stages in which radii of nodes are searched, from the buckets up.

use crate::hierarchy::Hierarchy;

/// The stage of the buckets.
pub(super) const BUCKETS: usize = 0;

/// Returns the nodes of each stage: all buckets, then the larger nodes of each level below the root, from below. A root that is a
/// leaf is a stage, too. The nodes of a stage are independent of each other. Nodes within a bucket are in no stage: they have the
/// bucket's radius.
pub(super) fn node_stages(hierarchy: &Hierarchy, is_in_bucket: &[bool]) -> Vec<Vec<usize>> {
    let is_bucket = |n: &usize| hierarchy.is_bucket_below_root(*n as u32);
    let buckets = (0..is_in_bucket.len()).filter(|n| is_bucket(n) && !is_in_bucket[*n]).collect();
    let is_searched = |n: &usize| !is_bucket(n) && (*n != 0 || hierarchy.nodes()[0].is_leaf());
    let larger = hierarchy.levels().into_iter().rev().map(|level| level.filter(is_searched).collect());
    std::iter::once(buckets).chain(larger).collect()
}
