//! Boundaries of nodes: for each node that is one manifold patch with one boundary, the vertices around this boundary.

use super::vertex_store::VertexStore;
use crate::TriMesh;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;

/// The boundaries of nodes.
#[derive(Default)]
pub(crate) struct NodeBoundaries {
    /// For each node the start of its boundary, then the end of the last node's.
    starts: Vec<u32>,
    vertices: Vec<u32>,
}

impl NodeBoundaries {
    /// Finds the boundaries of the nodes for which `is_wanted` holds, with vertices by their index in the layout.
    pub(crate) fn new(
        mesh: &TriMesh,
        hierarchy: &Hierarchy,
        filter: &PairFilter,
        store: &VertexStore,
        is_wanted: impl Fn(u32) -> bool,
    ) -> Self {
        // The number of a class may be that of a vertex without triangles.
        let mut index_of_class = vec![0; filter.class_count()];
        for (t, face) in mesh.faces().iter().enumerate() {
            let classes = filter.vertex_classes(t as u32);
            classes
                .iter()
                .zip(face)
                .for_each(|(class, v)| index_of_class[*class as usize] = store.index_of(*v));
        }
        let (mut starts, mut vertices) = (vec![0], Vec::new());
        for (n, node) in hierarchy.nodes().iter().enumerate() {
            if is_wanted(n as u32) {
                let faces = hierarchy.triangles(node).iter().map(|t| filter.vertex_classes(*t));
                let boundary = single_boundary(faces).unwrap_or_default();
                vertices.extend(boundary.into_iter().map(|class| index_of_class[class as usize]));
            }
            starts.push(vertices.len() as u32);
        }
        Self { starts, vertices }
    }

    /// Returns the vertices around the boundary of a node that is one oriented manifold patch with a single boundary; an empty
    /// slice for other nodes.
    pub(crate) fn of_node(&self, n: u32) -> &[u32] {
        &self.vertices[self.starts[n as usize] as usize..self.starts[n as usize + 1] as usize]
    }
}

/// Returns the vertices around the boundary of faces that are an oriented manifold with a single boundary. Closed pieces are ignored.
fn single_boundary(faces: impl Iterator<Item = [u32; 3]>) -> Option<Vec<u32>> {
    // (i, j, k): the edge of a face from i to j, and its third corner.
    let mut edges = Vec::new();
    for [a, b, c] in faces {
        if a == b || b == c || c == a {
            return None;
        }
        edges.extend([(a, b, c), (b, c, a), (c, a, b)]);
    }
    edges.sort_unstable();
    if edges.windows(2).any(|e| (e[0].0, e[0].1) == (e[1].0, e[1].1)) {
        return None;
    }
    let is_boundary =
        |(i, j, _): &(u32, u32, u32)| edges.binary_search_by_key(&(*j, *i), |e| (e.0, e.1)).is_err();
    // Checks that the faces at each vertex are one fan: steps from one face to the next visit all of them.
    for around in edges.chunk_by(|a, b| a.0 == b.0) {
        let start = around.iter().find(|e| is_boundary(e)).unwrap_or(&around[0]).1;
        let (mut at, mut count) = (start, 0);
        while let Ok(face) = around.binary_search_by_key(&at, |e| e.1)
            && count < around.len()
        {
            (at, count) = (around[face].2, count + 1);
            if at == start {
                break;
            }
        }
        if count != around.len() {
            return None;
        }
    }
    // Since the faces at each vertex are one fan, at most one boundary edge starts there, and as many end there.
    let boundary: Vec<_> = edges.iter().filter(|e| is_boundary(e)).collect();
    let mut around = vec![boundary.first()?.0];
    let mut at = boundary[0].1;
    while at != around[0] {
        around.push(at);
        at = boundary[boundary.binary_search_by_key(&at, |e| e.0).ok()?].1;
    }
    (around.len() == boundary.len()).then_some(around)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_oriented_manifolds_with_one_boundary_have_a_boundary() {
        let of = |faces: &[[u32; 3]]| single_boundary(faces.iter().copied());
        assert_eq!(of(&[[4, 7, 5]]), Some(vec![4, 7, 5]));
        assert_eq!(of(&[[0, 1, 2], [2, 1, 3]]), Some(vec![0, 1, 3, 2]));
        let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 1]];
        assert_eq!(of(&fan), Some(vec![1, 2, 3]));
        let no_patches: [&[[u32; 3]]; 7] = [
            &[],
            &[[0, 1, 1]],
            // Faces of different orientations; three faces at an edge; two faces that share only a vertex; two pieces; a closed mesh.
            &[[0, 1, 2], [1, 2, 3]],
            &[[0, 1, 2], [1, 0, 3], [0, 1, 4]],
            &[[0, 1, 2], [0, 3, 4]],
            &[[0, 1, 2], [3, 4, 5]],
            &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
        ];
        no_patches.iter().for_each(|faces| assert_eq!(of(faces), None, "{faces:?}"));
        // A ring has two boundaries.
        let ring: Vec<[u32; 3]> =
            (0..4).flat_map(|i| [[i, (i + 1) % 4, i + 4], [(i + 1) % 4, (i + 1) % 4 + 4, i + 4]]).collect();
        assert_eq!(of(&ring), None);
        // Two closed fans around one vertex.
        let both: Vec<[u32; 3]> =
            fan.into_iter().chain(fan.map(|f| f.map(|v| if v == 0 { 0 } else { v + 3 }))).collect();
        assert_eq!(of(&both), None);
    }
}
