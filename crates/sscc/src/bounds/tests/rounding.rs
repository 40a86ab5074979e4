//! Tests bounds where rounding decides: against exact arithmetic, and against computed positions that meet although exact
//! positions do not.

use glam::DVec3;
use sscc_testing::Dyadic;

use super::models::{all_bounds, node_pair_bound};
use super::random::Random;
use crate::model::mode_rows::{dot, padded_rank};
use crate::model::rounding::{norm_up, quotient_down};
use crate::{Metric, Modes, ReducedModel, TriMesh, intersect_triangle_triangle};

/// Returns a number in exact arithmetic.
pub(crate) fn exact(x: f64) -> Dyadic {
    Dyadic::new(x)
}

/// Returns two copies of horizontal faces at two heights; modes move each copy up or down as a whole.
fn stacked(corners: &[DVec3], faces: &[[u32; 3]], heights: [f64; 2], modes: &[[f64; 2]]) -> ReducedModel {
    let p = heights.iter().flat_map(|z| corners.iter().map(move |p| *p + DVec3::Z * z)).collect();
    let above = |face: &[u32; 3]| face.map(|v| v + corners.len() as u32);
    let faces = faces.iter().copied().chain(faces.iter().map(above)).collect();
    let of_vertex = |v: usize| modes.iter().map(move |u| DVec3::Z * u[v / corners.len()]);
    let displacements = (0..2 * corners.len()).flat_map(of_vertex).collect();
    let (mesh, modes) = (TriMesh::new(p, faces).unwrap(), Modes::new(modes.len(), displacements).unwrap());
    let metric = Metric::identity(modes.rank());
    ReducedModel::with_metric(mesh, modes, metric).unwrap()
}

/// Checks that no bound is larger than the norm of a q at which the computed positions touch, for two triangles at two heights
/// and for two squares as nodes (whose affine fit is free of rounding).
fn check(heights: [f64; 2], modes: &[[f64; 2]], q: &[f64]) {
    let norm = Metric::identity(q.len()).length(q);
    let triangle = stacked(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]], heights, modes);
    let at = |faces: usize| triangle.mesh().faces()[faces].map(|v| triangle.position(v, q));
    assert!(intersect_triangle_triangle(&at(0), &at(1)), "{heights:?} {q:?}");
    for (name, bound) in all_bounds(&triangle, &mut Random::new(1)) {
        assert!(bound <= norm, "{name} {bound:e} above {norm:e}, {heights:?}");
    }
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let square = stacked(&corners, &[[0, 1, 2], [0, 2, 3]], heights, modes);
    let bound = node_pair_bound(&square, 2);
    assert!(bound <= norm, "node pair {bound:e} above {norm:e}, {heights:?}");
}

/// Far from the origin the last 0.4 units of the gap are closed by rounding.
#[test]
fn bounds_include_rounding_of_rest_positions() {
    let random = &mut Random::new(1);
    for case in 0..60 {
        let far = 2.0_f64.powi(case % 60) * (1.0 + random.uniform());
        let unit = far.next_up() - far;
        let gap = (150.0 + 1500.0 * random.uniform()).round() * unit;
        check([far, far + gap], &[[0.0, -1.0]], &[gap - 0.4 * unit]);
    }
}

/// Rounding of a large common motion closes the gap, while the relative motion is nearly 0.
#[test]
fn bounds_include_rounding_of_motion() {
    let random = &mut Random::new(2);
    for _ in 0..60 {
        let common = 2.0_f64.powi(random.below(50) as i32) * (1.0 + random.uniform());
        let gap = 0.45 * (common.next_up() - common);
        check([0.0, gap], &[[0.0, -1e-18], [1.0, 1.0]], &[0.0, common]);
    }
}

/// Roots and quotients are on the safe side of the exact numbers, and close to them.
#[test]
fn roots_are_rounded_up_and_quotients_down() {
    let random = &mut Random::new(3);
    let larger = exact(1.0 + 1e-13);
    for case in 0..2000 {
        let mut row = vec![0.0; padded_rank(1 + case % 30)];
        row.iter_mut().for_each(|x| *x = random.power(-3.0, 3.0));
        let square: Dyadic = row.iter().map(|x| exact(*x) * exact(*x)).sum();
        let norm = exact(norm_up(dot(&row, &row), row.len()));
        assert!(&norm * &norm >= square && &norm * &norm <= square * &larger * &larger, "{row:?}");
        let (x, y) = (random.power(-9.0, 9.0), random.power(-9.0, 9.0));
        let product = exact(quotient_down(x, y)) * exact(y);
        assert!(product <= exact(x) && product * &larger >= exact(x), "{x} / {y}");
    }
}
