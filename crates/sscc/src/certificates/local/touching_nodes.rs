//! Finds the nodes that share a vertex with a node.

use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;

/// For each vertex class the buckets that have it.
pub(super) struct TouchingNodes<'t> {
    hierarchy: &'t Hierarchy,
    filter: &'t PairFilter,
    /// For each node its parent; for the root itself.
    parents: Vec<u32>,
    /// For each vertex class where its buckets start, and the end.
    starts: Vec<u32>,
    buckets: Vec<u32>,
}

impl<'t> TouchingNodes<'t> {
    pub(super) fn new(hierarchy: &'t Hierarchy, filter: &'t PairFilter) -> Self {
        let nodes = hierarchy.nodes();
        let mut parents = vec![0; nodes.len()];
        for (n, node) in nodes.iter().enumerate() {
            node.children().for_each(|child| parents[child as usize] = n as u32);
        }
        let within = hierarchy.nodes_within_buckets();
        let mut of_classes: Vec<(u32, u32)> = Vec::new();
        for n in (0..nodes.len()).filter(|n| !within[*n] && hierarchy.is_bucket_below_root(*n as u32)) {
            let triangles = hierarchy.triangles(&nodes[n]);
            of_classes.extend(
                triangles.iter().flat_map(|&t| filter.vertex_classes(t)).map(|class| (class, n as u32)),
            );
        }
        of_classes.sort_unstable();
        of_classes.dedup();
        let mut starts = vec![0; filter.class_count() + 1];
        of_classes.iter().for_each(|(class, _)| starts[*class as usize + 1] += 1);
        for class in 0..filter.class_count() {
            starts[class + 1] += starts[class];
        }
        let buckets = of_classes.into_iter().map(|(_, bucket)| bucket).collect();
        Self { hierarchy, filter, parents, starts, buckets }
    }

    /// Returns the buckets, and the larger nodes of at most as many triangles as this one, that share a vertex with it but no
    /// triangle; ascending.
    pub(super) fn around(&self, n: u32) -> Vec<u32> {
        let nodes = self.hierarchy.nodes();
        let node = &nodes[n as usize];
        let own = node.first_triangle..node.first_triangle + node.triangle_count;
        let triangles = self.hierarchy.triangles(node).iter();
        let mut classes: Vec<u32> = triangles.flat_map(|&t| self.filter.vertex_classes(t)).collect();
        // Many triangles may share a vertex, which may be in many buckets.
        classes.sort_unstable();
        classes.dedup();
        let mut around: Vec<u32> = classes
            .into_iter()
            .flat_map(|class| {
                let [start, end] = [class, class + 1].map(|class| self.starts[class as usize] as usize);
                &self.buckets[start..end]
            })
            .copied()
            .filter(|bucket| !own.contains(&nodes[*bucket as usize].first_triangle))
            .collect();
        around.sort_unstable();
        around.dedup();
        let mut next = 0;
        while next < around.len() {
            let parent = self.parents[around[next] as usize];
            let size = &nodes[parent as usize];
            let holds_own =
                (size.first_triangle..size.first_triangle + size.triangle_count).contains(&own.start);
            if !holds_own && size.triangle_count <= node.triangle_count {
                around.push(parent);
            }
            next += 1;
        }
        around.sort_unstable();
        around.dedup();
        around
    }

    /// Whether one of these nodes, ascending, is the parent of a node.
    pub(super) fn has_parent(&self, n: u32, nodes: &[u32]) -> bool {
        nodes.binary_search(&self.parents[n as usize]).is_ok()
    }
}
