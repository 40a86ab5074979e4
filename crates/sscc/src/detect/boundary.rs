//! Boundaries of nodes as patches of the surface, and the contour test: whether a boundary, projected to a plane, intersects
//! itself.

use super::vertex_store::VertexStore;
use crate::TriMesh;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;

/// Rounding bound of a sum of two products of differences, relative to the sum of their magnitudes: each difference and
/// product is rounded once, and they are added up.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The boundaries of nodes.
#[derive(Default)]
pub(crate) struct NodeBoundaries {
    /// For each node the start of its boundary, and the end of all.
    starts: Vec<u32>,
    vertices: Vec<u32>,
}

impl NodeBoundaries {
    /// The boundaries of the nodes for which `is_wanted` holds; each vertex by its index in the layout.
    pub(crate) fn new(
        mesh: &TriMesh,
        hierarchy: &Hierarchy,
        filter: &PairFilter,
        store: &VertexStore,
        is_wanted: impl Fn(u32) -> bool,
    ) -> Self {
        // A class may be named after a vertex that no triangle has.
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

    /// The vertices around the boundary of a node that is one oriented manifold patch with a single boundary; none for
    /// other nodes.
    pub(crate) fn of_node(&self, n: u32) -> &[u32] {
        &self.vertices[self.starts[n as usize] as usize..self.starts[n as usize + 1] as usize]
    }
}

/// The vertices around the boundary of faces that are an oriented manifold with a single boundary, closed pieces apart.
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
    // The faces at each vertex are one fan: going from one to the next visits all of them.
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
    // One fan: at most one of these edges starts at each vertex, and as many end there.
    let boundary: Vec<_> = edges.iter().filter(|e| is_boundary(e)).collect();
    let mut around = vec![boundary.first()?.0];
    let mut at = boundary[0].1;
    while at != around[0] {
        around.push(at);
        at = boundary[boundary.binary_search_by_key(&at, |e| e.0).ok()?].1;
    }
    (around.len() == boundary.len()).then_some(around)
}

/// Whether a closed polygon in the plane certainly does not intersect itself. Its coordinates are rounded once; `order` is
/// scratch.
pub(crate) fn is_simple(polygon: &[[f64; 2]], order: &mut Vec<u32>) -> bool {
    let count = polygon.len();
    let next = |i: usize| if i + 1 == count { 0 } else { i + 1 };
    let end = |i: usize| polygon[next(i)];
    // More than rounding may have moved any coordinate by.
    let reach = polygon.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let moved = right_or!(f64::EPSILON * reach, ContourCoordinatesExact, 0.0);
    let low = |i: usize, axis: usize| polygon[i][axis].min(end(i)[axis]);
    let high = |i: usize, axis: usize| polygon[i][axis].max(end(i)[axis]) + 2.0 * moved;
    order.clear();
    order.extend(0..count as u32);
    order.sort_unstable_by(|a, b| low(*a as usize, 0).total_cmp(&low(*b as usize, 0)));
    for (at, &i) in order.iter().enumerate() {
        let i = i as usize;
        for &j in &order[at + 1..] {
            let j = j as usize;
            if low(j, 0) > high(i, 0) {
                break;
            }
            let is_free = if next(i) == j {
                go_on(polygon[i], polygon[j], end(j), moved)
            } else if next(j) == i {
                go_on(polygon[j], polygon[i], end(i), moved)
            } else {
                low(j, 1) > high(i, 1)
                    || low(i, 1) > high(j, 1)
                    || on_one_side(polygon[i], end(i), [polygon[j], end(j)], moved)
                    || on_one_side(polygon[j], end(j), [polygon[i], end(i)], moved)
            };
            if !is_free {
                return false;
            }
        }
    }
    count > 2
}

/// The error bound of two products of differences, each difference with an error of at most `2 moved`.
///
/// Let m be the largest magnitude of a coordinate and u = 2^-53, so that `moved = 2 u m`. Coordinates are off by `u m`,
/// a difference of two by `moved`, and it is itself rounded by at most `moved`, since it is at most `2 m`. So two products
/// are off by at most `2 moved reach + 8 moved^2`. The magnitudes of the products add up to at most `m reach`; rounding
/// them and their sum adds `2 u m reach = moved reach`. The second term alone is a third larger than all of this: without
/// the first the test would be right as well.
fn error([ux, uy]: [f64; 2], [vx, vy]: [f64; 2], products: f64, moved: f64) -> f64 {
    let reach = ux.abs() + uy.abs() + vx.abs() + vy.abs();
    let products = right_or!(ROUNDING * products, ContourProductsExact, 0.0);
    right_or!(products + 4.0 * moved * (reach + 4.0 * moved) + f64::MIN_POSITIVE, ContourExact, 0.0)
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

/// The sign of the area of a triangle, where it is certain; else 0.
fn area_sign(a: [f64; 2], b: [f64; 2], c: [f64; 2], moved: f64) -> f64 {
    let (u, v) = (difference(a, b), difference(a, c));
    let (p, q) = (u[0] * v[1], u[1] * v[0]);
    let area = p - q;
    if area.abs() > error(u, v, p.abs() + q.abs(), moved) { area.signum() } else { 0.0 }
}

/// Whether two points are certainly on the same side of a line, and not on it.
fn on_one_side(a: [f64; 2], b: [f64; 2], points: [[f64; 2]; 2], moved: f64) -> bool {
    let [x, y] = points.map(|p| area_sign(a, b, p, moved));
    x * y > 0.0
}

/// Whether two edges, a to b and b to c, certainly have b alone in common: c is off the line, or ahead.
fn go_on(a: [f64; 2], b: [f64; 2], c: [f64; 2], moved: f64) -> bool {
    let (u, v) = (difference(a, b), difference(b, c));
    let (p, q) = (u[0] * v[0], u[1] * v[1]);
    area_sign(a, b, c, moved) != 0.0 || p + q > error(u, v, p.abs() + q.abs(), moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_that_meet_themselves_are_not_simple() {
        let is_simple = |polygon: &[[f64; 2]]| is_simple(polygon, &mut Vec::new());
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert!(is_simple(&square));
        let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
        let touching = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
        let back = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 2.0]];
        let twice = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let pointed = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        for polygon in [&bow[..], &touching, &back, &twice, &pointed, &square[..2]] {
            for first in 0..polygon.len() {
                let mut polygon = polygon.to_vec();
                polygon.rotate_left(first);
                assert!(!is_simple(&polygon), "{polygon:?}");
                // Neither are they where rounding hides it.
                let moved = |[x, y]: &[f64; 2]| [x / 3.0 + 1e9, y / 3.0 + 1e9];
                assert!(!is_simple(&polygon.iter().map(moved).collect::<Vec<_>>()), "{polygon:?}");
            }
        }
        // Straight on is no way back.
        assert!(is_simple(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]));
    }

    /// A corner lies exactly on the first edge; the coordinates are rounded once, also those of small polygons far from
    /// the origin. Where rounding takes the corner off the edge the polygon would be simple.
    #[test]
    fn rounding_separates_nothing_that_touches() {
        let mut state = 1_u64;
        let mut integer = |size: i128| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (i128::from((state >> 11) as i64 - (1_i64 << 52)) * size) >> 52
        };
        let mut rounded = 0;
        for case in 0..3000 {
            let (size, far) = [(1 << 56, 0), (1 << 40, 1 << 70)][case % 2];
            let mut vector = |size| [integer(size), integer(size)];
            let (middle, step) = (vector(far), vector(size));
            // Corners in units of the edge and of a vector askew to it.
            let up = [-step[1] + step[0] / 3, step[0] + step[1] / 5];
            let corners = [(0, 0), (4, 0), (5, 2), (1 + case as i128 / 2 % 3, 0), (-1, 3)];
            let polygon: Vec<[i128; 2]> = corners
                .iter()
                .map(|(x, y)| std::array::from_fn(|i| middle[i] + x * step[i] + y * up[i]))
                .collect();
            let mut moved = false;
            let mut near: Vec<[f64; 2]> = polygon.iter().map(|p| p.map(|x| x as f64)).collect();
            polygon.iter().zip(&near).for_each(|(p, near)| moved |= near.map(|x| x as i128) != *p);
            rounded += usize::from(moved);
            near.rotate_left(case % 5);
            assert!(!is_simple(&near, &mut Vec::new()), "case {case}: {near:?}");
        }
        assert!(rounded > 2500, "{rounded}");
    }

    #[test]
    fn patches_with_a_single_boundary() {
        let of = |faces: &[[u32; 3]]| single_boundary(faces.iter().copied());
        assert_eq!(of(&[[4, 7, 5]]), Some(vec![4, 7, 5]));
        assert_eq!(of(&[[0, 1, 2], [2, 1, 3]]), Some(vec![0, 1, 3, 2]));
        let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 1]];
        assert_eq!(of(&fan), Some(vec![1, 2, 3]));
        let no_patches: [&[[u32; 3]]; 7] = [
            &[],
            &[[0, 1, 1]],
            // Oriented differently; three at an edge; two at a vertex alone; two pieces; closed.
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
        // Two fans around one vertex, closed both.
        let both: Vec<[u32; 3]> =
            fan.into_iter().chain(fan.map(|f| f.map(|v| if v == 0 { 0 } else { v + 3 }))).collect();
        assert_eq!(of(&both), None);
    }
}
