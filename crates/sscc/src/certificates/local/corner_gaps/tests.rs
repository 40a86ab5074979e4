//! Tests gaps of corners against exact arithmetic.

use sscc_testing::{Dyadic, Numbers};

use super::*;
use crate::{ContactFilter, Modes, ReducedModel, TriMesh};

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

/// All leaves of a cylinder of long thin triangles are near each other.
#[test]
fn meshes_with_too_many_near_leaves_have_no_tables() {
    let angle = |i: usize, quads: usize| std::f64::consts::TAU * i as f64 / quads as f64;
    let is_bounded = |quads: usize, length: f64| {
        let at =
            |i: usize| [0.0, length].map(|z| DVec3::new(angle(i, quads).cos(), angle(i, quads).sin(), z));
        let positions: Vec<DVec3> = (0..=quads).flat_map(at).collect();
        let corners = |i: u32| [[i, i + 1, i + 2], [i + 1, i + 3, i + 2]];
        let faces = (0..quads as u32).flat_map(|i| corners(2 * i)).collect();
        let modes = Modes::from_matrix(positions.len(), 1, |row, _| (row as f64).sin()).unwrap();
        let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        CornerGaps::new(&hierarchy, &filter, model.mesh().rest_positions(), &()).unwrap().is_some()
    };
    assert!(is_bounded(3000, 0.01) && is_bounded(200, 10.0));
    assert!(!is_bounded(3000, 10.0));
}

/// Also as tables store them, in single precision.
#[test]
fn stored_gaps_do_not_exceed_exact_distances() {
    let random = &mut Numbers(17);
    let mut close = 0;
    for case in 0..200 {
        // Two triangles, one above the other: the gaps of opposite corners are their distances.
        let height = 0.3 + 0.4 * random.signed().abs();
        let low = [DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.5];
        let positions = [low, low.map(|p| p + DVec3::Z * height)].concat();
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::from_matrix(6, 1, |row, _| (row as f64).sin()).unwrap();
        let model = ReducedModel::new(mesh, modes).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let positions = model.mesh().rest_positions();
        let gaps = CornerGaps::new(&hierarchy, &filter, positions, &()).unwrap().unwrap();
        let table = gaps.near((0, 0)).unwrap().as_ref().unwrap();
        let vertices = gaps.vertices(0);
        let pairs = vertices.iter().flat_map(|i| vertices.iter().map(move |j| (*i, *j)));
        for ((i, j), gap) in pairs.zip(&table.gaps).filter(|(_, gap)| **gap < f32::INFINITY) {
            let (d, gap) = (positions[j as usize] - positions[i as usize], f64::from(*gap));
            let square: Dyadic = d.to_array().iter().map(|x| exact(*x) * exact(*x)).sum();
            assert!(exact(gap) * exact(gap) <= square, "case {case}: {gap} {d}");
            close += usize::from(gap > d.length() * (1.0 - 2e-6));
        }
    }
    assert!(close >= 600, "{close}");
}
