//! Joins segments that share end points into polylines.

/// A segment between two nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Segment {
    pub(super) nodes: [u32; 2],
    /// The number of the contact.
    pub(super) contact: u32,
}

impl Segment {
    /// Returns the node at the other end.
    fn opposite(&self, node: u32) -> u32 {
        if self.nodes[0] == node { self.nodes[1] } else { self.nodes[0] }
    }
}

/// A polyline: nodes, and the contact of each of its segments. A closed one does not repeat its first node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Polyline {
    pub(super) nodes: Vec<u32>,
    pub(super) contacts: Vec<u32>,
}

/// Joins the segments, each between two different nodes below `node_count`, at all nodes with two segments. The polylines
/// are in the order of their lowest contacts. A segment that occurs several times counts once, with its lowest contact.
pub(super) fn join_segments(segments: Vec<Segment>, node_count: usize) -> Vec<Polyline> {
    let segments = unique(segments);
    let joints = Joints::of(&segments, node_count);
    let mut is_joined = vec![false; segments.len()];
    let mut polylines = Vec::new();
    // Open polylines begin at a node that does not have two segments. The closed ones remain.
    for is_open in [true, false] {
        for (first, segment) in segments.iter().enumerate() {
            for node in segment.nodes {
                if !is_joined[first] && (!is_open || joints.at(node).len() != 2) {
                    polylines.push(follow(&segments, &joints, first as u32, node, &mut is_joined));
                }
            }
        }
    }
    polylines.sort_by_cached_key(|polyline| polyline.contacts.iter().min().copied());
    polylines
}

/// Returns each segment once, in the order of contacts.
fn unique(mut segments: Vec<Segment>) -> Vec<Segment> {
    segments.iter_mut().for_each(|segment| segment.nodes.sort_unstable());
    segments.sort_unstable_by_key(|segment| (segment.nodes, segment.contact));
    segments.dedup_by_key(|segment| segment.nodes);
    segments.sort_unstable_by_key(|segment| (segment.contact, segment.nodes));
    segments
}

/// Returns the polyline from a node along a segment, up to a node that does not have two segments or back to the first.
fn follow(segments: &[Segment], joints: &Joints, first: u32, start: u32, is_joined: &mut [bool]) -> Polyline {
    let mut polyline = Polyline { nodes: vec![start], contacts: Vec::new() };
    let (mut segment, mut node) = (first, start);
    loop {
        is_joined[segment as usize] = true;
        polyline.contacts.push(segments[segment as usize].contact);
        node = segments[segment as usize].opposite(node);
        if node == start {
            return polyline;
        }
        polyline.nodes.push(node);
        match *joints.at(node) {
            [before, after] => segment = if before == segment { after } else { before },
            _ => return polyline,
        }
    }
}

/// The segments at each node.
struct Joints {
    /// For each node, where its segments begin; at the end, their number.
    begin: Vec<u32>,
    segments: Vec<u32>,
}

impl Joints {
    fn of(segments: &[Segment], node_count: usize) -> Self {
        let mut begin = vec![0; node_count + 1];
        for node in segments.iter().flat_map(|segment| segment.nodes) {
            begin[node as usize + 1] += 1;
        }
        for node in 0..node_count {
            begin[node + 1] += begin[node];
        }
        let mut next = begin.clone();
        let mut at_nodes = vec![0; 2 * segments.len()];
        for (i, segment) in segments.iter().enumerate() {
            for node in segment.nodes {
                at_nodes[next[node as usize] as usize] = i as u32;
                next[node as usize] += 1;
            }
        }
        Self { begin, segments: at_nodes }
    }

    fn at(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.segments[self.begin[node] as usize..self.begin[node + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn join(segments: &[[u32; 2]]) -> Vec<(Vec<u32>, Vec<u32>)> {
        let segments =
            segments.iter().enumerate().map(|(i, nodes)| Segment { nodes: *nodes, contact: i as u32 });
        let polylines = join_segments(segments.collect(), 10);
        polylines.into_iter().map(|polyline| (polyline.nodes, polyline.contacts)).collect()
    }

    #[test]
    fn segments_join_to_loops_and_to_chains_that_end_at_junctions() {
        assert_eq!(join(&[]), []);
        assert_eq!(join(&[[2, 1], [3, 2], [1, 3]]), [(vec![1, 2, 3], vec![0, 1, 2])]);
        assert_eq!(join(&[[5, 4], [6, 5], [7, 6]]), [(vec![4, 5, 6, 7], vec![0, 1, 2])]);
        // The same segment of several contacts counts once.
        assert_eq!(join(&[[1, 2], [2, 1], [2, 3]]), [(vec![1, 2, 3], vec![0, 2])]);
        // Three segments meet in node 0; one polyline leaves a junction and comes back.
        let star = join(&[[0, 1], [0, 2], [3, 0]]);
        assert_eq!(star, [(vec![0, 1], vec![0]), (vec![0, 2], vec![1]), (vec![0, 3], vec![2])]);
        let lasso = join(&[[9, 0], [0, 1], [1, 2], [2, 0]]);
        assert_eq!(lasso, [(vec![0, 9], vec![0]), (vec![0, 1, 2], vec![1, 2, 3])]);
    }
}
