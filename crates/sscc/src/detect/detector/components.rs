//! Connected components of a mesh, and which of them are closed.

use std::collections::HashMap;

use crate::disjoint_sets::DisjointSets;

/// The connected components of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Components {
    /// For each triangle the number of its component.
    of_triangles: Vec<u32>,
    all: Vec<Component>,
    /// For each triangle the number of its part: parts are joined by edges, and components by vertices as well.
    parts: Vec<u32>,
}

#[derive(Clone, Debug)]
struct Component {
    /// One triangle of the component.
    triangle: u32,
    /// Whether its triangles run along each edge as often in one direction as in the other, so that it has an inside.
    is_closed: bool,
}

impl Components {
    /// Finds the components of triangles whose corners have these numbers.
    pub fn new(corners: &[[u32; 3]]) -> Self {
        let triangles = 0..corners.len() as u32;
        let count = corners.iter().flatten().max().map_or(0, |most| *most as usize + 1);
        let mut sets = DisjointSets::new(count);
        for [a, b, c] in corners.iter().copied() {
            sets.unite(a, b);
            sets.unite(a, c);
        }
        let (mut all, mut numbers) = (Vec::new(), HashMap::new());
        let of_triangles: Vec<u32> = triangles
            .clone()
            .map(|triangle| {
                *numbers.entry(sets.find(corners[triangle as usize][0])).or_insert_with(|| {
                    all.push(Component { triangle, is_closed: true });
                    all.len() as u32 - 1
                })
            })
            .collect();
        // Edges with their direction, and a triangle. The direction of an edge from a vertex to itself cancels.
        let mut edges: Vec<([u32; 2], i32, u32)> = triangles
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
            let component = of_triangles[same[0].2 as usize] as usize;
            let is_balanced = same.iter().map(|edge| edge.1).sum::<i32>() == 0;
            all[component].is_closed &= with_mutant!(is_balanced, OpenIsClosed, true);
        }
        let mut parts: Vec<u32> = Vec::with_capacity(corners.len());
        let mut count = 0;
        for triangle in 0..corners.len() as u32 {
            let first = along_edges.find(triangle);
            let number = if first == triangle { count } else { parts[first as usize] };
            count += u32::from(first == triangle);
            parts.push(number);
        }
        Self { of_triangles, all, parts }
    }

    /// Returns for each triangle the number of its part. Parts consist of triangles that common edges join, directly or through
    /// others. A part of a closed component is closed.
    pub fn parts(&self) -> &[u32] {
        with_mutant!(&self.parts, PartsJoinInVertices, &self.of_triangles)
    }

    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Returns one triangle of each component.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.all.iter().map(|component| component.triangle)
    }

    /// Returns the number of the component of a triangle.
    pub fn of_triangle(&self, triangle: u32) -> usize {
        self.of_triangles[triangle as usize] as usize
    }

    pub fn has_closed(&self) -> bool {
        self.all.iter().any(|component| component.is_closed)
    }

    /// Whether there are components, and all of them are closed.
    pub fn are_closed(&self) -> bool {
        !self.all.is_empty() && self.all.iter().all(|component| component.is_closed)
    }

    /// Whether a triangle is part of a closed component.
    pub fn is_closed(&self, triangle: u32) -> bool {
        self.all[self.of_triangle(triangle)].is_closed
    }
}
