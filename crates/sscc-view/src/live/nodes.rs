//! The hierarchy, its AABBs, and the nodes that the certificates do not prove free.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use sscc::{Certificates, ReducedModel};

use crate::ViewError;

/// Name of the array with the hierarchy's order of triangles.
pub const ORDER: &str = "order";

/// The hierarchy, with one entry for each node in every list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NodesAnswer {
    /// The parent of each node; -1 for the root.
    parent: Vec<i64>,
    level: Vec<usize>,
    radius: Vec<f64>,
    /// Start of the node's triangles in the order.
    first: Vec<u32>,
    count: Vec<u32>,
    /// Name of the array with the order.
    order: &'static str,
}

/// The nodes that Algorithm 1 tests against themselves (paper, sections 3 and 4).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frontier {
    /// Nodes whose certificate fails.
    opened: Vec<u32>,
    /// Nodes whose certificate holds: the traversal ends there.
    culled: Vec<u32>,
}

/// A request for the AABBs of one level at q.
#[derive(Clone, Debug, Deserialize)]
pub struct BoxesRequest {
    q: Vec<f64>,
    level: usize,
}

/// Smallest x, y, z and largest x, y, z of each node of the level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoxesAnswer {
    boxes: Vec<[f64; 6]>,
}

/// Returns the hierarchy.
pub(super) fn all(certificates: &Certificates) -> NodesAnswer {
    let hierarchy = &certificates.parts().hierarchy;
    let nodes = hierarchy.nodes();
    let (mut parent, mut level) = (vec![-1; nodes.len()], vec![0; nodes.len()]);
    for (n, node) in nodes.iter().enumerate() {
        for child in node.children() {
            (parent[child as usize], level[child as usize]) = (n as i64, level[n] + 1);
        }
    }
    NodesAnswer {
        parent,
        level,
        radius: certificates.parts().node_radii.clone(),
        first: nodes.iter().map(|node| node.first_triangle).collect(),
        count: nodes.iter().map(|node| node.triangle_count).collect(),
        order: ORDER,
    }
}

/// Returns the nodes that a query at this `|z|` opens, and those that it culls. A traversal ends at buckets.
pub(super) fn frontier(certificates: &Certificates, norm: f64) -> Frontier {
    let nodes = certificates.parts().hierarchy.nodes();
    let (mut opened, mut culled) = (Vec::new(), Vec::new());
    let mut waiting = vec![0];
    while let Some(n) = waiting.pop() {
        if norm < certificates.parts().node_radii[n as usize] {
            culled.push(n);
        } else {
            opened.push(n);
            let node = &nodes[n as usize];
            waiting.extend(node.children().filter(|_| !node.fits_in_bucket()));
        }
    }
    opened.sort_unstable();
    culled.sort_unstable();
    Frontier { opened, culled }
}

/// Returns the AABBs of one level at q.
pub(super) fn boxes(
    model: &ReducedModel,
    certificates: &Certificates,
    BoxesRequest { q, level }: &BoxesRequest,
) -> Result<BoxesAnswer, ViewError> {
    let hierarchy = &certificates.parts().hierarchy;
    let levels = hierarchy.levels();
    let missing = || {
        ViewError::Request(format!("there is no level {level}: the hierarchy has {} levels", levels.len()))
    };
    let nodes = &hierarchy.nodes()[levels.get(*level).ok_or_else(missing)?.clone()];
    let (positions, faces) = (model.positions(q)?, model.mesh().faces());
    let of = |node| {
        let corners = hierarchy.triangles(node).iter().flat_map(|t| faces[*t as usize]);
        let (min, max) = corners
            .map(|v| positions[v as usize])
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        [min.x, min.y, min.z, max.x, max.y, max.z]
    };
    Ok(BoxesAnswer { boxes: nodes.iter().map(of).collect() })
}
