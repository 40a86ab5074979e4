//! Directions that separate two triangles. Doubles propose them, and intervals verify them.

use super::interval::Interval;
use super::number::Number;
use super::point::{Point, Triangle};
use super::vectors::{Vector, dot};

/// Directions that may separate two triangles.
fn directions(a: &Triangle, b: &Triangle) -> Vec<Point> {
    let minus = |p: Point, q: Point| -> Point { std::array::from_fn(|c| p[c] - q[c]) };
    let cross = |p: Point, q: Point| {
        [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
    };
    let edges = |t: &Triangle| -> [Point; 3] { std::array::from_fn(|i| minus(t[(i + 1) % 3], t[i])) };
    let middle = |t: &Triangle| -> Point { std::array::from_fn(|c| (t[0][c] + t[1][c] + t[2][c]) / 3.0) };
    let (ea, eb) = (edges(a), edges(b));
    let (na, nb) = (cross(ea[0], ea[1]), cross(eb[0], eb[1]));
    let mut all =
        vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], minus(middle(b), middle(a)), na, nb];
    all.extend(ea.iter().flat_map(|e| eb.iter().map(|f| cross(*e, *f))));
    all.extend(ea.iter().map(|e| cross(na, *e)).chain(eb.iter().map(|e| cross(nb, *e))));
    all.extend(a.iter().flat_map(|p| b.iter().map(|q| minus(*q, *p))));
    all.retain_mut(|n| {
        let size = n.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        n.iter_mut().for_each(|x| *x /= size);
        size > 0.0 && n.iter().all(|x| x.is_finite())
    });
    all
}

/// Whether a direction separates two triangles at each of some times. True only if the intervals decide it.
pub fn is_separated(a: &[[Vector<Interval>; 3]], b: &[[Vector<Interval>; 3]], n: &Point) -> bool {
    let n = n.map(Interval::of);
    // The gap of two corners is linear in time.
    a.iter().zip(b).all(|(a, b)| {
        a.iter().all(|p| {
            b.iter().all(|q| {
                let gap: Vector<Interval> = std::array::from_fn(|c| q[c].minus(&p[c]));
                dot(&n, &gap).sign() == Some(1)
            })
        })
    })
}

/// Returns the smallest gap along a direction at some times, in doubles: an estimate.
fn gap(a: &[Triangle], b: &[Triangle], n: &Point) -> f64 {
    let along = |p: &Point| n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
    let at_end = |(a, b): (&Triangle, &Triangle)| {
        let most = a.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        b.iter().map(along).fold(f64::INFINITY, f64::min) - most
    };
    a.iter().zip(b).map(at_end).fold(f64::INFINITY, f64::min)
}

/// Returns the direction that separates two triangles best at some times, among the directions that their positions at one
/// time suggest. None if no direction seems to separate them.
pub fn best_direction(at: [&Triangle; 2], a: &[Triangle], b: &[Triangle]) -> Option<Point> {
    let both = directions(at[0], at[1]).into_iter().flat_map(|n| [n, n.map(|x| -x)]);
    let best = both.map(|n| (gap(a, b, &n), n)).max_by(|g, h| g.0.total_cmp(&h.0));
    best.filter(|(gap, _)| *gap > 0.0).map(|(_, n)| n)
}
