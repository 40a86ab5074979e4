//! Measures tightness: radii divided by the norm of the closest collision found. A confirmed collision below a radius
//! is a violation; all collisions are directions for `attack`.

use super::claims::{Claim, Claims};
use super::minimum_search::{Collision, Confirmed, MinimumSearch};
use super::random::Random;
use crate::bounds::NodePairBounds;
use crate::certificates::{
    BoundedNodePair, NodeGroups, Precision, RadiusSearch, RadiusSearchContext, SearchGoal, coarse_cap,
};
use crate::parallel::{map, map_with};
use crate::{Certificates, Pair, Progress};

/// Maximum number of nodes measured beside the root and the pairs of its children.
const NODES: usize = 200;

/// Maximum number of entries of the pair tree measured.
const STORED: usize = 100;

/// Maximum number of absent pairs measured: those with the smallest bounds.
const ABSENT: usize = 50;

/// Maximum number of nodes and pairs below which absent pairs are searched.
const PARENTS: usize = 4096;

/// The closest collisions found, and the quotients and violations that follow from them.
pub(super) struct Tightness {
    /// The quotient of the root.
    pub(super) root: Option<f64>,
    /// The quotients of all radii measured, the root's included.
    pub(super) quotients: Vec<f64>,
    /// The claims that a confirmed collision refutes.
    pub(super) violations: Vec<String>,
    /// The collisions: directions worth attacking.
    pub(super) collisions: Vec<Collision>,
}

/// Measures the root, the pairs of its children, nodes and node pairs spread evenly over the trees, and
/// the absent pairs with the smallest bounds.
pub(super) fn measure(
    certificates: &Certificates,
    claims: &Claims<'_>,
    minimum: &MinimumSearch<'_>,
    seed: u64,
    progress: &dyn Progress,
) -> Tightness {
    let parts = certificates.parts();
    let bounds = NodePairBounds::new(minimum.scaled, &parts.hierarchy);
    let groups = NodeGroups::new(minimum.filter, &parts.hierarchy);
    let context = RadiusSearchContext {
        model: minimum.scaled,
        filter: minimum.filter,
        rings: minimum.rings,
        hierarchy: &parts.hierarchy,
        nodes: &bounds,
        groups: &groups,
    };
    let search = || RadiusSearch::new(context, parts.epsilon, progress);
    let limit = parts.pair_tree.limit();
    // Where there is a pair tree, coarse radii of nodes are not searched beyond this.
    let node_cap = coarse_cap(parts.global_radius, parts.epsilon);
    let is_capped = |claim: &Claim| match claim.nodes {
        _ if claim.radius >= parts.global_radius => true,
        (n, m) if n != m => claim.radius == limit,
        (n, _) => n != 0 && limit > 0.0 && claim.radius >= node_cap,
    };
    let mut measured = spread_claims(certificates, claims);
    let absent: Vec<Claim> =
        spread(claims.parents_len(), PARENTS).flat_map(|parent| claims.absent(parent)).collect();
    let bound =
        |search: &mut RadiusSearch<'_>, claim: Claim| (search.bound_nodes(claim.nodes, 2.0 * limit), claim);
    let mut bounded = map_with(absent, usize::MAX, search, bound);
    bounded.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.nodes.cmp(&b.1.nodes)));
    measured.extend(bounded.into_iter().take(ABSENT).map(|(_, claim)| claim));
    measured.retain(|claim| claim.radius > 0.0);
    let critical: Vec<Option<Pair>> = map_with(&measured, usize::MAX, search, |search, claim| {
        find_critical_pair(search, certificates, claim)
    });
    // Many claims have the same critical pair.
    let mut faces: Vec<Pair> = critical.iter().flatten().copied().collect();
    faces.sort_unstable();
    faces.dedup();
    let collisions: Vec<Option<Collision>> = map(faces.iter().enumerate(), |(stream, faces)| {
        minimum.search(*faces, &mut Random::new(seed, stream as u64))
    });
    let mut result = Tightness { root: None, quotients: vec![], violations: vec![], collisions: vec![] };
    for (claim, critical) in measured.iter().zip(critical) {
        let at = critical.and_then(|critical| faces.binary_search(&critical).ok());
        if let Some(collision) = at.and_then(|at| collisions[at].as_ref()).filter(|_| !is_capped(claim)) {
            let quotient = claim.radius / collision.norm;
            result.quotients.push(quotient);
            if claim.nodes == (0, 0) {
                result.root = Some(quotient);
            }
        }
    }
    for collision in collisions.into_iter().flatten() {
        if let Some(Confirmed { q, norm }) = &collision.confirmed {
            result.violations.extend(claims.violation(collision.faces, *norm, q));
        }
        result.collisions.push(collision);
    }
    result
}

/// Returns at most `most` numbers below `count`, spread evenly.
fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(count.div_ceil(most).max(1))
}

/// Returns the claims of the root and of the pairs of its children, and claims of nodes and stored node pairs spread evenly.
fn spread_claims(certificates: &Certificates, claims: &Claims<'_>) -> Vec<Claim> {
    let hierarchy = &certificates.parts().hierarchy;
    let mut measured = vec![claims.node(0)];
    measured.extend(claims.root_pairs());
    let within_buckets = hierarchy.nodes_within_buckets();
    let with_own_radius: Vec<u32> =
        (1..hierarchy.nodes().len() as u32).filter(|n| !within_buckets[*n as usize]).collect();
    measured.extend(spread(with_own_radius.len(), NODES).map(|at| claims.node(with_own_radius[at])));
    measured.extend(spread(claims.stored_len(), STORED).map(|index| claims.stored(index)));
    measured
}

/// Returns the triangle pair whose bound is the smallest below a claim's node or node pair.
fn find_critical_pair(
    search: &mut RadiusSearch<'_>,
    certificates: &Certificates,
    claim: &Claim,
) -> Option<Pair> {
    let parts = certificates.parts();
    // The search goes beyond the radius: a search that ended at the radius could refute no claim.
    let goal = SearchGoal::new(2.0 * claim.radius.max(parts.global_radius), Precision::Full);
    let (n, m) = claim.nodes;
    if n != m {
        search.between(vec![BoundedNodePair::unbounded((n, m))], goal);
        return search.closest();
    }
    let n = find_responsible_node(certificates, n);
    let node = &parts.hierarchy.nodes()[n as usize];
    if node.is_leaf() || parts.hierarchy.is_bucket_below_root(n) {
        search.within(n, goal);
    } else {
        search.between(node.child_pairs().map(BoundedNodePair::unbounded).collect(), goal);
    }
    search.closest()
}

/// Follows the radius of n down to the node whose own pairs determine it; ends at a bucket.
fn find_responsible_node(certificates: &Certificates, mut n: u32) -> u32 {
    let parts = certificates.parts();
    loop {
        let radius = parts.node_radii[n as usize];
        // The radius of a bucket comes from all of its triangles at once.
        if parts.hierarchy.is_bucket_below_root(n) {
            return n;
        }
        let mut children = parts.hierarchy.nodes()[n as usize].children();
        match children.find(|&child| parts.node_radii[child as usize] <= radius) {
            Some(child) => n = child,
            None => return n,
        }
    }
}
