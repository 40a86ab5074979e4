//! Material depth: signed distances of points from the rest surface, on a grid (Hirota et al. 2000).
//!
//! Values between grid points are interpolated trilinearly. Distances are exact within two cells of the surface. Deeper
//! inside, the nearest triangle is taken from those of the neighbouring grid points. Signs come from angle-weighted
//! pseudonormals (Baerentzen and Aanaes 2005). A surface that is not closed has no inside: its distances end two cells
//! from the surface on both sides.

use std::collections::VecDeque;

use glam::DVec3;
use sscc::TriMesh;

use super::pseudonormals::Pseudonormals;
use crate::nearest_point::nearest_point_triangle;

/// Maximum number of grid points (8 MB). Memory does not grow with the mesh.
const MAX_POINTS: f64 = (1 << 21) as f64;

/// Maximum number of cells along the longest side.
const MAX_CELLS_PER_SIDE: f64 = 192.0;

/// Width of the band on each side of the surface, in cells. Distances in it are exact.
const BAND: f64 = 2.0;

/// Maximum extent of a triangle along an axis, in cells. Larger triangles are split.
const MAX_TRIANGLE_CELLS: f64 = 8.0;

/// Grid of signed distances from a surface.
#[derive(Clone, Debug)]
pub struct DepthField {
    /// Position of the first grid point. All else is relative to it: far from 0, the spacing may be less than the
    /// rounding of a position.
    origin: DVec3,
    spacing: f64,
    /// Number of grid points along each axis.
    size: [usize; 3],
    /// Distances: negative inside, infinite outside the band. x varies fastest.
    distances: Vec<f32>,
}

/// Signed distance of a point from a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDistance {
    /// Distance (model unit), negative inside.
    pub distance: f64,
    /// Derivative of the distance with respect to the position: the direction in which the distance grows, with a
    /// length of about 1.
    pub gradient: DVec3,
}

impl DepthField {
    /// Computes the distances from the rest pose. Signs near the boundary edges of an open surface are undefined. Costs
    /// at most 2^21 grid points of 4 bytes, and time proportional to grid points and triangles.
    pub fn new(mesh: &TriMesh) -> Self {
        let p = mesh.rest_positions();
        let corners = || mesh.faces().as_flattened().iter().map(|v| p[*v as usize]);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = high - low;
        // The band adds two cells on each side, so flat shapes have a few cells across, too.
        let points = |spacing: f64| (extent / spacing).ceil() + 2.0 * BAND + 1.0;
        let mut spacing = (extent.max_element() / MAX_CELLS_PER_SIDE).max(f64::MIN_POSITIVE);
        while points(spacing).element_product() > MAX_POINTS {
            spacing *= 1.05;
        }
        let size = points(spacing).to_array().map(|n| n as usize);
        let origin = low - spacing * BAND;
        let mut field = Self { origin, spacing, size, distances: Vec::new() };
        field.compute_distances(mesh);
        field
    }

    /// Returns the signed distance of a point from the surface; None if the point is outside by more than about two cells.
    pub fn at(&self, x: DVec3) -> Option<SignedDistance> {
        let cell = (x - self.origin) / self.spacing;
        let base = cell.floor();
        let last = DVec3::from_array(self.size.map(|n| n as f64 - 2.0));
        if !(base.cmpge(DVec3::ZERO).all() && base.cmple(last).all()) {
            return None;
        }
        let ([i, j, k], t) = (base.to_array().map(|x| x as usize), cell - base);
        let at = |a: usize, b: usize, c: usize| f64::from(self.distances[self.index([i + a, j + b, k + c])]);
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        // Interpolates along x, then y, then z, with derivatives.
        let x0 = [at(0, 0, 0), at(0, 1, 0), at(0, 0, 1), at(0, 1, 1)];
        let x1 = [at(1, 0, 0), at(1, 1, 0), at(1, 0, 1), at(1, 1, 1)];
        let x: [f64; 4] = std::array::from_fn(|n| mix(x0[n], x1[n], t.x));
        let dx: [f64; 4] = std::array::from_fn(|n| x1[n] - x0[n]);
        let y = [mix(x[0], x[1], t.y), mix(x[2], x[3], t.y)];
        let gradient = DVec3::new(
            mix(mix(dx[0], dx[1], t.y), mix(dx[2], dx[3], t.y), t.z),
            mix(x[1] - x[0], x[3] - x[2], t.z),
            y[1] - y[0],
        );
        let distance = mix(y[0], y[1], t.z);
        distance.is_finite().then_some(SignedDistance { distance, gradient: gradient / self.spacing })
    }

    /// Returns the index of a grid point in `distances`.
    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.size[1] + j) * self.size[0] + i
    }

    /// Returns the position of a grid point, relative to the origin.
    fn point(&self, [i, j, k]: [usize; 3]) -> DVec3 {
        DVec3::new(i as f64, j as f64, k as f64) * self.spacing
    }

    /// Returns the rest positions of the corners of a triangle, relative to the origin.
    fn corners(&self, mesh: &TriMesh, triangle: u32) -> [DVec3; 3] {
        mesh.faces()[triangle as usize].map(|v| mesh.rest_positions()[v as usize] - self.origin)
    }

    /// Computes the distances of all grid points: first in the band, then inwards.
    fn compute_distances(&mut self, mesh: &TriMesh) {
        let mut nearest = self.nearest_in_band(mesh);
        let normals = Pseudonormals::new(mesh);
        let inner = self.sign_band(mesh, &normals, &nearest);
        if normals.is_closed {
            self.propagate_inwards(mesh, inner, &mut nearest);
        }
    }

    /// Returns for each grid point in the band the distance of the nearest triangle, and its number.
    fn nearest_in_band(&self, mesh: &TriMesh) -> Vec<(f32, u32)> {
        let mut nearest = vec![(f32::INFINITY, u32::MAX); self.size.iter().product()];
        let mut parts = Vec::new();
        for t in 0..mesh.faces().len() as u32 {
            let triangle = self.corners(mesh, t);
            // In cells, the halves of a part always differ from it: coordinates are at most about 200, so that no
            // midpoint rounds to an end and no length underflows.
            parts.push(triangle.map(|p| p / self.spacing));
            while let Some([a, b, c]) = parts.pop() {
                let [low, high] = [a.min(b).min(c), a.max(b).max(c)];
                // The AABB of a large triangle is mostly empty; those of its halves are smaller.
                if (high - low).max_element() > MAX_TRIANGLE_CELLS {
                    parts.extend(halves([a, b, c]));
                    continue;
                }
                let from = (low - BAND).ceil().max(DVec3::ZERO);
                let to = (high + BAND).floor();
                let from = from.to_array().map(|x| x as usize);
                let to: [usize; 3] = std::array::from_fn(|n| (to[n] as usize).min(self.size[n] - 1) + 1);
                grid(from, to).for_each(|at| {
                    let x = self.point(at);
                    let distance = nearest_point_triangle(x, triangle).0.distance(x) as f32;
                    let best = &mut nearest[self.index(at)];
                    // A triangle beyond the band might not be the nearest one.
                    if distance < best.0 && f64::from(distance) <= BAND * self.spacing {
                        *best = (distance, t);
                    }
                });
            }
        }
        nearest
    }

    /// Computes the signed distances of all grid points in the band. Returns those inside.
    fn sign_band(
        &mut self,
        mesh: &TriMesh,
        normals: &Pseudonormals,
        nearest: &[(f32, u32)],
    ) -> VecDeque<[usize; 3]> {
        self.distances = vec![f32::INFINITY; nearest.len()];
        let mut inner = VecDeque::new();
        for at in grid([0; 3], self.size) {
            let (index, x) = (self.index(at), self.point(at));
            let t = nearest[index].1;
            if t == u32::MAX {
                continue;
            }
            let (y, feature) = nearest_point_triangle(x, self.corners(mesh, t));
            let is_outside = (x - y).dot(normals.of(t, feature)) >= 0.0;
            self.distances[index] = (x.distance(y) * if is_outside { 1.0 } else { -1.0 }) as f32;
            if self.distances[index] < 0.0 {
                inner.push_back(at);
            }
        }
        inner
    }

    /// Computes the distances inside the band: the triangle nearest to a point is nearly the nearest one of its neighbours.
    fn propagate_inwards(
        &mut self,
        mesh: &TriMesh,
        mut queue: VecDeque<[usize; 3]>,
        nearest: &mut [(f32, u32)],
    ) {
        while let Some(at) = queue.pop_front() {
            let t = nearest[self.index(at)].1;
            for (axis, step) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, usize::MAX), (axis, 1)]) {
                let mut next = at;
                next[axis] = next[axis].wrapping_add(step);
                if next[axis] >= self.size[axis] {
                    continue;
                }
                let index = self.index(next);
                let x = self.point(next);
                if nearest[index].0.is_infinite() && nearest[index].1 == u32::MAX {
                    nearest[index].1 = t;
                    queue.push_back(next);
                } else if nearest[index].0.is_finite() {
                    continue;
                }
                // A point that is reached from several neighbours keeps the minimum distance.
                let distance = nearest_point_triangle(x, self.corners(mesh, t)).0.distance(x) as f32;
                if distance < self.distances[index].abs() {
                    self.distances[index] = -distance;
                    nearest[index].1 = t;
                }
            }
        }
    }
}

/// Returns the points of a grid from one, inclusive, to another, exclusive; the first coordinate varies fastest.
fn grid(from: [usize; 3], to: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let plane = move |k| (from[1]..to[1]).flat_map(move |j| (from[0]..to[0]).map(move |i| [i, j, k]));
    (from[2]..to[2]).flat_map(plane)
}

/// Splits a triangle at the midpoint of its longest edge.
fn halves([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 2] {
    let lengths = [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()];
    let [a, b, c] = if lengths[0] >= lengths[1].max(lengths[2]) {
        [a, b, c]
    } else if lengths[1] >= lengths[2] {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = (a + b) * 0.5;
    [[a, middle, c], [middle, b, c]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_modes::shapes;

    /// Returns a box by its corner of the smallest coordinates and its sides.
    fn cuboid(low: DVec3, sides: DVec3) -> TriMesh {
        let corner =
            |n: u32| low + sides * DVec3::new(f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        TriMesh::new((0..8).map(corner).collect(), faces).unwrap()
    }

    #[test]
    fn distances_of_a_box_are_exact_up_to_the_spacing() {
        let field = DepthField::new(&cuboid(DVec3::splat(5.0), DVec3::new(1.0, 2.0, 3.0)));
        let mut seen = [0; 2];
        for n in 0..4000 {
            let cell =
                DVec3::new(f64::from(n % 11), f64::from(n / 11 % 17), f64::from(n / 187)) * 0.15 - 0.02;
            let inside = cell.min(DVec3::new(1.0, 2.0, 3.0) - cell);
            let expected = if inside.min_element() > 0.0 {
                -inside.min_element()
            } else {
                inside.min(DVec3::ZERO).length()
            };
            match field.at(cell + 5.0) {
                Some(SignedDistance { distance, gradient }) => {
                    assert!(
                        (distance - expected).abs() < field.spacing,
                        "{cell}: {distance}, not {expected}"
                    );
                    if expected.abs() < 0.02 {
                        assert!((distance - expected).abs() < 0.1 * field.spacing || expected > 0.0);
                        assert!((gradient.length() - 1.0).abs() < 0.5, "{cell}: {gradient}");
                    }
                    seen[usize::from(distance < 0.0)] += 1;
                }
                None => assert!(expected > field.spacing, "{cell} is {expected} away"),
            }
        }
        assert!(seen[0] > 30 && seen[1] > 500, "{seen:?}");
    }

    #[test]
    fn a_box_of_a_few_roundings_of_its_position_has_its_depths() {
        for offset in [1e9_f64, 1e16] {
            let unit = offset.next_up() - offset;
            let (low, sides) = (DVec3::splat(offset), unit * DVec3::new(16.0, 2.0, 2.0));
            let field = DepthField::new(&cuboid(low, sides));
            for (inside, expected) in [(1.0, -unit), (2.0, 0.0)] {
                let x = low + unit * DVec3::new(8.0, 1.0, inside);
                let found = field.at(x).unwrap().distance;
                assert!((found - expected).abs() < field.spacing, "{offset}: {found}, not {expected}");
            }
        }
    }

    #[test]
    fn shapes_whose_squared_sides_underflow_are_computed() {
        for side in [5e-324, 1e-300, 1e-170] {
            let field = DepthField::new(&cuboid(DVec3::ZERO, DVec3::new(16.0 * side, side, side)));
            assert!(field.distances.iter().all(|x| *x == 0.0 || x.is_infinite()), "{side}");
        }
    }

    #[test]
    fn an_open_surface_has_depths_only_in_the_band() {
        let spring = shapes::spring();
        let (p, faces) = (spring.rest_positions(), spring.faces());
        let field = DepthField::new(&TriMesh::new(p.to_vec(), faces[1..].to_vec()).unwrap());
        let known = field.distances.iter().filter(|x| x.is_finite());
        let farthest = known.clone().fold(0.0_f32, |m, x| m.max(x.abs()));
        assert!(known.count() > 1000 && f64::from(farthest) <= 1.01 * BAND * field.spacing, "{farthest}");
    }

    #[test]
    fn the_spring_is_deepest_along_its_middle_and_directions_point_outwards() {
        let spring = shapes::spring();
        let field = DepthField::new(&spring);
        assert!(field.distances.len() <= 1 << 21);
        let deepest = field.distances.iter().fold(0.0_f32, |m, x| m.min(*x));
        // The tube's radius is 0.03.
        assert!((-0.03..-0.027).contains(&deepest), "{deepest}");
        let p = spring.rest_positions();
        for face in spring.faces().iter().step_by(7) {
            let [a, b, c] = face.map(|v| p[v as usize]);
            let (normal, middle) = ((b - a).cross(c - a).normalize(), (a + b + c) / 3.0);
            for depth in [0.002, 0.01] {
                let SignedDistance { distance, gradient } = field.at(middle - normal * depth).unwrap();
                assert!((distance + depth).abs() < 0.002, "{distance} at {depth}");
                assert!(gradient.normalize().dot(normal) > 0.9);
            }
        }
        assert!(field.at(DVec3::splat(1e9)).is_none() && field.at(DVec3::NAN).is_none());
        assert!(field.at(DVec3::ZERO).is_none(), "the axis is outside");
    }
}
