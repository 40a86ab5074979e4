//! The point of smallest norm in the convex hull of a few points in space (Wolfe 1976, *Finding the Nearest Point in a
//! Polytope*).
//!
//! Its results are candidates: directions and weights that other code evaluates with rounding bounds. So its own rounding
//! makes bounds weaker, never wrong.

use glam::DVec3;

/// The nearest point of a hull to the origin, and its weights over the given points.
pub(crate) struct Nearest<const N: usize> {
    pub(crate) weights: [f64; N],
    pub(crate) point: DVec3,
}

/// Minimises `|sum w_i d_i|` over convex weights w.
pub(crate) fn nearest_to_origin<const N: usize>(d: &[DVec3; N]) -> Nearest<N> {
    nearest_within(d, 0.0)
}

/// Minimises like [`nearest_to_origin`], but may return any point of the hull whose norm is less than `enough`.
pub(crate) fn nearest_within<const N: usize>(d: &[DVec3; N], enough: f64) -> Nearest<N> {
    let start = index_of_smallest(&d.map(|d| d.length_squared()));
    let mut corners = [start, 0, 0, 0];
    let mut hull = [d[start]; 4];
    let mut weights = [1.0, 0.0, 0.0, 0.0];
    let mut count = 1;
    let mut point = d[start];
    for _ in 0..3 * N {
        let norm = point.length_squared();
        if norm < enough * enough {
            break;
        }
        let along = d.map(|d| d.dot(point));
        let entering = index_of_smallest(&along);
        let done = norm - along[entering] <= 1e-10 * norm;
        if done || count == 4 || corners[..count].contains(&entering) {
            break;
        }
        (corners[count], hull[count], weights[count]) = (entering, d[entering], 0.0);
        count += 1;
        // Move to the smallest point of the affine hull; while that lies outside, stop at the
        // boundary and remove the corner whose weight vanishes there.
        while let Some(goal) = affine_minimum(&hull[..count]) {
            let mut step = 1.0;
            let mut leaving = None;
            for i in 0..count {
                if goal[i] <= 1e-14 {
                    let t = weights[i] / (weights[i] - goal[i]).max(f64::MIN_POSITIVE);
                    if t < step || leaving.is_none() {
                        step = t.min(step);
                        leaving = Some(i);
                    }
                }
            }
            for i in 0..count {
                weights[i] += step * (goal[i] - weights[i]);
            }
            let Some(i) = leaving else { break };
            if count == 1 {
                break;
            }
            for k in i + 1..count {
                (corners[k - 1], hull[k - 1], weights[k - 1]) = (corners[k], hull[k], weights[k]);
            }
            count -= 1;
        }
        let sum: f64 = weights[..count].iter().sum();
        weights[..count].iter_mut().for_each(|w| *w = w.max(0.0) / sum);
        point = (0..count).map(|i| hull[i] * weights[i]).sum();
    }
    let mut all = [0.0; N];
    for i in 0..count {
        all[corners[i]] += weights[i];
    }
    Nearest { weights: all, point }
}

fn index_of_smallest<const N: usize>(values: &[f64; N]) -> usize {
    (0..N).fold(0, |best, i| if values[i] < values[best] { i } else { best })
}

/// Returns the weights (their sum is 1) of the smallest point in the affine hull of one to four points, by least squares over
/// the edges from the first one. None when the points are affinely dependent.
///
/// The matrix is positive definite, so that elimination needs no pivoting. It is written out for each number of edges, because
/// loops are slower (docs/notes/exact-tests.md#nearest-points).
#[inline]
fn affine_minimum(points: &[DVec3]) -> Option<[f64; 4]> {
    debug_assert!((1..=4).contains(&points.len()));
    let (&first, others) = points.split_first()?;
    // The weights of the points but the first one.
    let [x, y, z] = match *others {
        [] => [0.0; 3],
        [p] => {
            let e = p - first;
            let ee = e.dot(e);
            if is_singular(ee, ee) {
                return None;
            }
            [-e.dot(first) / ee, 0.0, 0.0]
        }
        [p, q] => {
            let [e, f] = [p - first, q - first];
            let [ee, ef, ff] = [e.dot(e), e.dot(f), f.dot(f)];
            if is_singular(ee, ee) {
                return None;
            }
            let (factor, of_e) = (ef / ee, -e.dot(first));
            let (pivot, of_f) = (ff - factor * ef, -f.dot(first) - factor * of_e);
            if is_singular(pivot, ff) {
                return None;
            }
            let y = of_f / pivot;
            [(of_e - ef * y) / ee, y, 0.0]
        }
        [p, q, r, ..] => {
            let [e, f, g] = [p - first, q - first, r - first];
            let [ee, ef, eg] = [e, f, g].map(|other| e.dot(other));
            let [ff, fg, gg] = [f.dot(f), f.dot(g), g.dot(g)];
            if is_singular(ee, ee) {
                return None;
            }
            let (factor_f, factor_g, of_e) = (ef / ee, eg / ee, -e.dot(first));
            let [row_f, row_g] =
                [(ff, fg, f, factor_f), (fg, gg, g, factor_g)].map(|(with_f, with_g, edge, factor)| {
                    [with_f - factor * ef, with_g - factor * eg, -edge.dot(first) - factor * of_e]
                });
            if is_singular(row_f[0], ff) {
                return None;
            }
            let factor = row_g[0] / row_f[0];
            let (pivot, of_g) = (row_g[1] - factor * row_f[1], row_g[2] - factor * row_f[2]);
            if is_singular(pivot, gg) {
                return None;
            }
            let z = of_g / pivot;
            let y = (row_f[2] - row_f[1] * z) / row_f[0];
            [(of_e - (ef * y + eg * z)) / ee, y, z]
        }
    };
    let weights = [1.0 - (x + y + z), x, y, z];
    weights.iter().all(|weight| weight.is_finite()).then_some(weights)
}

/// Whether at most 1e-12 of the squared length of an edge is left once its part along the edges before it is subtracted, or NaN.
#[inline]
fn is_singular(pivot: f64, squared_length: f64) -> bool {
    pivot <= 1e-12 * squared_length || pivot.is_nan()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Returns the smallest distance over all corners, edges and faces of the hull.
    fn naive(d: &[DVec3; 9]) -> f64 {
        let mut best = f64::INFINITY;
        let mut seen = vec![vec![]];
        for i in 0..9 {
            for set in seen.clone() {
                if set.len() < 3 {
                    seen.push([set, vec![i]].concat());
                }
            }
        }
        for set in seen.iter().filter(|s| !s.is_empty()) {
            let corners: Vec<DVec3> = set.iter().map(|&c| d[c]).collect();
            if let Some(w) = affine_minimum(&corners)
                && w.iter().all(|w| *w >= -1e-12)
            {
                let point: DVec3 = set.iter().enumerate().map(|(i, &c)| d[c] * w[i]).sum();
                best = best.min(point.length());
            }
        }
        best
    }

    #[test]
    fn the_nearest_point_of_triangle_differences_is_that_of_all_features() {
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / 2.0_f64.powi(31) - 0.5
        };
        for case in 0..3000 {
            let mut corner = |shift: f64| {
                let p = DVec3::new(random(), random(), random());
                // Every other case is on a grid, and has parallel edges and equal differences.
                (if case % 2 == 0 { (p * 3.0).round() } else { p }) + DVec3::X * shift
            };
            let (x, y) = ([(); 3].map(|()| corner(0.0)), [(); 3].map(|()| corner(4.5)));
            let d: [DVec3; 9] = std::array::from_fn(|i| y[i % 3] - x[i / 3]);
            let nearest = nearest_to_origin(&d);
            let (found, exact) = (nearest.point.length(), naive(&d));
            assert!(found <= exact * (1.0 + 1e-6), "case {case}: {found} {exact}");
            assert!((nearest.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    /// Returns the same weights as [`affine_minimum`], up to the sign of zeros, by loops over the matrix.
    fn affine_minimum_by_loops(points: &[DVec3]) -> Option<[f64; 4]> {
        let n = points.len() - 1;
        let edge = |i: usize| points[i + 1] - points[0];
        let mut m = [[0.0; 4]; 3];
        for i in 0..n {
            (0..n).for_each(|j| m[i][j] = edge(i).dot(edge(j)));
            m[i][3] = -edge(i).dot(points[0]);
        }
        for i in 0..n {
            if m[i][i] <= 1e-12 * edge(i).length_squared() || m[i][i].is_nan() {
                return None;
            }
            for j in i + 1..n {
                let factor = m[j][i] / m[i][i];
                (i..4).for_each(|k| m[j][k] -= factor * m[i][k]);
            }
        }
        let mut w = [0.0; 4];
        for i in (0..n).rev() {
            let rest: f64 = (i + 1..n).map(|k| m[i][k] * w[k + 1]).sum();
            w[i + 1] = (m[i][3] - rest) / m[i][i];
        }
        w[0] = 1.0 - (w[1] + w[2] + w[3]);
        w.iter().all(|x| x.is_finite()).then_some(w)
    }

    #[test]
    fn weights_in_affine_hulls_are_those_of_elimination_by_loops() {
        let random = &mut Random(5);
        let mut found = [[0; 2]; 4];
        for case in 0..4000 {
            let mut points: Vec<DVec3> = (0..1 + case % 4)
                .map(|_| match case / 4 % 4 {
                    0 => (random.vector() * 2.0).round(),
                    1 => random.vector() * 10.0_f64.powi(-156 - (case / 16 % 8) as i32),
                    2 => random.vector() * 10.0_f64.powi(148 + (case / 16 % 8) as i32),
                    _ => random.vector() + DVec3::splat(1e6),
                })
                .collect();
            if case % 64 >= 48 {
                let wrong = random.below(points.len());
                points[wrong].y = [f64::NAN, f64::INFINITY][case / 64 % 2];
            }
            let expected = affine_minimum_by_loops(&points);
            assert_eq!(affine_minimum(&points), expected, "case {case}: {points:?}");
            found[case % 4][usize::from(expected.is_some())] += 1;
        }
        // One point is never dependent; any other number of points is both at times.
        assert!(found[0][0] == 0 && found[1..].as_flattened().iter().all(|n| *n > 20), "{found:?}");
    }
}
