//! The contour test: whether a boundary, projected to a plane, intersects itself.

/// Rounding bound of a sum of two products of differences, relative to the sum of their magnitudes: each difference and
/// product is rounded once, and so is their sum.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Whether a closed polygon in the plane certainly does not intersect itself. Its coordinates are rounded once; `order` is
/// scratch.
pub(crate) fn is_simple(polygon: &[[f64; 2]], order: &mut Vec<u32>) -> bool {
    let count = polygon.len();
    let next = |i: usize| if i + 1 == count { 0 } else { i + 1 };
    let end = |i: usize| polygon[next(i)];
    // A bound of the rounding of any coordinate.
    let reach = polygon.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let moved = with_mutant!(f64::EPSILON * reach, ContourCoordinatesExact, 0.0);
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
                has_one_common_point(polygon[i], polygon[j], end(j), moved)
            } else if next(j) == i {
                has_one_common_point(polygon[j], polygon[i], end(i), moved)
            } else {
                low(j, 1) > high(i, 1)
                    || low(i, 1) > high(j, 1)
                    || is_on_one_side(polygon[i], end(i), [polygon[j], end(j)], moved)
                    || is_on_one_side(polygon[j], end(j), [polygon[i], end(i)], moved)
            };
            if !is_free {
                return false;
            }
        }
    }
    count > 2
}

/// Returns the error bound of two products of differences, each difference with an error of at most `2 moved`.
///
/// Let m be the largest magnitude of a coordinate and u = 2^-53, so that `moved = 2 u m`. Coordinates have errors of `u m`,
/// so a difference of two has an error of `moved`, and is itself rounded by at most `moved`, since it is at most `2 m`. So
/// the error of two products is at most `2 moved reach + 8 moved^2`. The magnitudes of the products add up to at most
/// `m reach`; rounding them and their sum adds `2 u m reach = moved reach`. The second term of the code alone is a third
/// larger than this total: the test would be valid without the first term.
fn error([ux, uy]: [f64; 2], [vx, vy]: [f64; 2], products: f64, moved: f64) -> f64 {
    let reach = ux.abs() + uy.abs() + vx.abs() + vy.abs();
    let products = with_mutant!(ROUNDING * products, ContourProductsExact, 0.0);
    with_mutant!(products + 4.0 * moved * (reach + 4.0 * moved) + f64::MIN_POSITIVE, ContourExact, 0.0)
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

/// Returns the sign of the area of a triangle if it is certain; otherwise 0.
fn area_sign(a: [f64; 2], b: [f64; 2], c: [f64; 2], moved: f64) -> f64 {
    let (u, v) = (difference(a, b), difference(a, c));
    let (p, q) = (u[0] * v[1], u[1] * v[0]);
    let area = p - q;
    if area.abs() > error(u, v, p.abs() + q.abs(), moved) { area.signum() } else { 0.0 }
}

/// Whether two points are certainly on the same side of a line, and not on it.
fn is_on_one_side(a: [f64; 2], b: [f64; 2], points: [[f64; 2]; 2], moved: f64) -> bool {
    let [x, y] = points.map(|p| area_sign(a, b, p, moved));
    x * y > 0.0
}

/// Whether two edges, a to b and b to c, certainly have only b in common: c is off the line of the first edge, or beyond b.
fn has_one_common_point(a: [f64; 2], b: [f64; 2], c: [f64; 2], moved: f64) -> bool {
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
                // They are not simple either if rounding separates the touching points.
                let moved = |[x, y]: &[f64; 2]| [x / 3.0 + 1e9, y / 3.0 + 1e9];
                assert!(!is_simple(&polygon.iter().map(moved).collect::<Vec<_>>()), "{polygon:?}");
            }
        }
        // Collinear edges in the same direction do not overlap.
        assert!(is_simple(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]));
    }

    /// A corner lies exactly on the first edge; the coordinates are rounded once, also those of small polygons far from
    /// the origin. If rounding moves the corner off the edge, the polygon of the rounded coordinates may be simple.
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
            // Corners in units of the edge and of an oblique vector.
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
    fn uncertain_sides_and_small_errors_are_not_certain() {
        let expected = ROUNDING * 2.0 + 4.0 * 0.25 * (26.0 + 4.0 * 0.25) + f64::MIN_POSITIVE;
        assert_eq!(error([3.0, -5.0], [-7.0, 11.0], 2.0, 0.25), expected);
        let (off, on) = ([1.0, 1.0], [2.0, 0.0]);
        for points in [[off, on], [on, off]] {
            assert!(!is_on_one_side([0.0, 0.0], [4.0, 0.0], points, 0.0));
        }
        // The second edge goes back along the first one, which is nearly vertical.
        assert!(!has_one_common_point([0.0, 0.0], [1e-20, 1.0], [2e-20, 0.5], 1e-16));
    }
}
