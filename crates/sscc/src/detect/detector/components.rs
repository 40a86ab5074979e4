//! The connected components of a mesh and their parts, and which of the parts are closed.

use std::collections::HashMap;

use crate::disjoint_sets::DisjointSets;

/// The connected components of a mesh, and their parts. Parts consist of triangles that common edges join, directly or through
/// others; components are joined by vertices as well.
#[derive(Clone, Debug)]
pub(super) struct Components {
    /// The first triangle of each component.
    triangles: Vec<u32>,
    /// For each triangle the number of its part.
    parts: Vec<u32>,
    /// For each part, whether its triangles run along each edge as often in one direction as in the other, so that it has an
    /// inside.
    is_closed: Vec<bool>,
}

impl Components {
    /// Finds the components and parts of triangles whose corners have these numbers.
    pub fn new(corners: &[[u32; 3]]) -> Self {
        let all = 0..corners.len() as u32;
        let count = corners.iter().flatten().max().map_or(0, |most| *most as usize + 1);
        let mut sets = DisjointSets::new(count);
        for [a, b, c] in corners.iter().copied() {
            sets.unite(a, b);
            sets.unite(a, c);
        }
        // For each triangle the first one of its component.
        let mut firsts = HashMap::new();
        let first = |t: u32| *firsts.entry(sets.find(corners[t as usize][0])).or_insert(t);
        let firsts: Vec<u32> = all.clone().map(first).collect();
        let triangles = all.clone().filter(|t| firsts[*t as usize] == *t).collect();
        // Edges with their direction, and a triangle. The direction of an edge from a vertex to itself cancels.
        let mut edges: Vec<([u32; 2], i32, u32)> = all
            .clone()
            .flat_map(|t| {
                let [a, b, c] = corners[t as usize];
                let own = [[a, b], [b, c], [c, a]].into_iter().filter(|[u, v]| u != v);
                own.map(move |[u, v]| ([u.min(v), u.max(v)], if u < v { 1 } else { -1 }, t))
            })
            .collect();
        edges.sort_unstable();
        let mut along_edges = DisjointSets::new(corners.len());
        for same in edges.chunk_by(|x, y| x.0 == y.0) {
            same.windows(2).for_each(|pair| along_edges.unite(pair[0].2, pair[1].2));
        }
        let (mut parts, mut is_closed): (Vec<u32>, Vec<bool>) = (Vec::new(), Vec::new());
        for triangle in all {
            let first =
                with_mutant!(along_edges.find(triangle), PartsJoinInVertices, firsts[triangle as usize]);
            let is_new = first == triangle;
            parts.push(if is_new { is_closed.len() as u32 } else { parts[first as usize] });
            is_closed.extend(is_new.then_some(true));
        }
        for same in edges.chunk_by(|x, y| x.0 == y.0) {
            let is_balanced = same.iter().map(|edge| edge.1).sum::<i32>() == 0;
            is_closed[parts[same[0].2 as usize] as usize] &= with_mutant!(is_balanced, OpenIsClosed, true);
        }
        Self { triangles, parts, is_closed }
    }

    /// Returns the number of components.
    pub fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the first triangle of each component.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Returns for each triangle the number of its part.
    pub fn parts(&self) -> &[u32] {
        &self.parts
    }

    /// Whether a part is closed.
    pub fn has_closed(&self) -> bool {
        self.is_closed.contains(&true)
    }

    /// Whether there are parts, and all of them are closed.
    pub fn are_closed(&self) -> bool {
        self.has_closed() && !self.is_closed.contains(&false)
    }

    /// Returns whether the part of a triangle is closed.
    pub fn is_closed(&self, triangle: u32) -> bool {
        self.is_closed[self.parts[triangle as usize] as usize]
    }
}
