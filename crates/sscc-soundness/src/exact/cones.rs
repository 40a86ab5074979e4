//! Tests whether two cones, each spanned by two vectors from a common apex, have a common point other than the apex.
//!
//! Near a common corner a triangle is the cone of its two edges, also where it has no area. The common part of two cones is a
//! cone, and one of its extreme rays is an extreme ray of one of them, or a common ray of both planes.

use super::number::Number;
use super::vectors::{Vector, cross, dot, is_zero, minus, plus};

/// Whether the ray along `x`, which is not 0, is in the cone of `a` and `b`.
fn contains<N: Number>(x: &Vector<N>, [a, b]: [&Vector<N>; 2]) -> Option<bool> {
    let normal = cross(a, b);
    if is_zero(&normal)? {
        // The cone is a ray, a line or only the apex.
        for along in [a, b] {
            if is_zero(&cross(x, along))? && dot(x, along).sign()? > 0 {
                return Some(true);
            }
        }
        return Some(false);
    }
    let in_plane = dot(x, &normal).sign()? == 0;
    Some(in_plane && dot(&cross(a, x), &normal).sign()? >= 0 && dot(&cross(x, b), &normal).sign()? >= 0)
}

/// Whether two cones, given by the ends of their edges and the apex, have a common point other than the apex.
pub fn cones_meet<N: Number>(apex: &Vector<N>, a: [&Vector<N>; 2], b: [&Vector<N>; 2]) -> Option<bool> {
    let [a, b] = [a, b].map(|[p, q]| [minus(p, apex), minus(q, apex)]);
    let ([a0, a1], [b0, b1]) = (&a, &b);
    for (rays, [p, q]) in [([a0, a1], [b0, b1]), ([b0, b1], [a0, a1])] {
        for ray in rays {
            if !is_zero(ray)? && contains(ray, [p, q])? {
                return Some(true);
            }
        }
    }
    let common = cross(&cross(a0, a1), &cross(b0, b1));
    if is_zero(&common)? {
        return Some(false);
    }
    let zero = minus(&common, &common);
    let opposite = minus(&zero, &plus(&common, &zero));
    for ray in [&common, &opposite] {
        if contains(ray, [a0, a1])? && contains(ray, [b0, b1])? {
            return Some(true);
        }
    }
    Some(false)
}
