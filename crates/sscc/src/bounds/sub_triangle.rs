//! Sub-triangles of a triangle pair, by corner weights, for midpoint subdivision (paper, section 5.1).

use glam::DVec3;

use super::pair_corners::PairCorners;
use crate::geometry::TwoTriangles;
use crate::model::mode_rows::squared_distance;

/// Triangles are halved at most this often in each direction, so that corner weights are exact.
pub(super) const MAX_DEPTH: u8 = 20;

/// Weights of the corners of a sub-triangle over the corners of its triangle: multiples of 2^-20, exact.
pub(super) type Weights = [DVec3; 3];

/// The weights of the triangle itself.
pub(super) const UNDIVIDED: Weights = [DVec3::X, DVec3::Y, DVec3::Z];

/// A sub-triangle of each of two triangles.
#[derive(Clone, Copy)]
pub(super) struct SubPair {
    pub(super) a: Weights,
    pub(super) b: Weights,
    pub(super) depth_a: u8,
    pub(super) depth_b: u8,
}

impl SubPair {
    pub(super) const UNDIVIDED: Self = Self { a: UNDIVIDED, b: UNDIVIDED, depth_a: 0, depth_b: 0 };

    /// Returns the corners of the sub-triangles. Their modes are written to `modes` (18 rows).
    pub(super) fn corners<'m>(&self, pair: &PairCorners<'_>, modes: &'m mut [f64]) -> PairCorners<'m> {
        let (modes_a, modes_b) = modes.split_at_mut(modes.len() / 2);
        PairCorners {
            corners: TwoTriangles {
                a: self.a.map(|w| combine(&pair.corners.a, w)),
                b: self.b.map(|w| combine(&pair.corners.b, w)),
            },
            modes_a: combine_modes(&pair.modes_a, &self.a, modes_a),
            modes_b: combine_modes(&pair.modes_b, &self.b, modes_b),
        }
    }

    /// Whether to divide the first triangle. The one whose modes vary more is divided, so that both shrink alike.
    pub(super) fn is_first_divided(&self, pair: &PairCorners<'_>) -> bool {
        let variation = |corners: &[&[f64]; 3], depth: u8| {
            let d = |i: usize, j: usize| squared_distance(corners[i], corners[j]);
            d(0, 1).max(d(1, 2)).max(d(0, 2)) * 0.25_f64.powi(i32::from(depth))
        };
        variation(&pair.modes_a, self.depth_a) >= variation(&pair.modes_b, self.depth_b)
    }

    /// Returns the four pairs with the quarters of the sub-triangle of a, or of b.
    pub(super) fn subdivide(&self, is_a_divided: bool) -> [Self; 4] {
        if is_a_divided {
            quarter(&self.a).map(|a| Self { a, depth_a: self.depth_a + 1, ..*self })
        } else {
            quarter(&self.b).map(|b| Self { b, depth_b: self.depth_b + 1, ..*self })
        }
    }
}

/// Returns the four quarters of a triangle by edge midpoints.
pub(super) fn quarter(weights: &Weights) -> [Weights; 4] {
    let [p, q, r] = *weights;
    let (pq, qr, rp) = ((p + q) * 0.5, (q + r) * 0.5, (r + p) * 0.5);
    [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]]
}

fn combine(corners: &[DVec3; 3], w: DVec3) -> DVec3 {
    corners[0] * w.x + corners[1] * w.y + corners[2] * w.z
}

/// Returns the modes at three points of a triangle, written to `out` (nine rows).
fn combine_modes<'m>(corners: &[&[f64]; 3], weights: &Weights, out: &'m mut [f64]) -> [&'m [f64]; 3] {
    let (first, rest) = out.split_at_mut(out.len() / 3);
    let (second, third) = rest.split_at_mut(first.len());
    for (out, w) in [&mut *first, &mut *second, &mut *third].into_iter().zip(weights) {
        let corners = corners[0].iter().zip(corners[1]).zip(corners[2]);
        for (out, ((a, b), c)) in out.iter_mut().zip(corners) {
            *out = a * w.x + b * w.y + c * w.z;
        }
    }
    [first, second, third]
}
