//! The hierarchy as the traversal of the normal cones wants it: nodes, below them buckets, below these blocks.

use std::ops::Range;

use sscc::hierarchy::Hierarchy;

use super::aabb8::LANES;

/// What the children of a volume are. From fine to coarse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Up to eight triangles.
    Block,
    /// Up to eight blocks.
    Bucket,
    /// Nodes or buckets.
    Node,
}

/// A set of triangles with up to eight children.
#[derive(Clone, Debug)]
pub struct Volume {
    pub kind: Kind,
    /// Volumes; of a block, places in the hierarchy's order of triangles.
    pub children: Range<usize>,
}

/// The volumes of a hierarchy: the root first, children beyond their parents. Nodes of at most 64 triangles are buckets,
/// cut into full blocks along the hierarchy's order: its own leaves hold four triangles in the mean, half of what one
/// comparison takes.
pub fn volumes(hierarchy: &Hierarchy) -> Vec<Volume> {
    let nodes = hierarchy.nodes();
    // Siblings stay side by side, as none is left out without the others.
    let mut number = vec![None; nodes.len()];
    number[0] = Some(0);
    let mut count = 1;
    for (n, node) in nodes.iter().enumerate() {
        if number[n].is_some() && !node.fits_in_bucket() {
            node.children().for_each(|child| {
                number[child as usize] = Some(count);
                count += 1;
            });
        }
    }
    let mut volumes = Vec::with_capacity(count);
    let mut blocks = Vec::new();
    for (node, _) in nodes.iter().zip(&number).filter(|(_, number)| number.is_some()) {
        let start = node.first_triangle as usize;
        let triangles = start..start + node.triangle_count as usize;
        volumes.push(if node.fits_in_bucket() {
            let first = count + blocks.len();
            blocks.extend(
                triangles.clone().step_by(LANES).map(|from| Volume {
                    kind: Kind::Block,
                    children: from..(from + LANES).min(triangles.end),
                }),
            );
            Volume { kind: Kind::Bucket, children: first..count + blocks.len() }
        } else {
            let first = number[node.first_child as usize].unwrap_or(count);
            Volume { kind: Kind::Node, children: first..first + node.child_count as usize }
        });
    }
    volumes.extend(blocks);
    volumes
}
