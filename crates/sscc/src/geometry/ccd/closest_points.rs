//! Where two triangles are closest, and a direction that separates them there: heuristics, which
//! [`separation`](super::separation) evaluates.

use glam::DVec3;

use super::separation::{Direction, Separation};
use crate::geometry::nearest_to_origin;
use crate::intersect_triangle_triangle;

/// The closest points of the two triangles at a time.
pub(super) struct Closest {
    /// The distance of two of their points, rounded: they are no farther apart. 0 where they meet.
    pub(super) distance: f64,
    /// A direction that separates them then, if one was found.
    pub(super) direction: Option<Direction>,
}

impl Closest {
    pub(super) fn at(pair: &Separation, t: f64) -> Self {
        let (x, y) = pair.at(t);
        let differences: [DVec3; 9] = std::array::from_fn(|i| y[i % 3] - x[i / 3]);
        // Squares of small numbers would vanish.
        let size = differences.iter().fold(0.0_f64, |size, d| size.max(d.abs().max_element()));
        if size == 0.0 {
            return Self { distance: 0.0, direction: None };
        }
        let point = nearest_to_origin(&differences.map(|d| d / size)).point;
        let distance = point.length() * size;
        // Two points that are close tell the direction between them badly; and in flat cases they may not be the
        // closest ones. Either way the gap is then too narrow.
        let between = pair.along(point).filter(|n| n.gap(t) > WIDE * distance);
        if between.is_some() {
            return Self { distance, direction: between };
        }
        // No direction separates what meets: looking for one takes long.
        if intersect_triangle_triangle(&x, &y) {
            return Self { distance: 0.0, direction: None };
        }
        Self { distance, direction: widest(pair, t, &x, &y) }
    }
}

/// A gap of this share of the distance is as good as any.
const WIDE: f64 = 0.75;

/// The direction with the widest gap among all in which features of two triangles can be closest: two vertices, a
/// vertex and an edge, two edges, a vertex and a face. They come from edges, which are long, so that they are as
/// precise for narrow gaps as for wide ones.
#[cold]
fn widest(pair: &Separation, t: f64, x: &[DVec3; 3], y: &[DVec3; 3]) -> Option<Direction> {
    let edges = |[a, b, c]: [DVec3; 3]| [b - a, c - b, a - c].map(unit);
    let (edges_x, edges_y) = (edges(*x), edges(*y));
    // Only the best one is projected at both ends.
    let mut best = (0.0, DVec3::ZERO);
    let mut consider = |n: DVec3| {
        let n = n / n.abs().max_element();
        let [(low_x, high_x), (low_y, high_y)] = [x, y].map(|triangle| {
            let [a, b, c] = triangle.map(|p| n.dot(p));
            (a.min(b).min(c), a.max(b).max(c))
        });
        let error = pair.error(n);
        // Both are NaN where n has no direction.
        for (gap, n) in [(low_y - high_x, n), (low_x - high_y, -n)] {
            if gap - error > best.0 {
                best = (gap - error, n);
            }
        }
    };
    for [e, f, g] in [edges_x, edges_y] {
        // Of a sliver, the normal between the edges that differ most.
        let normals = [e.cross(f), f.cross(g), g.cross(e)];
        consider(
            normals
                .into_iter()
                .fold(DVec3::ZERO, |a, b| if a.length_squared() < b.length_squared() { b } else { a }),
        );
    }
    for i in 0..3 {
        for j in 0..3 {
            consider(edges_x[i].cross(edges_y[j]));
            let d = unit(y[j] - x[i]);
            consider(d);
            // Edge i begins at vertex i.
            for e in [edges_x[i], edges_y[j]] {
                consider(d - e * e.dot(d));
            }
        }
    }
    pair.along(best.1).filter(|along| along.gap(t) > 0.0)
}

/// The unit vector of any vector but 0, however small.
fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize_or_zero()
}
