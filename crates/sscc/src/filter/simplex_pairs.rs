//! Simplex pairs: edges and triangles that replace a triangle pair in bounds and in continuous tests.

use glam::DVec3;

use super::contact_filter::Pair;
use super::pair_filter::{PairFilter, Relation};

/// A simplex of triangle a and one of triangle b: the triangle itself or an edge of it, with one vertex twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SimplexPair<T> {
    pub(crate) a: [T; 3],
    pub(crate) b: [T; 3],
}

/// All corners of a triangle.
const TRIANGLE: [usize; 3] = [0, 1, 2];

/// Both triangles as they are.
const TRIANGLES: [Option<SimplexPair<usize>>; 2] = [Some(SimplexPair { a: TRIANGLE, b: TRIANGLE }), None];

impl PairFilter {
    /// Returns the simplex pairs (by vertices) that replace a triangle pair in bounds: if the pair collides, at least
    /// one of its simplex pairs meets. A shared-vertex pair has two: of each triangle the edge opposite to the vertex,
    /// with the other triangle. Proof: follow the ray from the vertex through a common point until it leaves the first
    /// of the two triangles.
    pub(crate) fn simplex_pairs(&self, a: u32, b: u32) -> impl Iterator<Item = SimplexPair<u32>> {
        let (face_a, face_b) = (self.faces[a as usize], self.faces[b as usize]);
        self.simplex_pairs_of_corners(a, b).map(move |corners| SimplexPair {
            a: corners.a.map(|i| face_a[i]),
            b: corners.b.map(|i| face_b[i]),
        })
    }

    /// Returns the same pairs by the corners (0 to 2) of each triangle.
    pub(crate) fn simplex_pairs_of_corners(
        &self,
        a: u32,
        b: u32,
    ) -> impl Iterator<Item = SimplexPair<usize>> {
        let pairs = match self.relation(a, b) {
            Relation::Adjacent => [None, None],
            // Models and continuous queries refuse filters with foldable pairs.
            Relation::NonAdjacent | Relation::Foldable => TRIANGLES,
            Relation::SharedVertex(class) => self.opposite_to_class(class, (a, b)),
        };
        pairs.into_iter().flatten()
    }

    /// Returns the simplex pairs of a shared-vertex pair that moves on straight lines between these corners. Welded vertices may
    /// have moved apart: then the pair has a common vertex only if two corners of the class are at one position at the start and
    /// at the end of the motion, and so at all times.
    pub(crate) fn moving_simplex_pairs(
        &self,
        class: u32,
        pair: Pair,
        [a_t0, a_t1]: [&[DVec3; 3]; 2],
        [b_t0, b_t1]: [&[DVec3; 3]; 2],
    ) -> impl Iterator<Item = SimplexPair<usize>> {
        let pairs = if self.is_vertex_shared(class, pair, a_t0, b_t0)
            && with_mutant!(self.is_vertex_shared(class, pair, a_t1, b_t1), MovingVertexSharedAtStart, true)
        {
            self.opposite_to_class(class, pair)
        } else {
            let (classes_a, classes_b) = (self.classes[pair.0 as usize], self.classes[pair.1 as usize]);
            let mut corners = (0..9).map(|n| (n / 3, n % 3));
            let common = corners.find(|&(i, j)| {
                let is_together = || a_t0[i] == b_t0[j] && a_t1[i] == b_t1[j];
                classes_a[i] == class && classes_b[j] == class && is_together()
            });
            let Some((i, j)) = common else { return TRIANGLES.into_iter().flatten() };
            // The corners that are not always at the common vertex: two, or one twice.
            let edge = |corner: usize, classes: [u32; 3], [t0, t1]: [&[DVec3; 3]; 2]| {
                let is_at_vertex =
                    |k: usize| classes[k] == class && t0[k] == t0[corner] && t1[k] == t1[corner];
                let mut others = (1..3).map(|k| (corner + k) % 3).filter(|k| !is_at_vertex(*k));
                let first = others.next()?;
                Some([first, others.next().unwrap_or(first)])
            };
            match (edge(i, classes_a, [a_t0, a_t1]), edge(j, classes_b, [b_t0, b_t1])) {
                (Some(edge_a), Some(edge_b)) => edges_and_triangles(edge_a, edge_b),
                // All corners of one face are at the vertex.
                _ => [None, None],
            }
        };
        pairs.into_iter().flatten()
    }

    /// Returns the edges opposite to a vertex class, each with the other triangle. None if all corners of a face are of the
    /// class.
    fn opposite_to_class(&self, class: u32, (a, b): Pair) -> [Option<SimplexPair<usize>>; 2] {
        match (self.opposite_edge(a, class), self.opposite_edge(b, class)) {
            (Some(edge_a), Some(edge_b)) => edges_and_triangles(edge_a, edge_b),
            _ => [None, None],
        }
    }

    /// Returns the corners (0 to 2) of a face that are not of the class: two, or one twice.
    pub(super) fn opposite_edge(&self, face: u32, class: u32) -> Option<[usize; 2]> {
        let classes = self.classes[face as usize];
        let mut others = (0..3).filter(|&i| classes[i] != class);
        let first = others.next()?;
        Some([first, others.next().unwrap_or(first)])
    }
}

/// Returns the pairs of an edge of each triangle and the whole other triangle.
fn edges_and_triangles(edge_a: [usize; 2], edge_b: [usize; 2]) -> [Option<SimplexPair<usize>>; 2] {
    let edge = |[i, j]: [usize; 2]| [i, j, j];
    [
        Some(SimplexPair { a: edge(edge_a), b: TRIANGLE }),
        with_mutant!(Some(SimplexPair { a: TRIANGLE, b: edge(edge_b) }), OneSimplexPairOfTwo, None),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;
    use crate::{ContactFilter, Neighbours};

    /// Two corners of the class are one vertex if they are together at start and end. What remains of each triangle is the set
    /// of its corners that are not always there, and meets the whole other triangle. Corners are at two positions, so that they
    /// often meet at one of the ends, or at both.
    #[test]
    fn moving_triangles_share_vertices_that_stay_together() {
        let random = &mut Random(12);
        let contact_filter = ContactFilter::new(Neighbours::IncludeOneVertex);
        let (mut whole, mut none, mut edges) = (0, 0, 0);
        for case in 0..4000 {
            let mut is_of_class = [false; 6].map(|_| random.below(2) == 0);
            is_of_class[random.below(3)] = true;
            is_of_class[3 + random.below(3)] = true;
            let paths = [(); 6].map(|()| [random.below(2), random.below(2)]);
            let classes: Vec<u32> = (0..6).map(|i| if is_of_class[i as usize] { 9 } else { i }).collect();
            let filter = PairFilter::with_classes(&[[0, 1, 2], [3, 4, 5]], Some(&classes), &contact_filter);
            let [a, b] = [0, 3].map(|first| {
                [0, 1].map(|end| [0, 1, 2].map(|i: usize| DVec3::X * paths[first + i][end] as f64))
            });
            let found: Vec<[Vec<usize>; 2]> = filter
                .moving_simplex_pairs(9, (0, 1), [&a[0], &a[1]], [&b[0], &b[1]])
                .map(|simplices| {
                    [simplices.a, simplices.b].map(|corners| {
                        let mut corners = corners.to_vec();
                        corners.sort_unstable();
                        corners.dedup();
                        corners
                    })
                })
                .collect();
            let all = vec![0, 1, 2];
            let pairs = (0..3).flat_map(|i| (3..6).map(move |j| (i, j)));
            let common = pairs
                .filter(|&(i, j)| is_of_class[i] && is_of_class[j])
                .map(|(i, j)| [paths[i], paths[j]])
                .find(|[x, y]| x == y);
            let Some([path, _]) = common else {
                whole += 1;
                assert_eq!(found, [[all.clone(), all]], "case {case}");
                continue;
            };
            let [rest_a, rest_b] = [0, 3].map(|first| -> Vec<usize> {
                (0..3).filter(|i| !is_of_class[first + i] || paths[first + i] != path).collect()
            });
            if rest_a.is_empty() || rest_b.is_empty() {
                none += 1;
                assert!(found.is_empty(), "case {case}");
            } else {
                edges += 1;
                assert_eq!(found, [[rest_a, all.clone()], [all, rest_b]], "case {case}");
            }
        }
        assert!(whole > 1000 && none > 20 && edges > 1000, "{whole} {none} {edges}");
    }
}
