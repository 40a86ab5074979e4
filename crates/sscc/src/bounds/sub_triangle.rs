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

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::bounds::tests::random::Random;

    /// Each point of a triangle is in one of its quarters, and each of these has a quarter of its area.
    #[test]
    fn quarters_cover_their_triangle() {
        let matrix = |[p, q, r]: Weights| DMat3::from_cols(p, q, r);
        for case in 0..300 {
            let random = &mut Random::new(case);
            let depth = random.below(6);
            let weights =
                (0..depth).fold(UNDIVIDED, |weights: Weights, _| quarter(&weights)[random.below(4)]);
            let (whole, quarters) = (matrix(weights), quarter(&weights).map(matrix));
            for part in &quarters {
                let share = part.determinant().abs() / whole.determinant().abs();
                assert!((share - 0.25).abs() < 1e-9, "case {case}: {share}");
            }
            for _ in 0..20 {
                let point = whole * random.weights();
                let is_inside = |part: &DMat3| (part.inverse() * point).min_element() > -1e-9;
                assert!(quarters.iter().any(is_inside), "case {case}: {point}");
            }
        }
    }

    /// Corners of sub-triangles, and their modes, are the combinations that the weights define.
    #[test]
    fn corners_are_combinations() {
        for case in 0..50 {
            let random = &mut Random::new(case);
            let corners = [(); 2].map(|()| [(); 3].map(|()| random.vector()));
            let modes: Vec<Vec<f64>> =
                (0..6).map(|_| (0..24).map(|_| random.uniform() - 0.5).collect()).collect();
            let of = |v: usize| modes[v].as_slice();
            let pair = PairCorners {
                corners: TwoTriangles { a: corners[0], b: corners[1] },
                modes_a: [of(0), of(1), of(2)],
                modes_b: [of(3), of(4), of(5)],
            };
            let [a, b] = [(); 2].map(|()| -> Weights { [(); 3].map(|()| random.weights()) });
            let mut memory = vec![f64::NAN; 6 * 24];
            let part = SubPair { a, b, depth_a: 1, depth_b: 1 }.corners(&pair, &mut memory);
            let sides = [(a, part.corners.a, part.modes_a), (b, part.corners.b, part.modes_b)];
            for (side, (weights, found, found_modes)) in sides.into_iter().enumerate() {
                for (i, w) in weights.into_iter().enumerate() {
                    let expected: DVec3 = (0..3).map(|v| corners[side][v] * w[v]).sum();
                    assert!((found[i] - expected).length() < 1e-14, "case {case}");
                    for (at, x) in found_modes[i].iter().enumerate() {
                        let expected: f64 = (0..3).map(|v| modes[3 * side + v][at] * w[v]).sum();
                        assert!((x - expected).abs() < 1e-14, "case {case}: {at}");
                    }
                }
            }
        }
    }
}
