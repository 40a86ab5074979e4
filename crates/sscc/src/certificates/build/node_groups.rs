//! Decides which node pairs can count by the groups of their triangles, if each node has only one group.

use crate::filter::PairFilter;
use crate::hierarchy::{Hierarchy, NodePair};

/// For each node the group of its triangles, if all have the same. Empty without groups.
pub(crate) struct NodeGroups(Vec<Option<u16>>);

impl NodeGroups {
    /// Determines the groups of all nodes.
    pub(crate) fn new(filter: &PairFilter, hierarchy: &Hierarchy) -> Self {
        let Some(groups) = filter.groups() else { return Self(Vec::new()) };
        let mut of_nodes = vec![None; hierarchy.nodes().len()];
        // Parents come before their children.
        for (n, node) in hierarchy.nodes().iter().enumerate().rev() {
            let mut of_parts: Box<dyn Iterator<Item = Option<u16>>> = if node.is_leaf() {
                let triangles = hierarchy.triangles(node).iter();
                Box::new(triangles.map(|t| Some(groups.of_triangles()[*t as usize])))
            } else {
                Box::new(node.children().map(|child| of_nodes[child as usize]))
            };
            let first = of_parts.next().flatten();
            let group = first
                .filter(|_| with_mutant!(of_parts.all(|other| other == first), NodeGroupOfFirstPart, true));
            drop(of_parts);
            of_nodes[n] = group;
        }
        Self(of_nodes)
    }

    /// Whether a triangle pair of two nodes may count. The filter is that of [`NodeGroups::new`].
    #[inline]
    pub(crate) fn can_count(&self, filter: &PairFilter, (n, m): NodePair) -> bool {
        let Some(groups) = filter.groups().filter(|_| !self.0.is_empty()) else { return true };
        match [n, m].map(|n| self.0[n as usize]) {
            [Some(g), Some(h)] => groups.is_counted(g, h),
            _ => true,
        }
    }
}
