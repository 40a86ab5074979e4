//! The largest ball inside of two closed meshes, by branch and bound over cubes.
//!
//! The distance of a point from a surface changes by no more than the point moves. So a cube whose centre is a distance r
//! inside of both has no point that is farther inside than r and its half diagonal. The distance from a triangle is a convex function,
//! which is largest at a corner of the cube; so is the mean of the distances from the nearest triangle of each mesh, and the smaller one
//! of two is at most their mean.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::boxes::Boxes;
use super::enclosed::Side;
use crate::Error;
use crate::geometry::{Aabb, distance_point_triangle};

/// The largest accepted difference of the bounds of the radius, as a share of it.
const TOLERANCE: f64 = 1e-3;

/// Radii below this share of the size of the meshes are 0: touching bodies share no ball.
const SMALLEST: f64 = 1e-9;

/// Number of cubes after which the search ends with the bounds that it has.
const MAX_CUBES: usize = 1 << 20;

struct Cube {
    center: DVec3,
    half: f64,
    /// No point of the cube is farther inside.
    bound: f64,
}

impl PartialEq for Cube {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cube {}

impl PartialOrd for Cube {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cube {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// Returns the radius of a ball that is inside of both meshes, and a bound of the radii of all such balls.
///
/// # Errors
/// When the token of the first mesh cancels.
pub(super) fn largest_common_ball(sides: [&Side<'_>; 2]) -> Result<(f64, f64), Error> {
    let aabbs = sides.map(|side| side.boxes.of_nodes[0]);
    let shared = Aabb {
        lower: aabbs[0].lower.max(aabbs[1].lower),
        upper: aabbs[0].upper.min(aabbs[1].upper),
    };
    let extent = shared.upper - shared.lower;
    if extent.min_element() < 0.0 {
        return Ok((0.0, 0.0));
    }
    let smallest = SMALLEST * aabbs.map(|aabb| (aabb.upper - aabb.lower).max_element()).into_iter().fold(0.0, f64::max);
    let mut best = 0.0_f64;
    let mut cubes = BinaryHeap::new();
    let half = 0.5 * extent.max_element();
    cubes.push(bounded(sides, shared.center(), half, &mut best)?);
    for _ in 0..MAX_CUBES {
        let Some(Cube { center, half, bound }) = cubes.pop() else { return Ok((best, best)) };
        if bound <= best * (1.0 + TOLERANCE) + smallest {
            let upper = if best == 0.0 { 0.0 } else { bound.max(best) };
            return Ok((best, upper));
        }
        let half = 0.5 * half;
        for corner in corners(center, half) {
            let cube = bounded(sides, corner, half, &mut best)?;
            if cube.bound > best {
                cubes.push(cube);
            }
        }
    }
    let bound = cubes.peek().map_or(best, |cube| cube.bound);
    Ok((best, bound.max(best)))
}

fn corners(center: DVec3, half: f64) -> [DVec3; 8] {
    std::array::from_fn(|k| {
        let sign = |axis: usize| if k >> axis & 1 == 1 { half } else { -half };
        center + DVec3::new(sign(0), sign(1), sign(2))
    })
}

/// Bounds how far inside the points of a cube are, and takes its centre.
fn bounded(sides: [&Side<'_>; 2], center: DVec3, half: f64, best: &mut f64) -> Result<Cube, Error> {
    let diagonal = half * 3.0_f64.sqrt();
    let [near_a, near_b] = sides.map(|side| nearest(&side.boxes, center));
    let mut inside = f64::INFINITY;
    for (side, (distance, _)) in sides.iter().zip([near_a, near_b]) {
        let is_inside = side.winding_number(center)? != 0;
        inside = inside.min(if is_inside { distance } else { -distance });
    }
    *best = best.max(inside);
    let triangles = [sides[0].boxes.corners(near_a.1), sides[1].boxes.corners(near_b.1)];
    let mut largest = [0.0_f64; 3];
    for corner in corners(center, half) {
        let [a, b] = triangles.each_ref().map(|triangle| distance_point_triangle(corner, triangle));
        largest = [largest[0].max(a), largest[1].max(b), largest[2].max(0.5 * (a + b))];
    }
    let bound = largest.into_iter().fold(inside + diagonal, f64::min);
    Ok(Cube { center, half, bound })
}

/// Returns the distance of a point from the surface of a mesh, and the nearest triangle.
fn nearest(boxes: &Boxes<'_>, point: DVec3) -> (f64, u32) {
    let distance = |n: u32| {
        let Aabb { lower, upper } = boxes.of_nodes[n as usize];
        (lower - point).max(point - upper).max(DVec3::ZERO).length()
    };
    let mut found = (f64::INFINITY, 0);
    let mut open = vec![(distance(0), 0)];
    while let Some((least, n)) = open.pop() {
        if least > found.0 {
            continue;
        }
        if boxes.is_leaf(n) {
            for &triangle in boxes.triangles(n) {
                let own = distance_point_triangle(point, &boxes.corners(triangle));
                if own < found.0 {
                    found = (own, triangle);
                }
            }
            continue;
        }
        let start = open.len();
        open.extend(boxes.parts(n).map(|part| (distance(part), part)));
        // The nearest part is next.
        open[start..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    }
    found
}
