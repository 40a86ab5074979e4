//! The exact test of two triangles, for several orders of the triangles and of their corners, with related tests for comparison.

use sscc::glam::DVec3;
use sscc::parts::{intersect_shared_vertex_pair, intersection_triangle_triangle};
use sscc::{distance_triangle_triangle, intersect_triangle_triangle};

use super::share::some;
use crate::exact::{Point, Triangle, meet, meet_beyond_corner};
use crate::models::pairs;
use crate::random::Random;
use crate::tally::Tally;

/// Returns the corners for the core.
pub fn corners(t: &Triangle) -> [DVec3; 3] {
    t.map(DVec3::from_array)
}

/// Runs some thousand pairs.
pub fn run(random: &mut Random, tally: &mut Tally, share: f64) {
    for _ in 0..some(4000, share) {
        let (a, b) = pairs::pair(random);
        let scale = pairs::scale(random);
        let [a, b] = [a, b].map(|t| t.map(|p| p.map(|x| x * scale)));
        tally.reach_if(scale != 1.0, "extreme scale");
        whole(random, tally, &a, &b);
        if random.one_in(4) {
            beyond_corner(tally, a[0], [a[1], a[2]], [b[1], b[2]]);
        }
    }
}

fn whole(random: &mut Random, tally: &mut Tally, a: &Triangle, b: &Triangle) {
    let exact = meet(a, b);
    let turn = random.below(3);
    let [x, y] = [a, b].map(corners);
    let turned = [y[turn], y[(turn + 2) % 3], y[(turn + 1) % 3]];
    let (x, y) = if random.one_in(2) { (x, turned) } else { (turned, x) };
    check(tally, "intersect", intersect_triangle_triangle(&x, &y), exact, [a, b]);
    tally.reach_if(exact, "colliding");
    tally.reach_if([a, b].iter().any(|t| has_no_area(t)), "no area");
    if random.one_in(8) {
        let points = intersection_triangle_triangle(&x, &y);
        check(tally, "intersection", points.is_some(), exact, [a, b]);
        tally.reach_if(points.is_some_and(|found| found.points().len() == 1), "touching");
        check(tally, "distance", distance_triangle_triangle(&x, &y) == 0.0, exact, [a, b]);
    }
}

fn has_no_area(t: &Triangle) -> bool {
    t[0] == t[1] || t[1] == t[2] || t[2] == t[0]
}

fn beyond_corner(tally: &mut Tally, corner: Point, a: [Point; 2], b: [Point; 2]) {
    let exact = meet_beyond_corner(corner, a, b);
    let [x, y] = [a, b].map(|edge| edge.map(DVec3::from_array));
    let found = intersect_shared_vertex_pair(DVec3::from_array(corner), x, y);
    tally.reach("shared vertex");
    check(tally, "shared vertex", found, exact, [&[corner, a[0], a[1]], &[corner, b[0], b[1]]]);
}

fn check(tally: &mut Tally, question: &str, found: bool, exact: bool, triangles: [&Triangle; 2]) {
    tally.answer();
    match (found, exact) {
        (false, true) => tally.false_negative(|| format!("{question}: missed {triangles:?}")),
        (true, false) => tally.wrong(|| format!("{question}: they do not meet: {triangles:?}")),
        _ => {}
    }
}
