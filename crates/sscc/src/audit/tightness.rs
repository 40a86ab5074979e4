//! How close radii are to the truth: radius over the closest collision found.

use rayon::prelude::*;

use super::claims::{Claim, Claims};
use super::minimum::{Collision, Minimum};
use super::random::Random;
use crate::bounds::ClusterBounds;
use crate::certificates::{KnownPair, Precision, RadiusSearch, SearchContext, SearchGoal, coarse_cap};
use crate::{Certificates, Pair, Progress};

/// Nodes measured beside the root and the pairs of its children.
const NODES: usize = 200;

/// Pairs of the pair tree measured.
const STORED: usize = 100;

/// Pairs measured that the pair tree lacks: those of the least bounds ...
const ABSENT: usize = 50;

/// ... below so many nodes and pairs.
const PARENTS: usize = 4096;

/// Closest collisions found, and what follows from them.
pub(super) struct Tightness {
    pub(super) root: Option<f64>,
    pub(super) quotients: Vec<f64>,
    pub(super) violations: Vec<String>,
    /// The collisions themselves: directions worth attacking.
    pub(super) hot: Vec<Collision>,
}

/// Measures the root, the pairs of its children, nodes and pairs of nodes spread evenly over the trees, and
/// those pairs that the pair tree lacks which seem to collide first.
pub(super) fn measure(
    certificates: &Certificates,
    claims: &Claims<'_>,
    minimum: &Minimum<'_>,
    seed: u64,
    progress: &dyn Progress,
) -> Tightness {
    let parts = certificates.parts();
    let nodes = parts.hierarchy.nodes();
    let clusters = ClusterBounds::new(minimum.scaled, &parts.hierarchy);
    let context = SearchContext {
        model: minimum.scaled,
        filter: minimum.filter,
        hierarchy: &parts.hierarchy,
        nodes: &clusters,
    };
    let search = || RadiusSearch::new(context, parts.epsilon, progress);
    let limit = parts.pair_tree.limit();
    // Where there is a pair tree, coarse radii of nodes go no further.
    let coarse_cap = coarse_cap(parts.global_radius, parts.epsilon);
    let is_capped = |claim: &Claim| match claim.nodes {
        _ if claim.radius >= parts.global_radius => true,
        (n, m) if n != m => claim.radius == limit,
        (n, _) => n != 0 && limit > 0.0 && claim.radius >= coarse_cap,
    };
    let mut measured = vec![claims.node(0)];
    measured.extend(claims.root_pairs());
    let spread = |count: usize, most: usize| (0..count).step_by(count.div_ceil(most).max(1));
    let within_small = parts.hierarchy.nodes_within_buckets();
    let own: Vec<u32> = (1..nodes.len() as u32).filter(|n| !within_small[*n as usize]).collect();
    measured.extend(spread(own.len(), NODES).map(|at| claims.node(own[at])));
    measured.extend(spread(claims.stored_len(), STORED).map(|place| claims.stored(place)));
    let missing: Vec<Claim> =
        spread(claims.parents_len(), PARENTS).flat_map(|parent| claims.absent(parent)).collect();
    let mut bounded: Vec<(f64, Claim)> = missing
        .into_par_iter()
        .map_init(search, |search, claim| (search.bound_nodes(claim.nodes, 2.0 * limit), claim))
        .collect();
    bounded.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.nodes.cmp(&b.1.nodes)));
    measured.extend(bounded.into_iter().take(ABSENT).map(|(_, claim)| claim));
    measured.retain(|claim| claim.radius > 0.0);
    let hottest: Vec<Option<Pair>> = measured
        .par_iter()
        .map_init(search, |search, claim| {
            // Beyond the radius: what is searched only up to it can break no claim.
            let goal = SearchGoal::new(2.0 * claim.radius.max(parts.global_radius), Precision::Full);
            let (n, m) = claim.nodes;
            if n != m {
                search.between(vec![KnownPair::unbounded((n, m))], goal);
            } else {
                let n = responsible(certificates, n);
                let node = &nodes[n as usize];
                if node.is_leaf() || parts.hierarchy.is_whole(n) {
                    search.within(n, goal);
                } else {
                    search.between(node.child_pairs().map(KnownPair::unbounded).collect(), goal);
                }
            }
            search.closest()
        })
        .collect();
    // Many claims have one pair of triangles in common.
    let mut faces: Vec<Pair> = hottest.iter().flatten().copied().collect();
    faces.sort_unstable();
    faces.dedup();
    let collisions: Vec<Option<Collision>> = faces
        .par_iter()
        .enumerate()
        .map(|(i, faces)| minimum.search(*faces, &mut Random::new(seed, i as u64)))
        .collect();
    let mut result = Tightness { root: None, quotients: vec![], violations: vec![], hot: vec![] };
    for (claim, hottest) in measured.iter().zip(hottest) {
        let at = hottest.and_then(|hottest| faces.binary_search(&hottest).ok());
        if let Some(collision) = at.and_then(|at| collisions[at].as_ref()).filter(|_| !is_capped(claim)) {
            let quotient = claim.radius / collision.norm;
            result.quotients.push(quotient);
            if claim.nodes == (0, 0) {
                result.root = Some(quotient);
            }
        }
    }
    for collision in collisions.into_iter().flatten() {
        if let Some((norm, q)) = &collision.confirmed {
            result.violations.extend(claims.violation(collision.faces, *norm, q));
        }
        result.hot.push(collision);
    }
    result
}

/// The node below n whose own search gave the radius of n.
fn responsible(certificates: &Certificates, mut n: u32) -> u32 {
    let parts = certificates.parts();
    loop {
        let radius = parts.node_radii[n as usize];
        // Computed as a whole.
        if parts.hierarchy.is_whole(n) {
            return n;
        }
        let mut children = parts.hierarchy.nodes()[n as usize].children();
        match children.find(|&child| parts.node_radii[child as usize] <= radius) {
            Some(child) => n = child,
            None => return n,
        }
    }
}
