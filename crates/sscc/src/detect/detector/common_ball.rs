//! The largest ball inside of two closed meshes, by branch and bound over boxes.
//!
//! The *depth* of a point is its distance from the surfaces if it is inside of both meshes. The distance of a point from a surface
//! changes by no more than the point moves. So if the centre of a box has depth r, no point of the box has a depth of more than r plus
//! half of the diagonal. The distance from a triangle is a convex function, hence largest at a corner of the box. So is the mean of the
//! distances from the nearest triangle of each mesh, and the smaller one of two distances is at most their mean.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::boxes::Boxes;
use super::enclosed::Side;
use crate::Error;
use crate::geometry::{Aabb, distance_point_triangle};

/// The largest accepted difference between the bounds of the radius, as a share of the radius.
const TOLERANCE: f64 = 1e-3;

/// The search also ends when the bounds differ by at most this share of the size of the meshes: touching bodies share
/// no ball.
const SMALLEST: f64 = 1e-9;

/// Number of boxes after which the search ends with the bounds that it has: about a second of work.
const MAX_CELLS: usize = 1 << 16;

struct Cell {
    center: DVec3,
    half: DVec3,
    /// An upper bound of the depth of all points of the box.
    bound: f64,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// Returns the radius of a ball that is inside of both meshes, and a bound of the radii of all such balls.
///
/// # Errors
/// When the token of either mesh cancels.
pub(super) fn largest_common_ball(sides: [&Side<'_>; 2]) -> Result<(f64, f64), Error> {
    let aabbs = sides.map(|side| side.boxes.of_nodes[0]);
    let shared =
        Aabb { lower: aabbs[0].lower.max(aabbs[1].lower), upper: aabbs[0].upper.min(aabbs[1].upper) };
    let extent = shared.upper - shared.lower;
    if extent.min_element() < 0.0 {
        return Ok((0.0, 0.0));
    }
    let smallest =
        SMALLEST * aabbs.map(|aabb| (aabb.upper - aabb.lower).max_element()).into_iter().fold(0.0, f64::max);
    let mut best = 0.0_f64;
    let mut cells = BinaryHeap::new();
    cells.push(bounded(sides, shared.center(), 0.5 * extent, &mut best)?);
    for _ in 0..MAX_CELLS {
        let Some(Cell { center, half, bound }) = cells.pop() else { return Ok((best, best)) };
        if bound <= best * (1.0 + TOLERANCE) + smallest {
            return Ok((best, bound.max(best)));
        }
        // Halves the box across its longest side, so that boxes keep the shape of a thin overlap along the axes.
        let axis = half.max_position();
        let mut part = half;
        part[axis] *= 0.5;
        for sign in [-1.0, 1.0] {
            let mut middle = center;
            middle[axis] += sign * part[axis];
            let cell = bounded(sides, middle, part, &mut best)?;
            if cell.bound > best {
                cells.push(cell);
            }
        }
    }
    let bound = cells.peek().map_or(best, |cell| cell.bound);
    Ok((best, bound.max(best)))
}

fn corners(center: DVec3, half: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|k| {
        let sign = |axis: usize| if k >> axis & 1 == 1 { half[axis] } else { -half[axis] };
        center + DVec3::new(sign(0), sign(1), sign(2))
    })
}

/// Bounds the depth of the points of a box; updates `best` by the depth of its centre.
fn bounded(sides: [&Side<'_>; 2], center: DVec3, half: DVec3, best: &mut f64) -> Result<Cell, Error> {
    let near = sides.map(|side| nearest(&side.boxes, center));
    let mut inside = f64::INFINITY;
    for (side, (distance, _)) in sides.iter().zip(near) {
        let is_inside = with_mutant!(side.winding_number(center)? != 0, BallOutsideKept, true);
        let own = if is_inside { distance } else { -distance };
        inside = with_mutant!(inside.min(own), BallInsideSecond, own);
    }
    *best = best.max(inside);
    let triangles = [0, 1].map(|k| sides[k].boxes.corners(near[k].1));
    let mut largest = [0.0_f64; 3];
    for corner in corners(center, half) {
        let [a, b] = triangles.each_ref().map(|triangle| distance_point_triangle(corner, triangle));
        largest = [
            largest[0].max(with_mutant!(a, BallCornersShrunk, 0.5 * a)),
            largest[1].max(b),
            largest[2].max(with_mutant!(0.5, BallMeanShrunk, 0.25) * (a + b)),
        ];
    }
    let bound = largest
        .into_iter()
        .fold(inside + with_mutant!(half.length(), BallBoxOfHalfSize, 0.5 * half.length()), f64::min);
    Ok(Cell { center, half, bound })
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
        // The nearest part is visited next.
        open[start..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    }
    found
}
