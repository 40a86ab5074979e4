//! The volume that two closed meshes share, as a sum over pairs of triangles whose projections along z overlap.

use glam::DVec3;

use crate::geometry::{Aabb, overlap_integral};
use crate::{CancelToken, Error};

/// Pairs of triangles compared between two checks for cancellation, whether their projections overlap or not. An integral takes some
/// microseconds.
const PAIRS_PER_CHECK: usize = 1 << 10;

/// Returns the volume that two closed meshes share, and a bound of its rounding error. `sign`: -1 if exactly one of them faces inward,
/// otherwise 1.
///
/// # Errors
/// When the token cancels; when the sum is negative, because parts that face inward are joined with others in single vertices.
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
        for other in others.iter() {
            pairs += 1;
            if pairs.is_multiple_of(PAIRS_PER_CHECK) && cancel.is_some_and(CancelToken::is_cancelled) {
                return Err(Error::Cancelled);
            }
            if other.lower.y > span.upper.y || span.lower.y > other.upper.y {
                continue;
            }
            let (x, y) = if is_of_a { (span, *other) } else { (*other, span) };
            let term = overlap_integral(&x.corners, &y.corners);
            sum += term.value;
            error += term.error + f64::EPSILON * sum.abs();
        }
        own.push(span);
        if is_of_a { at_a += 1 } else { at_b += 1 }
    }
    let volume = sign * sum;
    if with_mutant!(volume < -error, NegativeVolumeIsNone, false) {
        return Err(Error::OpenMesh("first or the second"));
    }
    Ok((volume.max(0.0), error))
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// The projections of all triangles overlap along x, but none overlap along y, so that no integral is computed.
    #[test]
    fn pairs_whose_projections_are_disjoint_count_as_work() {
        let strip = |first: f64| -> Vec<[DVec3; 3]> {
            let at = |i: i32| 2.0 * f64::from(i) + first;
            let triangle =
                |y: f64| [[0.0, y, 0.0], [9.0, y, 0.0], [4.0, y + 0.5, 1.0]].map(DVec3::from_array);
            (0..200).map(|i| triangle(at(i))).collect()
        };
        let (a, b) = (strip(0.0), strip(1.0));
        let sum = |most: usize| {
            let checks = Arc::new(AtomicUsize::new(0));
            let counted = Arc::clone(&checks);
            let token = CancelToken::when(move || counted.fetch_add(1, Ordering::Relaxed) >= most);
            (shared_volume([&a, &b], 1.0, Some(&token)), checks.load(Ordering::Relaxed))
        };
        let (found, checks) = sum(usize::MAX);
        assert_eq!(found, Ok((0.0, 0.0)));
        assert!(checks > 20, "{checks}");
        assert_eq!(sum(5), (Err(Error::Cancelled), 6));
    }

    #[test]
    fn the_error_of_a_sum_is_that_of_its_terms_and_of_its_rounding() {
        // Heights 1 + x + y and the opposite; the shared box has its centre at 0.
        let at = |z: f64| [[-1.0, -1.0, -z], [1.0, -1.0, z], [-1.0, 1.0, z]].map(DVec3::from_array);
        let (a, b) = (vec![at(1.0)], vec![at(-1.0)]);
        let term = overlap_integral(&a[0], &b[0]);
        let size = term.value.abs();
        assert!(size > 0.1);
        let found = shared_volume([&a, &b], term.value.signum(), None);
        assert_eq!(found, Ok((size, term.error + f64::EPSILON * size)));
    }
}
