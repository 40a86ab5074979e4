//! An upper bound of the rate at which an affine map closes the gap of two triangles, over a cone that contains all
//! directions from one to the other.
//!
//! `f(u) = |G(u)'u|` over unit directions u is the norm of a quadratic form. On the cone spanned by three
//! directions, `u = sum m_i u_i` with `m >= 0`, let `c_ij = u_i' sym(G) u_j` (one number for each mode). Then
//!
//! ```text
//! f(u) |u|^2 = |sum_ij m_i m_j c_ij|,   |u|^2 = sum_ij m_i m_j u_i.u_j,   so   f(u) <= max over i <= j of |c_ij| / u_i.u_j
//! ```
//!
//! where all `u_i.u_j > 0`. The error is quadratic in the width of the cone, so few bisections suffice. One cone costs
//! six quadratic forms of a 6 x 6 matrix, independent of the number of modes.

use glam::DVec3;

use super::strain::StrainGram;

/// Maximum number of bisections for one triangle pair (docs/notes/bounds.md#affine-bounds-and-directions).
const MAX_CONES: usize = 48;

/// The distance by which a pyramid is wider than its directions on each side, at height 1. It covers rounding of the pyramid.
pub(super) const PYRAMID_MARGIN: f64 = 1e-12;

struct Cone {
    rate: f64,
    directions: [DVec3; 3],
}

/// Returns an upper bound of `f(u)` over all directions of the hull of `d`, refined until it is at most `wanted`, no
/// refinement helps, or [`MAX_CONES`] is reached; infinite if the directions do not fit into a narrow cone or the trace
/// is not finite.
pub(super) fn bound_rate_in_cone(
    d: &[DVec3; 9],
    gram: &StrainGram,
    row_len: usize,
    mut wanted: f64,
    margin: f64,
) -> f64 {
    let Some(corners) = enclose_in_pyramid(d, margin) else { return f64::INFINITY };
    let trace: f64 = (0..6).map(|i| gram[i][i]).sum();
    if !trace.is_finite() {
        return f64::INFINITY;
    }
    let rounding = with_mutant!((row_len as f64 + 1024.0) * f64::EPSILON * trace, ConeExact, 0.0);
    let forms = Forms { gram, rounding };
    let [u0, u1, u2, u3] = corners;
    let mut cones: Vec<Cone> = Vec::with_capacity(2 * MAX_CONES);
    for directions in [[u0, u1, u2], [u0, u2, u3]] {
        cones.push(Cone { rate: forms.bound(&directions), directions });
    }
    for _ in 0..MAX_CONES {
        let worst = (0..cones.len()).fold(0, |w, i| if cones[i].rate > cones[w].rate { i } else { w });
        let rate = cones[worst].rate;
        if rate <= wanted {
            break;
        }
        // Halve across the longest edge. By rounding there is a gap about an ulp wide between the halves, at most 48 in all; over
        // it f^2 changes by less than 3e-14 of the trace, which the rounding bound of the forms covers.
        let [u0, u1, u2] = cones[worst].directions;
        let edges = [(u0, u1, u2), (u1, u2, u0), (u2, u0, u1)];
        let (u0, u1, u2) = edges
            .into_iter()
            .fold(edges[0], |l, e| if e.0.distance_squared(e.1) > l.0.distance_squared(l.1) { e } else { l });
        let middle = (u0 + u1).normalize();
        // Halving cannot reach a rate below that at a direction of the cone.
        wanted = wanted.max(forms.evaluate(middle) * 1.05);
        let halves = [[u0, middle, u2], [middle, u1, u2]];
        let rates = halves.map(|half| forms.bound(&half));
        cones[worst] = Cone { rate: rates[0].min(rate), directions: halves[0] };
        cones.push(Cone { rate: rates[1].min(rate), directions: halves[1] });
    }
    cones.iter().map(|cone| cone.rate).fold(0.0, f64::max)
}

/// Returns four unit directions whose cone contains all of `d`: a pyramid around their mean, its sides aligned with
/// their widest extent. None if they do not lie well within a half-space.
pub(super) fn enclose_in_pyramid(d: &[DVec3; 9], margin: f64) -> Option<[DVec3; 4]> {
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
        // Up to a few roundings the frame is orthonormal, and the points, of length at most 20, lie in its plane.
        (lower - margin, upper + margin)
    };
    let ((s0, s1), (t0, t1)) = (range(along), range(across));
    let corner = |s: f64, t: f64| (axis + along * s + across * t).normalize();
    Some([corner(s0, t0), corner(s1, t0), corner(s1, t1), corner(s0, t1)])
}

/// Evaluates `|c_ij|` for directions.
struct Forms<'a> {
    gram: &'a StrainGram,
    /// The rounding bound of `|c_ij|^2` for unit directions.
    rounding: f64,
}

impl Forms<'_> {
    fn square(&self, u: DVec3, v: DVec3) -> f64 {
        let root = std::f64::consts::FRAC_1_SQRT_2;
        let m = [
            u.x * v.x,
            u.y * v.y,
            u.z * v.z,
            (u.y * v.z + u.z * v.y) * root,
            (u.x * v.z + u.z * v.x) * root,
            (u.x * v.y + u.y * v.x) * root,
        ];
        let mut square = 0.0;
        for (row, m_row) in self.gram.iter().zip(m) {
            let inner: f64 = row.iter().zip(m).map(|(g, m)| g * m).sum();
            square += m_row * inner;
        }
        square.max(0.0)
    }

    /// Returns `f(u)`, rounded to nearest. It only decides whether refinement can help.
    fn evaluate(&self, u: DVec3) -> f64 {
        self.square(u, u).sqrt()
    }

    /// Returns an upper bound of `f` on the cone of three unit directions.
    fn bound(&self, u: &[DVec3; 3]) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..3 {
            for j in i..3 {
                // Lower bound of u_i.u_j; the directions are unit vectors up to rounding, and only their
                // directions matter: the quotient does not depend on their lengths.
                let cosine = u[i].dot(u[j]) - 16.0 * f64::EPSILON;
                if cosine <= 0.1 {
                    return f64::INFINITY;
                }
                largest = largest.max((self.square(u[i], u[j]) + self.rounding).sqrt() / cosine);
            }
        }
        largest * (1.0 + 32.0 * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests;
