//! Tests whether closed segments have a common point with each other and with triangles. Segments may be points, and
//! triangles may be segments or points. Each function returns None if its numbers do not decide.

use super::number::Number;
use super::vectors::{Vector, cross, dot, is_zero, minus};

/// Whether `0 <= x <= size`, for a positive or zero size.
fn is_within<N: Number>(x: &N, size: &N) -> Option<bool> {
    Some(x.sign()? >= 0 && size.minus(x).sign()? >= 0)
}

/// Whether a point is on the segment from `p` to `p + d`, where `d` is not 0.
fn is_on_segment<N: Number>(x: &Vector<N>, p: &Vector<N>, d: &Vector<N>) -> Option<bool> {
    let from_p = minus(x, p);
    Some(is_zero(&cross(&from_p, d))? && is_within(&dot(&from_p, d), &dot(d, d))?)
}

/// Whether two segments have a common point.
pub fn segments_meet<N: Number>([p, q]: [&Vector<N>; 2], [r, s]: [&Vector<N>; 2]) -> Option<bool> {
    let (d, e, gap) = (minus(q, p), minus(s, r), minus(r, p));
    let normal = cross(&d, &e);
    if !is_zero(&normal)? {
        if dot(&gap, &normal).sign()? != 0 {
            return Some(false);
        }
        // Solves p + x d = r + y e; the denominator of x and y is the square of the normal.
        let size = dot(&normal, &normal);
        let x = dot(&cross(&gap, &e), &normal);
        let y = dot(&cross(&gap, &d), &normal);
        return Some(is_within(&x, &size)? && is_within(&y, &size)?);
    }
    match (is_zero(&d)?, is_zero(&e)?) {
        (true, true) => is_zero(&gap),
        (true, false) => is_on_segment(p, r, &e),
        (false, true) => is_on_segment(r, p, &d),
        (false, false) => {
            // Parallel segments meet exactly if an end of one is on the other.
            for (x, from, along) in [(p, r, &e), (q, r, &e), (r, p, &d), (s, p, &d)] {
                if is_on_segment(x, from, along)? {
                    return Some(true);
                }
            }
            Some(false)
        }
    }
}

/// Whether a point in the plane of a triangle that has an area is in the triangle.
fn is_in_triangle<N: Number>(x: &Vector<N>, corners: &[Vector<N>; 3], normal: &Vector<N>) -> Option<bool> {
    for i in 0..3 {
        let (from, to) = (&corners[i], &corners[(i + 1) % 3]);
        if dot(normal, &cross(&minus(to, from), &minus(x, from))).sign()? < 0 {
            return Some(false);
        }
    }
    Some(true)
}

/// Whether a segment and a triangle have a common point.
pub fn segment_meets_triangle<N: Number>([p, q]: [&Vector<N>; 2], corners: &[Vector<N>; 3]) -> Option<bool> {
    let [a, b, c] = corners;
    let (u, v) = (minus(b, a), minus(c, a));
    let normal = cross(&u, &v);
    let meets_edge = || {
        for i in 0..3 {
            if segments_meet([p, q], [&corners[i], &corners[(i + 1) % 3]])? {
                return Some(true);
            }
        }
        Some(false)
    };
    if is_zero(&normal)? {
        return meets_edge();
    }
    let (height_p, height_q) = (dot(&normal, &minus(p, a)), dot(&normal, &minus(q, a)));
    match (height_p.sign()?, height_q.sign()?) {
        (0, 0) => Some(is_in_triangle(p, corners, &normal)? || meets_edge()?),
        (0, _) => is_in_triangle(p, corners, &normal),
        (_, 0) => is_in_triangle(q, corners, &normal),
        (x, y) if x == y => Some(false),
        (x, _) => {
            // The line through p and q passes on the same side of all edges, or through them.
            let along = minus(q, p);
            for i in 0..3 {
                let (from, to) = (minus(&corners[i], p), minus(&corners[(i + 1) % 3], p));
                // The triple product is positive if, seen along the normal, the line passes inside this edge.
                if dot(&along, &cross(&from, &to)).sign()? * x > 0 {
                    return Some(false);
                }
            }
            Some(true)
        }
    }
}
