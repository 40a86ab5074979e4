//! Tests gaps of corners against exact arithmetic.

use sscc_testing::{Dyadic, Numbers};

use super::*;

fn exact(x: f64) -> Dyadic {
    Dyadic::new(x)
}

/// No gap along a unit direction is longer than the difference itself, and triangles are at least as far apart as the smallest gap.
#[test]
fn gaps_do_not_exceed_exact_distances() {
    let random = &mut Numbers(5);
    let (mut found, mut equal) = (0, 0);
    for case in 0..4000 {
        let size = random.power(-7.0, 0.0);
        let apart = random.vector() * random.power(-8.0, 0.0);
        // In every third case both triangles are points.
        let corner = if case % 3 == 0 { 0.0 } else { size };
        let [p, q] = [DVec3::ZERO, apart].map(|at| [(); 3].map(|()| at + random.vector() * corner));
        let differences: [DVec3; 9] = std::array::from_fn(|ij| q[ij % 3] - p[ij / 3]);
        let Some(gaps) = widest_gaps(&differences) else { continue };
        found += 1;
        for (d, gap) in differences.iter().zip(gaps) {
            let square: Dyadic = d.to_array().iter().map(|x| exact(*x) * exact(*x)).sum();
            assert!(gap > 0.0 && exact(gap) * exact(gap) <= square, "case {case}: {gap} {d}");
            equal += usize::from(gap > d.length() * (1.0 - 1e-5));
        }
        let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        let nearest = nearest_to_origin(&differences).point.length();
        assert!(smallest <= nearest * (1.0 + 1e-9), "case {case}: {smallest} {nearest}");
    }
    assert!(found > 1500 && equal > 3000, "{found} {equal}");
}

/// Two triangles along one line: the smallest gap is not that of the centroids.
#[test]
fn gaps_differ_from_corner_to_corner() {
    let along = [1.0, 2.0, 3.0];
    let gaps = widest_gaps(&std::array::from_fn(|ij| DVec3::X * (along[ij % 3] + along[ij / 3]))).unwrap();
    for (ij, gap) in gaps.into_iter().enumerate() {
        let expected = along[ij % 3] + along[ij / 3];
        assert!(gap <= expected && gap > expected - 1e-12, "{gap} {expected}");
    }
}
