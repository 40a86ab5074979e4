//! How close radii are to the truth: radius over the closest collision found.

use rayon::prelude::*;

use super::minimum::{Collision, Minimum};
use super::random::Random;
use crate::bounds::{ClusterBounds, ScaledModel};
use crate::certificates::{Search, child_pairs};
use crate::pairs::PairFilter;
use crate::{Certificates, Progress, ReducedModel};

/// Nodes measured beside the root and the pairs of its children.
const NODES: usize = 200;

/// Closest collisions found, and what follows from them.
pub(super) struct Tightness {
    pub(super) root: Option<f64>,
    pub(super) quotients: Vec<f64>,
    pub(super) violations: Vec<String>,
    /// The collisions themselves: directions worth attacking.
    pub(super) hot: Vec<Collision>,
}

/// A claim: no pair of these nodes collides below the radius.
#[derive(Clone, Copy)]
enum Claim {
    Node(u32),
    RootPair(u32, u32),
}

/// Measures the root, the pairs of its children, and nodes spread evenly over the tree.
pub(super) fn measure(
    model: &ReducedModel,
    certificates: &Certificates,
    seed: u64,
    progress: &dyn Progress,
) -> Tightness {
    let parts = certificates.parts();
    let nodes = parts.hierarchy.nodes();
    let scaled = ScaledModel::new(model, &parts.scope.metric, &parts.scope.center);
    let filter = PairFilter::new(model, &parts.scope.rule).leaving_out(&parts.scope.exceptions);
    let clusters = ClusterBounds::new(&scaled, &parts.hierarchy);
    let minimum = Minimum { model, scope: &parts.scope, scaled: &scaled, filter: &filter };
    let open = |radius: f64| radius > 0.0 && radius < parts.global_radius;
    let mut claims = vec![(Claim::Node(0), parts.node_radii[0])];
    claims.extend(
        child_pairs(&nodes[0]).zip(&parts.root_pair_radii).map(|((n, m), r)| (Claim::RootPair(n, m), *r)),
    );
    let stride = nodes.len().div_ceil(NODES);
    claims.extend((1..nodes.len()).step_by(stride).map(|n| (Claim::Node(n as u32), parts.node_radii[n])));
    let found: Vec<(bool, f64, Option<Collision>)> = claims
        .par_iter()
        .enumerate()
        .filter(|(_, (_, radius))| *radius > 0.0)
        .map(|(i, &(claim, radius))| {
            let mut search =
                Search::new(&scaled, &filter, &parts.hierarchy, &clusters, parts.epsilon, progress);
            // Beyond the radius: what is searched only up to it can break no claim.
            let cap = 2.0 * radius.max(parts.global_radius);
            match claim {
                Claim::RootPair(n, m) => search.between([(n, m)], cap),
                Claim::Node(n) => {
                    let n = responsible(certificates, n);
                    let node = &nodes[n as usize];
                    if node.is_leaf() {
                        search.within_leaf(n, cap)
                    } else {
                        search.between(child_pairs(node), cap)
                    }
                }
            };
            let mut random = Random::new(seed, i as u64);
            let collision = search.hottest().and_then(|faces| minimum.search(faces, &mut random));
            (i == 0, radius, collision)
        })
        .collect();
    let mut result = Tightness { root: None, quotients: vec![], violations: vec![], hot: vec![] };
    for (is_root, radius, collision) in found {
        let Some(collision) = collision else { continue };
        if open(radius) {
            let quotient = radius / collision.norm;
            result.quotients.push(quotient);
            if is_root {
                result.root = Some(quotient);
            }
        }
        if let Some((norm, q)) = &collision.confirmed
            && *norm < radius
        {
            result.violations.push(format!(
                "triangles {} and {} collide at |z| = {norm:e}, below the radius {radius:e}; q = {q:?}",
                collision.faces.0, collision.faces.1
            ));
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
        let mut children = parts.hierarchy.nodes()[n as usize].children();
        match children.find(|&child| parts.node_radii[child as usize] <= radius) {
            Some(child) => n = child,
            None => return n,
        }
    }
}
