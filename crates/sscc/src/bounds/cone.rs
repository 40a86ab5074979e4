//! How fast an affine deformation can close gaps along the directions that occur between two triangles.
//!
//! `f(u) = |G(u)'u|` over unit directions u is the norm of a quadratic form. On the cone spanned by three
//! directions, `u = sum m_i u_i` with `m >= 0`, let `c_ij = u_i' sym(G) u_j` (one number for each mode). Then
//!
//! ```text
//! f(u) |u|^2 = |sum_ij m_i m_j c_ij|,   |u|^2 = sum_ij m_i m_j u_i.u_j,   so   f(u) <= max over i <= j of |c_ij| / u_i.u_j
//! ```
//!
//! where all `u_i.u_j > 0`. The error is quadratic in the width of the cone, so halving it helps quickly, and a
//! test costs six forms of a 6 x 6 matrix whatever the number of modes.

use glam::DVec3;

use super::affine::StrainGram;

/// Cones looked at for one pair of triangles. More than this gained nothing on bunny and spring.
const CONES: usize = 48;

struct Cone {
    rate: f64,
    directions: [DVec3; 3],
}

/// An upper bound of `f(u)` over all directions of the hull of `d`, refined until it is at most `wanted` or no
/// refinement helps; infinite where the directions do not fit into a narrow cone.
pub(super) fn cone_rate(d: &[DVec3; 9], gram: &StrainGram, row: usize, mut wanted: f64) -> f64 {
    let Some(corners) = pyramid(d) else { return f64::INFINITY };
    let trace: f64 = (0..6).map(|i| gram[i][i]).sum();
    if !trace.is_finite() {
        return f64::INFINITY;
    }
    let error = right_or!((row as f64 + 1024.0) * f64::EPSILON * trace, ConeExact, 0.0);
    let forms = Forms { gram, error };
    let [a, b, c, e] = corners;
    let mut cones: Vec<Cone> = Vec::with_capacity(2 * CONES);
    for directions in [[a, b, c], [a, c, e]] {
        cones.push(Cone { rate: forms.rate(&directions), directions });
    }
    for _ in 0..CONES {
        let worst = (0..cones.len()).fold(0, |w, i| if cones[i].rate > cones[w].rate { i } else { w });
        let rate = cones[worst].rate;
        if rate <= wanted {
            break;
        }
        // Halve across the longest edge. Rounding leaves a gap between the halves about an ulp wide, 48 of them at
        // most; over it f^2 changes by less than 3e-14 of the trace, which the error of the forms covers.
        let [a, b, c] = cones[worst].directions;
        let edges = [(a, b, c), (b, c, a), (c, a, b)];
        let longest = edges
            .into_iter()
            .fold(edges[0], |l, e| if e.0.distance_squared(e.1) > l.0.distance_squared(l.1) { e } else { l });
        let (a, b, c) = longest;
        let middle = (a + b).normalize();
        // Where a direction that occurs is itself too fast, only that much can be had.
        wanted = wanted.max(forms.single(middle) * 1.05);
        let halves = [[a, middle, c], [middle, b, c]];
        let rates = halves.map(|h| forms.rate(&h));
        cones[worst] = Cone { rate: rates[0].min(rate), directions: halves[0] };
        cones.push(Cone { rate: rates[1].min(rate), directions: halves[1] });
    }
    cones.iter().map(|c| c.rate).fold(0.0, f64::max)
}

/// Four unit directions whose cone contains all of `d`: a pyramid around their mean, its sides aligned with
/// their widest spread. None where they do not lie well within a half space.
fn pyramid(d: &[DVec3; 9]) -> Option<[DVec3; 4]> {
    let axis = d.iter().map(|d| d.normalize_or_zero()).sum::<DVec3>().try_normalize()?;
    let mut flat = [DVec3::ZERO; 9];
    for (flat, d) in flat.iter_mut().zip(d) {
        let height = d.dot(axis);
        if height.is_nan() || height <= 0.05 * d.length() {
            return None;
        }
        *flat = *d / height - axis;
    }
    let widest =
        flat.iter().fold(DVec3::ZERO, |w, f| if f.length_squared() > w.length_squared() { *f } else { w });
    let along = (widest - axis * widest.dot(axis)).try_normalize().unwrap_or(axis.any_orthonormal_vector());
    let across = axis.cross(along);
    let range = |t: DVec3| {
        let values = flat.map(|f| f.dot(t));
        let (lower, upper) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), v| (l.min(*v), u.max(*v)));
        // The frame is orthonormal, and the points lie in its plane, up to a few roundings (at most 20 long).
        (lower - 1e-12, upper + 1e-12)
    };
    let ((a0, a1), (b0, b1)) = (range(along), range(across));
    let corner = |a: f64, b: f64| (axis + along * a + across * b).normalize();
    Some([corner(a0, b0), corner(a1, b0), corner(a1, b1), corner(a0, b1)])
}

/// Evaluates `|c_ij|` from above.
struct Forms<'a> {
    gram: &'a StrainGram,
    /// Error of `|c_ij|^2` for unit directions.
    error: f64,
}

impl Forms<'_> {
    fn square(&self, a: DVec3, b: DVec3) -> f64 {
        let root = std::f64::consts::FRAC_1_SQRT_2;
        let m = [
            a.x * b.x,
            a.y * b.y,
            a.z * b.z,
            (a.y * b.z + a.z * b.y) * root,
            (a.x * b.z + a.z * b.x) * root,
            (a.x * b.y + a.y * b.x) * root,
        ];
        let mut square = 0.0;
        for (row, m_row) in self.gram.iter().zip(m) {
            let inner: f64 = row.iter().zip(m).map(|(g, m)| g * m).sum();
            square += m_row * inner;
        }
        square.max(0.0)
    }

    /// `f(u)`, not rounded: only to see whether refining can help.
    fn single(&self, u: DVec3) -> f64 {
        self.square(u, u).sqrt()
    }

    /// An upper bound of `f` on the cone of three unit directions.
    fn rate(&self, u: &[DVec3; 3]) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..3 {
            for j in i..3 {
                // Lower bound of u_i.u_j; the directions are unit vectors up to rounding, and only their
                // directions matter: the quotient does not depend on their lengths.
                let cosine = u[i].dot(u[j]) - 16.0 * f64::EPSILON;
                if cosine <= 0.1 {
                    return f64::INFINITY;
                }
                largest = largest.max((self.square(u[i], u[j]) + self.error).sqrt() / cosine);
            }
        }
        largest * (1.0 + 32.0 * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests;
