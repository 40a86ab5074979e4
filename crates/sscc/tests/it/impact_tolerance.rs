//! Compares moving triangles that nearly touch with exact arithmetic: no contact is missed, and listed pairs are within
//! the tolerance at their time.

use glam::{DMat3, DVec3};
use num_traits::ToPrimitive;
use sscc::{Impact, MovingTriangle, impact_triangle_triangle};
use sscc_testing::{cases, threshold};
use sscc_testing::{distance, first_contact};

use crate::common::Random;

/// The ways in which two triangles nearly touch.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// A triangle above another one.
    Sheets,
    /// A triangle above a copy of itself, so that all edges are parallel.
    Twins,
    /// An edge across an edge.
    Edges,
    /// A vertex above a face.
    Vertex,
    /// Two triangles in nearly the same plane, edge beside edge.
    Neighbours,
}

const KINDS: [Kind; 5] = [Kind::Sheets, Kind::Twins, Kind::Edges, Kind::Vertex, Kind::Neighbours];

/// Returns a triangle of about size 1; one in three is a sliver.
fn triangle(random: &mut Random) -> [DVec3; 3] {
    let mut p = [(); 3].map(|()| random.vector());
    if random.below(3) == 0 {
        let foot = p[0] + (p[1] - p[0]) * (3.0 * random.uniform() - 1.0);
        p[2] = foot + random.vector() * random.power(-15.0, -1.0);
    }
    p
}

/// Returns two triangles with a narrow gap. Their motion is a common linear map and translation, plus a random part of
/// between a thousandth of the gap and a hundred gaps.
fn narrow_pair(kind: Kind, random: &mut Random) -> [MovingTriangle; 2] {
    let x = triangle(random);
    let gap = random.power(-13.0, -3.0);
    let normal = (x[1] - x[0]).cross(x[2] - x[0]).normalize_or(DVec3::Z);
    let above = |p: DVec3| p + normal * gap;
    let y = match kind {
        Kind::Sheets => triangle(random).map(|p| above(p - normal * normal.dot(p - x[0]))),
        Kind::Twins => x.map(above),
        Kind::Edges => {
            let middle = x[0] + (x[1] - x[0]) * random.uniform();
            let (along, side) = (random.vector(), random.uniform());
            [middle - along * side, middle + along, middle + along + normal].map(above)
        }
        Kind::Vertex => {
            let w = random.weights();
            let tip = x[0] * w.x + x[1] * w.y + x[2] * w.z;
            [tip, tip + normal + random.vector() * 0.5, tip + normal + random.vector() * 0.5].map(above)
        }
        Kind::Neighbours => {
            let outwards = (x[1] - x[0]).cross(normal).normalize_or(DVec3::X);
            let shift = (x[1] - x[0]) * random.signed();
            let apex = x[0] + outwards + random.vector() * gap;
            [x[0] + shift + outwards * gap, x[1] + shift + outwards * gap, apex]
        }
    };
    let rate = random.power(-3.0, 0.5);
    let map = DMat3::from_cols(random.vector(), random.vector(), random.vector()) * rate;
    let shift = random.vector() * random.power(-1.0, 3.0);
    let noise = gap * random.power(-3.0, 2.0);
    let mut moving =
        |t0: [DVec3; 3]| MovingTriangle { t0, t1: t0.map(|p| p + map * p + shift + random.vector() * noise) };
    [moving(x), moving(y)]
}

/// Returns the unit of tolerances: the largest difference of a corner from the first one of x, in any coordinate.
fn size(x: &MovingTriangle, y: &MovingTriangle) -> f64 {
    let ends = [[x.t0, y.t0], [x.t1, y.t1]];
    let differences = ends.iter().flat_map(|end| end.as_flattened().iter().map(|p| *p - end[0][0]));
    differences.map(|d| d.abs().max_element()).fold(0.0, f64::max)
}

/// Whether the two triangles are within the tolerance at the listed time, if any.
fn is_within_tolerance(x: &MovingTriangle, y: &MovingTriangle, tolerance: f64) -> bool {
    impact_triangle_triangle(x, y, tolerance)
        .is_none_or(|t| distance(x, y, t) <= size(x, y) * (tolerance.max(6e-14) + 1e-15))
}

#[test]
fn times_of_impact_are_within_the_tolerance() {
    let mut listed = [0; KINDS.len()];
    let cases = cases(200);
    for case in 0..cases {
        let kind = KINDS[case % KINDS.len()];
        let [x, y] = narrow_pair(kind, &mut Random::new(case as u64 + 5_000_000));
        let found = impact_triangle_triangle(&x, &y, Impact::TOLERANCE);
        assert!(is_within_tolerance(&x, &y, Impact::TOLERANCE), "case {case}, {kind:?}: {found:?}");
        listed[case % KINDS.len()] += usize::from(found.is_some());
        for tolerance in [0.0, 1e-15] {
            assert!(is_within_tolerance(&x, &y, tolerance), "case {case}, {kind:?} at {tolerance}");
        }
    }
    assert!(
        listed.iter().all(|n| *n >= threshold(4).max(1) && *n < cases / KINDS.len()),
        "{listed:?} of {cases}"
    );
}

#[test]
fn no_narrow_contact_is_missed_or_late() {
    let (mut met, mut free) = (0, 0);
    for case in 0..15 {
        let [x, y] = narrow_pair(KINDS[case % KINDS.len()], &mut Random::new(case as u64 + 6_000_000));
        let found = impact_triangle_triangle(&x, &y, Impact::TOLERANCE);
        if let Some(contact) = first_contact(&x, &y) {
            let upper = contact.upper().to_f64().unwrap();
            assert!(found.is_some_and(|t| t <= upper), "case {case}: {found:?}, met at {upper}");
            met += 1;
        }
        free += usize::from(found.is_none());
    }
    assert!(met >= 3 && free >= 3, "{met} {free}");
}

/// Multiplication by a power of two changes digits only of the smallest coordinates, down to sizes at which products underflow.
#[test]
fn the_tolerance_holds_at_every_size() {
    for case in 0..10 {
        let [x, y] = narrow_pair(KINDS[case % KINDS.len()], &mut Random::new(case as u64 + 7_000_000));
        let found = impact_triangle_triangle(&x, &y, Impact::TOLERANCE);
        for exponent in [-1000_i32, -350, -290, 180] {
            let half = 2.0_f64.powi(exponent / 2);
            let scaled = [&x, &y].map(|m| MovingTriangle {
                t0: m.t0.map(|p| p * half * half),
                t1: m.t1.map(|p| p * half * half),
            });
            let again = impact_triangle_triangle(&scaled[0], &scaled[1], Impact::TOLERANCE);
            let message = format!("case {case} at 2^{exponent}: {found:?} {again:?}");
            assert_eq!(found.is_some(), again.is_some(), "{message}");
            assert!(is_within_tolerance(&scaled[0], &scaled[1], Impact::TOLERANCE), "{message}");
        }
    }
}

/// Two triangles of size 1 with a distance of 1e-9 rotate together: their distance nearly stays the same.
#[test]
fn thin_sheets_that_turn_together_are_free() {
    let sheet = |z: f64| [DVec3::new(0.0, 0.0, z), DVec3::new(1.0, 0.1, z), DVec3::new(0.2, 0.9, z)];
    for angle in [0.1_f64, 0.5, 1.0, 1.5] {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), angle);
        let turning = |t0: [DVec3; 3]| MovingTriangle { t0, t1: t0.map(|p| turn * p) };
        let (x, y) = (turning(sheet(0.0)), turning(sheet(1e-9).map(|p| p * 0.8)));
        assert_eq!(impact_triangle_triangle(&x, &y, Impact::TOLERANCE), None, "{angle}");
        assert_eq!(impact_triangle_triangle(&y, &x, Impact::TOLERANCE), None, "{angle}");
    }
}

/// A vertex ends exactly on a face: coordinates have so few digits that its position, with weights of quarters, is
/// exact, while normals and projections are rounded.
#[test]
fn what_touches_at_the_end_is_listed() {
    let random = &mut Random::new(8);
    let mut coarse = || (random.vector() * 1_048_576.0).round() / 1_048_576.0;
    for case in 0..cases(2_000) {
        let face = [coarse(), coarse(), coarse()];
        let still = MovingTriangle { t0: face, t1: face };
        let foot = face[0] * 0.5 + face[1] * 0.25 + face[2] * 0.25;
        let normal = (face[1] - face[0]).cross(face[2] - face[0]);
        let falling = MovingTriangle { t0: [foot + normal + coarse() * 0.01; 3], t1: [foot; 3] };
        let found = impact_triangle_triangle(&still, &falling, Impact::TOLERANCE);
        assert!(found.is_some(), "case {case}: {face:?}");
    }
}

/// Rounded numbers do not decide the closest features of this pair of segments, while other features have a gap of a few
/// units in the last place.
#[test]
fn tolerances_below_rounding_do_not_end_the_search_early() {
    let v = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let x = MovingTriangle {
        t0: [
            v(-0.1907448245801957, 0.9256470542548139, 0.9114161446222993),
            v(-0.5487552826942179, -0.1271054168354524, -0.21741067016141025),
            v(-0.1907448245801957, 0.9256470542548139, 0.9114161446222993),
        ],
        t1: [
            v(-6.370234616071897, -1.5973964283573123, -2.1579011704603435),
            v(-5.018062506543551, -1.5085708241459501, -2.9791501153804893),
            v(-6.370234616071476, -1.5973964283573714, -2.1579011704601556),
        ],
    };
    let y = MovingTriangle {
        t0: [
            v(-0.19074482464749204, 0.9256470542087879, 0.9114161446865666),
            v(-0.5487552827615143, -0.12710541688147833, -0.2174106700971429),
            v(0.16493219884177196, 1.97153789893494, 2.0328855009199795),
        ],
        t1: [
            v(-6.370234616108316, -1.597396428274924, -2.1579011705117175),
            v(-5.018062506580039, -1.5085708240632354, -2.979150115431044),
            v(-7.713593548824641, -1.6856430885550853, -1.3420049602423139),
        ],
    };
    assert!(is_within_tolerance(&x, &y, 0.0));
    assert_eq!(impact_triangle_triangle(&x, &y, Impact::TOLERANCE), None);
}
