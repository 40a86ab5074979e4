//! Tests in doubles, with an error bound, whether two triangles meet. Most ordinary pairs of triangles are decided here.
//!
//! The test computes only on which side of a plane a point is. It remains undecided where triangles touch, lie in one plane,
//! have no area, or have extreme coordinates.

use super::point::{Point, Triangle};

fn minus(p: &Point, q: &Point) -> Point {
    std::array::from_fn(|c| p[c] - q[c])
}

fn size(p: &Point) -> f64 {
    p[0].abs().max(p[1].abs()).max(p[2].abs())
}

/// Returns on which side of the plane through `a`, `b` and `c` the point `d` is: 1 or -1, or 0 if doubles do not decide.
///
/// With differences of at most E, F and D, the determinant is a sum of six products of three differences. Each product is at
/// most E F D, and there are eleven roundings. So the error is below `128 u E F D`.
fn side([a, b, c]: [&Point; 3], d: &Point) -> i8 {
    let (e, f, d) = (minus(b, a), minus(c, a), minus(d, a));
    let area = size(&e) * size(&f);
    let product = area * size(&d);
    // Intervals decide where products are extreme.
    if !(1e-200..1e200).contains(&product) || !(1e-200..1e200).contains(&area) {
        return 0;
    }
    let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let height = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
    if height.abs() <= 64.0 * f64::EPSILON * product {
        0
    } else if height > 0.0 {
        1
    } else {
        -1
    }
}

/// Whether the segment from `p` to `q`, whose ends are strictly on different sides of the plane of a triangle, meets the
/// triangle. It does if its line passes all edges on the same side, and misses it if the line passes edges on both sides.
fn pierces(p: &Point, q: &Point, [a, b, c]: &Triangle) -> Option<bool> {
    let sides = [side([p, q, a], b), side([p, q, b], c), side([p, q, c], a)];
    if sides.contains(&1) && sides.contains(&-1) {
        Some(false)
    } else if sides.contains(&0) {
        None
    } else {
        Some(true)
    }
}

/// Whether two triangles have a common point; None if doubles do not decide.
pub fn meet(a: &Triangle, b: &Triangle) -> Option<bool> {
    let mut is_decided = true;
    let pairs = [(a, b), (b, a)].map(|(x, y)| (x, y, x.map(|p| side([&y[0], &y[1], &y[2]], &p))));
    for (_, _, sides) in &pairs {
        if sides[0] != 0 && sides[1] == sides[0] && sides[2] == sides[0] {
            return Some(false);
        }
    }
    for (x, y, sides) in &pairs {
        for i in 0..3 {
            let j = (i + 1) % 3;
            match sides[i] * sides[j] {
                1 => {}
                -1 => match pierces(&x[i], &x[j], y) {
                    Some(true) => return Some(true),
                    Some(false) => {}
                    None => is_decided = false,
                },
                _ => is_decided = false,
            }
        }
    }
    is_decided.then_some(false)
}

#[cfg(test)]
mod tests {
    use super::super::triangles::meet_without_rounding;
    use super::*;
    use crate::random::Random;

    #[test]
    fn decisions_by_doubles_equal_exact_ones() {
        let mut random = Random::new("rounded", 1);
        let mut decided = [0, 0];
        for _ in 0..20_000 {
            let flat = random.power(-17.0, 0.0);
            let mut triangle = || -> Triangle {
                std::array::from_fn(|_| {
                    let p = random.point();
                    [p[0], p[1], flat * p[2]]
                })
            };
            let (a, mut b) = (triangle(), triangle());
            if random.one_in(4) {
                // A corner that nearly touches the other triangle.
                b[0] = std::array::from_fn(|c| (a[0][c] + a[1][c]) / 2.0);
            }
            if let Some(is_meeting) = meet(&a, &b) {
                assert_eq!(meet_without_rounding(&a, &b), is_meeting, "{a:?} {b:?}");
                decided[usize::from(is_meeting)] += 1;
            }
        }
        assert!(decided[0] > 1000 && decided[1] > 1000, "{decided:?}");
    }

    #[test]
    fn touching_and_extreme_triangles_are_undecided() {
        let floor = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let post = [[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [0.75, 0.5, 1.0]];
        assert_eq!(meet(&floor, &post), None);
        assert_eq!(meet(&floor, &floor), None);
        let through = post.map(|p: Point| [p[0], p[1], p[2] - 0.5]);
        assert_eq!(meet(&floor, &through), Some(true));
        let scaled = |t: &Triangle| t.map(|p| p.map(|x| x * 1e-70));
        assert_eq!(meet(&scaled(&floor), &scaled(&through)), None);
        assert_eq!(meet(&floor, &post.map(|p| [p[0], p[1], p[2] + 0.5])), Some(false));
    }
}
