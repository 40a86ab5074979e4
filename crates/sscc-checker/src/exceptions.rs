//! Exceptions: pairs that count and collide at the centre. Every query tests them, so an unnecessary exception costs only time. Such
//! are pairs of which one triangle is a segment, with the common vertex inside: the opposite edge contains it, though no other point
//! need be common.

use crate::counted::CountedPairs;
use crate::dyadic::{Dyadic, Vector, cross, dot, minus};
use crate::refusal::{IsCancelled, Result, check_cancelled, proof};

/// Checks that each exception counts and collides at the centre.
pub(crate) fn check(counted: &CountedPairs<'_>, is_cancelled: &IsCancelled<'_>) -> Result<()> {
    let CountedPairs { model, scope, .. } = counted;
    for &[a, b] in &scope.exceptions {
        check_cancelled(is_cancelled)?;
        let simplices = counted.with_exceptions(a, b);
        if simplices.is_empty() {
            return proof(format!("exception: triangles {a} and {b} do not count"));
        }
        let corner = |i: u32| model.computed_position(i as usize, &scope.center).map(Dyadic::of);
        if simplices.iter().all(|[x, y]| are_disjoint(&x.map(corner), &y.map(corner))) {
            return proof(format!("exception: triangles {a} and {b} do not collide at the centre"));
        }
    }
    Ok(())
}

/// Whether two closed triangles (segments, points) X and Y have no common point, exactly. Then a plane separates them whose normal is one
/// of these directions. Let Z be the polytope of all differences of their points, which does not contain 0, and L its affine hull.
///
/// - Z has a volume: the normal of a face of Z is that of X or Y, or is orthogonal to an edge of each.
/// - L is a plane without 0: its normal is one of these, too.
/// - L is a plane that contains 0: then X and Y lie in one plane. The normal of a side of Z in this plane is orthogonal to an edge of one of
///   them, and some point of the other is not on the line of the edge.
/// - L is a line without 0: then X and Y lie on parallel lines, and the same direction separates them.
/// - L is a line that contains 0, or a point: any difference of two of their points separates them.
fn are_disjoint(x: &[Vector; 3], y: &[Vector; 3]) -> bool {
    let edges = |t: &[Vector; 3]| [minus(&t[1], &t[0]), minus(&t[2], &t[1]), minus(&t[0], &t[2])];
    let (of_x, of_y) = (edges(x), edges(y));
    let between: Vec<Vector> = x.iter().flat_map(|p| y.iter().map(move |q| minus(q, p))).collect();
    let normals = [cross(&of_x[0], &of_x[1]), cross(&of_y[0], &of_y[1])];
    let of_edges = of_x.iter().flat_map(|e| of_y.iter().map(move |f| cross(e, f)));
    let across = of_x.iter().chain(&of_y).flat_map(|e| between.iter().map(move |d| cross(&cross(e, d), e)));
    let mut directions = normals.into_iter().chain(of_edges).chain(across).chain(between.iter().cloned());
    directions.any(|dir| {
        let [x, y] = [x, y].map(|t| t.each_ref().map(|p| dot(&dir, p)));
        let is_below = |a: &[Dyadic], b: &[Dyadic]| a.iter().all(|a| b.iter().all(|b| a < b));
        is_below(&x, &y) || is_below(&y, &x)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_touch_are_not_disjoint() {
        let of = |corners: [[f64; 3]; 3]| corners.map(|corner| corner.map(Dyadic::of));
        let flat = of([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
        let shifted = |dx: f64, dy: f64, dz: f64| of([[dx, dy, dz], [dx + 4.0, dy, dz], [dx, dy + 4.0, dz]]);
        let tiny = 1e-300;
        for (other, is_disjoint) in [
            (shifted(0.0, 0.0, tiny), true),
            (shifted(1.0, 1.0, 0.0), false),
            (shifted(4.0, 0.0, 0.0), false),
            (shifted(4.0_f64.next_up(), 0.0, 0.0), true),
            (shifted(2.0, 2.0, 0.0), false),
            (shifted(2.0, 2.0_f64.next_up(), 0.0), true),
            // An edge that pierces the triangle, touches it, and misses it.
            (of([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]), false),
            (of([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]), false),
            (of([[1.0, 1.0, tiny], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]), true),
            // Segments and points.
            (of([[1.0, 1.0, 0.0], [9.0, 9.0, 0.0], [9.0, 9.0, 0.0]]), false),
            (of([[5.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 0.0, 0.0]]), true),
            (of([[1.0, 1.0, 0.0]; 3]), false),
            (of([[3.0, 3.0, 0.0]; 3]), true),
        ] {
            assert_eq!(are_disjoint(&flat, &other), is_disjoint, "{other:?}");
            assert_eq!(are_disjoint(&other, &flat), is_disjoint, "{other:?}");
        }
        // Two parallel segments, two on one line, two points.
        let segment = |a: [f64; 3], b: [f64; 3]| of([a, b, b]);
        let first = segment([0.0; 3], [1.0, 1.0, 1.0]);
        assert!(are_disjoint(&first, &segment([0.0, 0.0, tiny], [1.0, 1.0, 1.0 + f64::EPSILON])));
        assert!(are_disjoint(&first, &segment([2.0; 3], [3.0; 3])));
        assert!(!are_disjoint(&first, &segment([0.5; 3], [3.0; 3])));
        assert!(are_disjoint(&of([[0.0; 3]; 3]), &of([[tiny, 0.0, 0.0]; 3])));
    }
}
