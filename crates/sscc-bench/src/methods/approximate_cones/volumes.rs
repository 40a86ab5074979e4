//! Hierarchy of the normal cones: nodes, below them buckets, below these packets of triangles.

use std::ops::Range;

use sscc::hierarchy::Hierarchy;

use super::aabb8::LANES;

/// Kind of a volume, from fine to coarse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A packet of up to eight triangles.
    Packet,
    /// A bucket of up to eight packets.
    Bucket,
    /// A node with nodes or buckets as children.
    Node,
}

/// A set of triangles with up to eight children.
#[derive(Clone, Debug)]
pub struct Volume {
    pub kind: Kind,
    /// Indices of volumes; of a packet, slots in the hierarchy's order of triangles.
    pub children: Range<usize>,
}

/// Returns the volumes of a hierarchy: the root first, children after their parents. Nodes of at most 64 triangles are
/// buckets, divided into full packets along the hierarchy's order. Its own leaves have four triangles in the mean, half
/// of a packet.
pub fn volumes(hierarchy: &Hierarchy) -> Vec<Volume> {
    let nodes = hierarchy.nodes();
    // Siblings stay adjacent: they are dropped together or not at all.
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
    let mut packets = Vec::new();
    for (node, _) in nodes.iter().zip(&number).filter(|(_, number)| number.is_some()) {
        let start = node.first_triangle as usize;
        let triangles = start..start + node.triangle_count as usize;
        volumes.push(if node.fits_in_bucket() {
            let first = count + packets.len();
            packets.extend(triangles.clone().step_by(LANES).map(|from| Volume {
                kind: Kind::Packet,
                children: from..(from + LANES).min(triangles.end),
            }));
            Volume { kind: Kind::Bucket, children: first..count + packets.len() }
        } else {
            let first = number[node.first_child as usize].unwrap_or(count);
            Volume { kind: Kind::Node, children: first..first + node.child_count as usize }
        });
    }
    volumes.extend(packets);
    volumes
}
