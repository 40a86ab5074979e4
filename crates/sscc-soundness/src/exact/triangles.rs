//! Tests whether two closed triangles have a common point.
//!
//! An extreme point of the common part of two triangles is on an edge of one of them, so they meet exactly if some edge of one
//! meets the other. Triangles without area are the union of their edges.

use super::cones::cones_meet;
use super::interval::Interval;
use super::number::Number;
use super::point::{Point, Triangle};
use super::rounded;
use super::segments::segment_meets_triangle;
use super::separation::{best_direction, is_separated};
use super::vectors::{Vector, cross, dot, minus};
use super::whole::Unit;
use super::wide::fits;
use super::work;

/// Whether the corners of one triangle are all strictly on one side of the plane of the other. False if undecided.
fn is_beside_plane<N: Number>(a: &[Vector<N>; 3], b: &[Vector<N>; 3]) -> bool {
    let normal = cross(&minus(&a[1], &a[0]), &minus(&a[2], &a[0]));
    let side = |x: &Vector<N>| dot(&normal, &minus(x, &a[0])).sign();
    let first = side(&b[0]);
    first.is_some_and(|s| s != 0) && side(&b[1]) == first && side(&b[2]) == first
}

/// Whether an edge of one triangle meets the other triangle; None if undecided.
pub(super) fn edges_meet<N: Number>(a: &[Vector<N>; 3], b: &[Vector<N>; 3]) -> Option<bool> {
    let mut undecided = false;
    for (x, y) in [(a, b), (b, a)] {
        for i in 0..3 {
            match segment_meets_triangle([&x[i], &x[(i + 1) % 3]], y) {
                Some(true) => return Some(true),
                Some(false) => {}
                None => undecided = true,
            }
        }
    }
    (!undecided).then_some(false)
}

/// Whether two triangles have a common point, with numbers that always decide.
fn edges_meet_as<N: Number>(a: &Triangle, b: &Triangle, number: impl Fn(f64) -> N) -> bool {
    let [x, y] = [a, b].map(|t| t.map(|p| p.map(&number)));
    let is_apart = is_beside_plane(&x, &y) || is_beside_plane(&y, &x);
    !is_apart && edges_meet(&x, &y).expect("whole numbers decide")
}

fn boxes_are_apart(a: &Triangle, b: &Triangle) -> bool {
    (0..3).any(|c| {
        let [[a_low, a_high], [b_low, b_high]] =
            [a, b].map(|t| [t[0][c].min(t[1][c]).min(t[2][c]), t[0][c].max(t[1][c]).max(t[2][c])]);
        a_high < b_low || b_high < a_low
    })
}

fn intervals(t: &Triangle) -> [Vector<Interval>; 3] {
    t.map(|p| p.map(Interval::of))
}

/// Whether two triangles have a common point, exactly.
pub fn meet(a: &Triangle, b: &Triangle) -> bool {
    if boxes_are_apart(a, b) {
        return false;
    }
    rounded::meet(a, b).unwrap_or_else(|| meet_without_rounding(a, b))
}

/// Whether two triangles have a common point, by intervals and then integers.
pub(super) fn meet_without_rounding(a: &Triangle, b: &Triangle) -> bool {
    let [x, y] = [a, b].map(intervals);
    if is_beside_plane(&x, &y) || is_beside_plane(&y, &x) {
        return false;
    }
    if let Some(is_meeting) = edges_meet(&x, &y) {
        return is_meeting;
    }
    // This decides neighbours that are nearly in one plane.
    if best_direction([a, b], &[*a], &[*b]).is_some_and(|n| is_separated(&[x], &[y], &n)) {
        return false;
    }
    work::count();
    let unit = Unit::of(a.iter().chain(b));
    match unit.bits(a.iter().chain(b)) {
        bits if fits::<4>(bits) => edges_meet_as(a, b, |x| unit.wide::<4>(x)),
        bits if fits::<8>(bits) => edges_meet_as(a, b, |x| unit.wide::<8>(x)),
        _ => edges_meet_as(a, b, |x| unit.whole(x)),
    }
}

/// Whether two triangles with a common corner, given by their other corners, have another common point.
pub fn meet_beyond_corner(corner: Point, a: [Point; 2], b: [Point; 2]) -> bool {
    fn decide<N: Number>(corner: &Vector<N>, a: &[Vector<N>; 2], b: &[Vector<N>; 2]) -> Option<bool> {
        cones_meet(corner, [&a[0], &a[1]], [&b[0], &b[1]])
    }
    let [x, y] = [a, b].map(|t| t.map(|p| p.map(Interval::of)));
    decide(&corner.map(Interval::of), &x, &y).unwrap_or_else(|| {
        work::count();
        let unit = Unit::of(a.iter().chain(&b).chain([&corner]));
        let [x, y] = [a, b].map(|t| t.map(|p| p.map(|x| unit.whole(x))));
        decide(&corner.map(|x| unit.whole(x)), &x, &y).expect("whole numbers decide")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

    fn moved(t: Triangle, by: Point) -> Triangle {
        t.map(|p| std::array::from_fn(|c| p[c] + by[c]))
    }

    #[test]
    fn touching_triangles_meet_and_triangles_one_double_apart_do_not() {
        let post = [[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [0.75, 0.5, 1.0]];
        let tiny = f64::from_bits(1);
        assert!(meet(&FLOOR, &post));
        assert!(!meet(&FLOOR, &post.map(|p| [p[0], p[1], if p[2] == 0.0 { tiny } else { p[2] }])));
        // The post is beyond the longest edge, by one unit in the last place.
        let on_edge = moved(post, [0.5, 0.5, 0.0]);
        assert!(meet(&FLOOR, &on_edge));
        assert!(!meet(&FLOOR, &on_edge.map(|p| [p[0].next_up(), p[1], p[2]])));
    }

    #[test]
    fn pierced_coplanar_and_degenerate_triangles_meet_exactly() {
        let needle = [[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [0.5, 0.5, 1.0]];
        assert!(meet(&FLOOR, &needle) && meet(&needle, &FLOOR));
        assert!(!meet(&FLOOR, &moved(needle, [1.0, 1.0, 0.0])));
        assert!(meet(&FLOOR, &FLOOR) && meet(&FLOOR, &moved(FLOOR, [2.0, 0.0, 0.0])));
        assert!(!meet(&FLOOR, &moved(FLOOR, [1.0, 1.5, 0.0])));
        // One triangle is inside the other, in one plane.
        assert!(meet(&FLOOR, &FLOOR.map(|p| [0.25 + p[0] / 8.0, 0.25 + p[1] / 8.0, 0.0])));
        let point = [[0.5, 0.25, 0.0]; 3];
        assert!(meet(&FLOOR, &point) && meet(&point, &point));
        let [left, right] = [0.0, 3.0].map(|x| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 2.0, 0.0, 0.0]]);
        assert!(!meet(&left, &right) && meet(&left, &moved(right, [-1.0, 0.0, 0.0])));
    }

    #[test]
    fn a_common_corner_alone_does_not_count() {
        let apex = [0.0, 0.0, 0.0];
        let flat = [[2.0, -1.0, 0.0], [2.0, 1.0, 0.0]];
        assert!(!meet_beyond_corner(apex, flat, [[1.0, 0.0, 1.0], [2.0, 0.0, 1.0]]));
        assert!(meet_beyond_corner(apex, flat, [[1.0, 0.0, 1.0], [2.0, 0.0, 0.0]]));
        assert!(meet_beyond_corner(apex, flat, [[1.0, 0.0, 1.0], [2.0, 0.0, -1.0]]));
        assert!(!meet_beyond_corner(apex, flat, [[1.0, 2.0, 1.0], [2.0, 4.0, -1.0]]));
        assert!(!meet_beyond_corner(apex, flat, [[-1.0, 0.0, 1.0], [-2.0, 0.0, -1.0]]));
        // One triangle has no area: it is along the middle of the other, then opposite to it.
        assert!(meet_beyond_corner(apex, flat, [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]));
        assert!(!meet_beyond_corner(apex, flat, [[-1.0, 0.0, 0.0], [-3.0, 0.0, 0.0]]));
        assert!(meet_beyond_corner(apex, flat, [[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]));
    }
}
