//! Connected components of a mesh, and which of them are closed.

use std::collections::HashMap;

use glam::DVec3;

use crate::disjoint_sets::DisjointSets;
use crate::filter::PairFilter;

/// The connected components of a mesh, whose welded vertices are one.
#[derive(Clone, Debug)]
pub(super) struct Components {
    /// For each triangle the number of its component.
    of_triangles: Vec<u32>,
    all: Vec<Component>,
}

#[derive(Clone, Debug)]
struct Component {
    /// One of its triangles.
    triangle: u32,
    /// Whether its triangles run along each edge as often in one direction as in the other: it has an inside.
    is_closed: bool,
}

impl Components {
    pub fn new(filter: &PairFilter) -> Self {
        let triangles = 0..filter.faces().len() as u32;
        let mut sets = DisjointSets::new(filter.class_count());
        for [a, b, c] in triangles.clone().map(|t| filter.vertex_classes(t)) {
            sets.unite(a, b);
            sets.unite(a, c);
        }
        let (mut all, mut numbers) = (Vec::new(), HashMap::new());
        let of_triangles: Vec<u32> = triangles
            .clone()
            .map(|triangle| {
                *numbers.entry(sets.find(filter.vertex_classes(triangle)[0])).or_insert_with(|| {
                    all.push(Component { triangle, is_closed: true });
                    all.len() as u32 - 1
                })
            })
            .collect();
        // Edges with their direction, and a triangle. An edge of one vertex cancels.
        let mut edges: Vec<([u32; 2], i32, u32)> = triangles
            .flat_map(|t| {
                let [a, b, c] = filter.vertex_classes(t);
                let own = [[a, b], [b, c], [c, a]].into_iter().filter(|[u, v]| u != v);
                own.map(move |[u, v]| ([u.min(v), u.max(v)], if u < v { 1 } else { -1 }, t))
            })
            .collect();
        edges.sort_unstable();
        for same in edges.chunk_by(|x, y| x.0 == y.0) {
            let component = of_triangles[same[0].2 as usize] as usize;
            all[component].is_closed &= same.iter().map(|edge| edge.1).sum::<i32>() == 0;
        }
        Self { of_triangles, all }
    }

    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// A triangle of each component.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.all.iter().map(|component| component.triangle)
    }

    /// For each triangle whether it is part of a closed component. One whose welded vertices are apart at these positions is open.
    pub fn closed_triangles(&self, filter: &PairFilter, positions: &[DVec3]) -> Vec<bool> {
        let mut is_closed: Vec<bool> = self.all.iter().map(|component| component.is_closed).collect();
        let mut of_classes = vec![None; filter.class_count()];
        for (t, (face, component)) in filter.faces().iter().zip(&self.of_triangles).enumerate() {
            for (v, class) in face.iter().zip(filter.vertex_classes(t as u32)) {
                let x = positions[*v as usize];
                is_closed[*component as usize] &= *of_classes[class as usize].get_or_insert(x) == x;
            }
        }
        self.of_triangles.iter().map(|component| is_closed[*component as usize]).collect()
    }
}
