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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::test_models::square;
    use crate::{ContactFilter, Modes, ReducedModel, TriMesh};

    #[test]
    fn nodes_around_are_those_that_share_a_vertex_but_no_triangle() {
        let sheet = square(24);
        // The same sheet, whose triangles have vertices of their own.
        let corners = sheet.faces().iter().flatten().map(|v| sheet.rest_positions()[*v as usize]).collect();
        let faces = (0..sheet.faces().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let split = TriMesh::new(corners, faces).unwrap();
        for mesh in [sheet, split] {
            let modes = Modes::from_matrix(mesh.rest_positions().len(), 1, |_, _| 1e-3).unwrap();
            let model = ReducedModel::new(mesh, modes).unwrap();
            let hierarchy = Hierarchy::build(&model, model.metric());
            let filter = PairFilter::new(&model, &ContactFilter::default().weld(true));
            let touching = TouchingNodes::new(&hierarchy, &filter);
            let (nodes, within) = (hierarchy.nodes(), hierarchy.nodes_within_buckets());
            let classes_of = |n: usize| -> BTreeSet<u32> {
                hierarchy.triangles(&nodes[n]).iter().flat_map(|t| filter.vertex_classes(*t)).collect()
            };
            let classes: Vec<BTreeSet<u32>> = (0..nodes.len()).map(classes_of).collect();
            let own = |n: usize| nodes[n].first_triangle..nodes[n].first_triangle + nodes[n].triangle_count;
            let (mut larger, mut parts) = (0, 0);
            for n in (0..nodes.len()).filter(|n| !within[*n]) {
                let is_around = |m: &u32| {
                    let m = *m as usize;
                    let is_apart = own(m).end <= own(n).start || own(n).end <= own(m).start;
                    let is_listed = match nodes[m].fits_in_bucket() {
                        true => !within[m],
                        false => nodes[m].triangle_count <= nodes[n].triangle_count,
                    };
                    is_apart && is_listed && !classes[m].is_disjoint(&classes[n])
                };
                let expected: Vec<u32> = (0..nodes.len() as u32).filter(is_around).collect();
                let found = touching.around(n as u32);
                assert_eq!(found, expected, "node {n}");
                for m in &found {
                    let has_parent = found.iter().any(|p| nodes[*p as usize].children().contains(m));
                    assert_eq!(touching.has_parent(*m, &found), has_parent, "nodes {n} {m}");
                    larger += usize::from(!nodes[*m as usize].fits_in_bucket());
                    parts += usize::from(has_parent);
                }
            }
            assert!(larger > 0 && parts > 0, "{larger} {parts}");
        }
    }
}
