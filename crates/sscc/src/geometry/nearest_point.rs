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
        corners[count] = entering;
        weights[count] = 0.0;
        count += 1;
        // Move to the smallest point of the affine hull; while that lies outside, stop at the
        // boundary and remove the corner whose weight vanishes there.
        while let Some(goal) = affine_minimum(&corners, count, d) {
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
            corners.copy_within(i + 1..count, i);
            weights.copy_within(i + 1..count, i);
            count -= 1;
        }
        let sum: f64 = weights[..count].iter().sum();
        weights[..count].iter_mut().for_each(|w| *w = w.max(0.0) / sum);
        point = (0..count).map(|i| d[corners[i]] * weights[i]).sum();
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

/// Returns the weights (their sum is 1) of the smallest point in the affine hull of the corners, by least squares over the edges
/// from the first corner. None when the corners are affinely dependent.
fn affine_minimum<const N: usize>(corners: &[usize; 4], count: usize, d: &[DVec3; N]) -> Option<[f64; 4]> {
    let first = d[corners[0]];
    let edges: [DVec3; 3] = std::array::from_fn(|i| d[corners[(i + 1) % 4]] - first);
    let n = count - 1;
    let mut m = [[0.0; 4]; 3];
    for i in 0..n {
        for j in 0..n {
            m[i][j] = edges[i].dot(edges[j]);
        }
        m[i][3] = -edges[i].dot(first);
    }
    // Elimination without pivoting: the matrix is positive definite.
    for i in 0..n {
        if m[i][i] <= 1e-12 * edges[i].length_squared() || m[i][i].is_nan() {
            return None;
        }
        for j in i + 1..n {
            let factor = m[j][i] / m[i][i];
            for k in i..4 {
                m[j][k] -= factor * m[i][k];
            }
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

#[cfg(test)]
mod tests {
    use super::*;

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
            let mut corners = [0; 4];
            corners[..set.len()].copy_from_slice(set);
            if let Some(w) = affine_minimum(&corners, set.len(), d)
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
}
