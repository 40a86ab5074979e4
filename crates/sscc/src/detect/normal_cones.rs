//! Normal cones (Volino and Magnenat-Thalmann 1994), the comparator of the paper's section 7: proofs that a patch of the
//! surface does not collide with itself.
//!
//! A patch of the surface is not tested against itself when all of its normals are on the positive side of one of 14
//! directions: the corners and the face centres of a cube. A cone is represented by one bit for each of these
//! directions. That alone is no proof. It is a proof with the *contour test*: the patch is one oriented manifold with a
//! single boundary, and the boundary, projected along the direction, does not intersect itself. Then the projection is
//! one to one: a point off all projected edges is covered as often as the boundary winds around it, which for a simple
//! curve is once or never. Suppose two points of the patch had the same projection. If both were on the boundary, it
//! would intersect itself. Otherwise one is an inner point, so the patch covers a whole neighbourhood there; near the
//! other point it covers part of that a second time.

use glam::DVec3;

use super::contour_test::{ROUNDING, is_simple};
use super::node_volumes::NodeVolumes;
use crate::hierarchy::Hierarchy;

/// A direction, and two linear functions that together project along it.
struct Direction {
    v: DVec3,
    onto: [DVec3; 2],
}

const fn face(v: DVec3, a: DVec3, b: DVec3) -> Direction {
    Direction { v, onto: [a, b] }
}

const fn corner(x: f64, y: f64, z: f64) -> Direction {
    Direction { v: DVec3::new(x, y, z), onto: [DVec3::new(x, -y, 0.0), DVec3::new(0.0, y, -z)] }
}

/// Directions to the face centres and corners of a cube.
const DIRECTIONS: [Direction; 14] = [
    face(DVec3::X, DVec3::Y, DVec3::Z),
    face(DVec3::NEG_X, DVec3::Y, DVec3::Z),
    face(DVec3::Y, DVec3::Z, DVec3::X),
    face(DVec3::NEG_Y, DVec3::Z, DVec3::X),
    face(DVec3::Z, DVec3::X, DVec3::Y),
    face(DVec3::NEG_Z, DVec3::X, DVec3::Y),
    corner(1.0, 1.0, 1.0),
    corner(1.0, 1.0, -1.0),
    corner(1.0, -1.0, 1.0),
    corner(1.0, -1.0, -1.0),
    corner(-1.0, 1.0, 1.0),
    corner(-1.0, 1.0, -1.0),
    corner(-1.0, -1.0, 1.0),
    corner(-1.0, -1.0, -1.0),
];

/// The normals of all nodes down to buckets at the current q.
#[derive(Clone)]
pub(crate) struct NormalCones {
    /// Whether nodes are culled only with the contour test. Without it, cones cull a node by its normals alone, which may miss
    /// collisions.
    has_contour_test: bool,
    /// For each node the directions on whose positive side all of its normals are, one bit each.
    positive: Vec<u16>,
    /// Scratch: a projected boundary.
    projected: Vec<[f64; 2]>,
    /// Scratch: an order of the edges of a boundary.
    order: Vec<u32>,
}

impl NormalCones {
    /// Creates the cones of this number of nodes.
    pub(crate) fn new(nodes: usize) -> Self {
        Self { has_contour_test: true, positive: vec![0; nodes], projected: Vec::new(), order: Vec::new() }
    }

    /// Returns the same cones without the contour test: the approximate cones of the paper's section 7.
    pub(crate) fn without_contour_test(self) -> Self {
        Self { has_contour_test: false, ..self }
    }

    /// Updates the normals from the exact positions, which must be current.
    pub(super) fn update<const E: usize>(&mut self, hierarchy: &Hierarchy, volumes: &NodeVolumes<E>) {
        let buckets = &volumes.layout.buckets;
        for (n, node) in hierarchy.nodes().iter().enumerate().rev() {
            self.positive[n] = match buckets.of_node(n as u32) {
                Some(bucket) if buckets.node(bucket) == n as u32 => {
                    let packets = buckets.packets(bucket);
                    let slots = buckets.slots(packets.start).start..buckets.slots(packets.end - 1).end;
                    let corners = buckets.corners()[slots].iter();
                    corners.fold(!0, |all, corners| {
                        let [a, b, c] = corners.map(|v| volumes.position(v));
                        all & positive_sides(a, b, c)
                    })
                }
                // Traversals do not visit nodes within a bucket.
                Some(_) => 0,
                None => node.children().fold(!0, |all, child| {
                    let of_child = self.positive[child as usize];
                    with_mutant!(all & of_child, ConeOfLastChild, of_child)
                }),
            };
        }
    }

    /// Whether the cones cull a node. With the contour test this is a proof that it does not collide with itself.
    pub(super) fn cull<const E: usize>(&mut self, n: u32, volumes: &NodeVolumes<E>) -> bool {
        let positive = self.positive[n as usize];
        if positive == 0 || !self.has_contour_test {
            return positive != 0;
        }
        let boundary = volumes.layout.boundaries.of_node(n);
        DIRECTIONS.iter().enumerate().filter(|(k, _)| positive >> k & 1 != 0).any(|(_, direction)| {
            self.projected.clear();
            let positions = boundary.iter().map(|v| volumes.position(*v));
            self.projected.extend(positions.map(|x| direction.onto.map(|f| f.dot(x))));
            is_simple(&self.projected, &mut self.order)
        })
    }
}

/// Returns the directions on whose positive side the normal of a triangle certainly is. The corners are separate arguments
/// in place of an array for speed (docs/notes/broad-phase.md#normal-cones).
#[inline]
fn positive_sides(a: DVec3, b: DVec3, c: DVec3) -> u16 {
    let (e, f) = (b - a, c - a);
    let normal = e.cross(f);
    let (x, y) = (e.abs(), f.abs());
    let size = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
    let bits = DIRECTIONS.iter().enumerate().map(|(k, direction)| {
        // Up to six products may underflow.
        let error = ROUNDING * size.dot(direction.v.abs()) + f64::MIN_POSITIVE;
        u16::from(normal.dot(direction.v) > with_mutant!(error, ConeSidesExact, 0.0)) << k
    });
    bits.fold(0, |all, bit| all | bit)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::detect::layout::{Layout, Needs};
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::filter::PairFilter;
    use crate::{ContactFilter, Modes, ReducedModel, test_models};

    #[test]
    fn positive_sides_are_those_of_the_normal() {
        let up = positive_sides(DVec3::ZERO, DVec3::X, DVec3::Y);
        for (k, direction) in DIRECTIONS.iter().enumerate() {
            assert_eq!(up >> k & 1 == 1, direction.v.z > 0.0);
            assert!(direction.onto.iter().all(|f| f.dot(direction.v) == 0.0));
            assert!(direction.onto[0].cross(direction.onto[1]).length() > 0.5);
        }
        assert_eq!(positive_sides(DVec3::ZERO, DVec3::X, DVec3::X * 2.0), 0);
        let x = DVec3::splat(1.0 / 3.0);
        assert_eq!(positive_sides(x, x, x), 0);
        assert_eq!(positive_sides(DVec3::ZERO, DVec3::X * 1e-200, DVec3::Y * 1e-200), 0);
    }

    /// The triangles are needles whose computed normals consist of rounding; the exact sides are computed with integers.
    #[test]
    fn certain_sides_are_right() {
        let mut seed = 7_u64;
        let mut number = move |size: i64| {
            seed = seed.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (seed >> 12) as i64 % (2 * size + 1) - size
        };
        let (mut certain, mut open) = (0, 0);
        for case in 0..20_000 {
            let noise = 1 << (case % 20);
            let mut vector = |size| [(); 3].map(|()| number(size));
            let (a, along, off) = (vector(1 << 51), vector(1 << 50), vector(noise));
            let corners = [0, 1, 3].map(|t: i64| {
                std::array::from_fn::<i64, 3, _>(|i| a[i] + t * along[i] + if t == 3 { off[i] } else { 0 })
            });
            let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(|x| x as f64)));
            let sides = positive_sides(a, b, c);
            let [e, f] = [1, 2].map(|j| {
                std::array::from_fn::<i128, 3, _>(|i| i128::from(corners[j][i]) - i128::from(corners[0][i]))
            });
            for (k, direction) in DIRECTIONS.iter().enumerate() {
                let v = direction.v.to_array().map(|x| x as i128);
                let side: i128 = (0..3)
                    .map(|i| v[i] * (e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3]))
                    .sum();
                let is_certain = sides >> k & 1 == 1;
                assert!(side > 0 || !is_certain, "{corners:?}");
                certain += usize::from(is_certain);
                open += usize::from(side > 0 && !is_certain);
            }
        }
        assert!(certain > 50_000 && open > 1000, "{certain} {open}");
    }

    #[test]
    fn only_positive_directions_cull() {
        let mesh = test_models::square(4);
        let modes = Modes::new(1, mesh.rest_positions().to_vec()).unwrap();
        let model = ReducedModel::new(mesh, modes).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let layout = Arc::new(Layout::new(&model, &hierarchy, &filter, Needs::NORMALS));
        let mut volumes = NodeVolumes::<1>::new(&layout, false);
        let q = [0.0];
        volumes.begin(&hierarchy, &DeformedMotion::new([&q[..]], model.check_coordinates(&q).unwrap()));
        let mut cones = NormalCones::new(hierarchy.nodes().len());
        // The contour is simple along z, and a line along x and y.
        for (k, is_culled) in [(0, false), (1, false), (2, false), (3, false), (4, true), (5, true)] {
            cones.positive[0] = 1 << k;
            assert_eq!(cones.cull(0, &volumes), is_culled, "{k}");
        }
    }
}
