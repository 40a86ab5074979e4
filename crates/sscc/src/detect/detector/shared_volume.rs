//! The volume that two closed meshes share, as a sum over pairs of triangles whose projections along z overlap.

use glam::DVec3;

use crate::geometry::{Aabb, overlap_integral};
use crate::{CancelToken, Error};

/// Number of pairs between two checks whether the search was cancelled.
const PAIRS: usize = 1 << 12;

/// Returns the volume that two closed meshes share, and a bound of its rounding error. `sign`: -1 if exactly one of them faces inward,
/// otherwise 1.
///
/// # Errors
/// When the token cancels.
pub(super) fn shared_volume(
    meshes: [&[[DVec3; 3]]; 2],
    sign: f64,
    cancel: Option<&CancelToken>,
) -> Result<(f64, f64), Error> {
    let aabbs = meshes.map(|mesh| Aabb::of_points(mesh.iter().flatten().copied()));
    if aabbs[0].is_disjoint(&aabbs[1]) {
        return Ok((0.0, 0.0));
    }
    let shared =
        Aabb { lower: aabbs[0].lower.max(aabbs[1].lower), upper: aabbs[0].upper.min(aabbs[1].upper) };
    let center = shared.center();
    // Only triangles over the shared box can overlap triangles of the other mesh.
    let [a, b] = meshes.map(|mesh| spans(mesh, &shared, center));
    let (mut sum, mut error, mut pairs) = (0.0_f64, 0.0, 0_usize);
    let (mut open_a, mut open_b): (Vec<&Span>, Vec<&Span>) = (Vec::new(), Vec::new());
    let (mut at_a, mut at_b) = (0, 0);
    while at_a < a.len() || at_b < b.len() {
        let is_of_a = at_b == b.len() || at_a < a.len() && a[at_a].lower.x <= b[at_b].lower.x;
        let span = if is_of_a { &a[at_a] } else { &b[at_b] };
        let (own, others) = if is_of_a { (&mut open_a, &mut open_b) } else { (&mut open_b, &mut open_a) };
        others.retain(|other| other.upper.x >= span.lower.x);
        for other in
            others.iter().filter(|other| other.lower.y <= span.upper.y && span.lower.y <= other.upper.y)
        {
            let (x, y) = if is_of_a { (span, *other) } else { (*other, span) };
            let term = overlap_integral(&x.corners, &y.corners);
            sum += term.value;
            error += term.error + f64::EPSILON * sum.abs();
            pairs += 1;
            if pairs.is_multiple_of(PAIRS) && cancel.is_some_and(CancelToken::is_cancelled) {
                return Err(Error::Cancelled);
            }
        }
        own.push(span);
        if is_of_a { at_a += 1 } else { at_b += 1 }
    }
    Ok(((sign * sum).max(0.0), error))
}

/// A triangle relative to the centre, with its AABB.
struct Span {
    corners: [DVec3; 3],
    lower: DVec3,
    upper: DVec3,
}

/// Returns the triangles over the box, in the order of their smallest x.
fn spans(mesh: &[[DVec3; 3]], shared: &Aabb, center: DVec3) -> Vec<Span> {
    let is_over =
        |aabb: &Aabb| (0..2).all(|k| aabb.lower[k] <= shared.upper[k] && shared.lower[k] <= aabb.upper[k]);
    let over = mesh.iter().filter(|corners| is_over(&Aabb::of_triangle(**corners)));
    let mut spans: Vec<Span> = over
        .map(|corners| {
            let corners = corners.map(|p| p - center);
            let Aabb { lower, upper } = Aabb::of_triangle(corners);
            Span { corners, lower, upper }
        })
        .collect();
    spans.sort_unstable_by(|a, b| a.lower.x.total_cmp(&b.lower.x));
    spans
}
