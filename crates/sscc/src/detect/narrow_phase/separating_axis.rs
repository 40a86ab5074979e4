//! A separating-axis test in single precision, which rejects most triangle pairs whose boxes overlap.

use glam::{Vec3A, Vec4};

/// Whether two triangles certainly have no point in common at either end, nor on the straight lines between: one direction
/// separates them at both ends. Coordinates are within [-2, 2], up to `error`, the bound of their error along each axis.
#[inline]
pub(crate) fn are_separated<const E: usize>(x: &[[Vec4; E]; 3], y: &[[Vec4; E]; 3], error: f32) -> bool {
    // This check only saves time: an error that is infinite or NaN makes the slack infinite or NaN, too, and no gap is
    // larger.
    if with_mutant!(!error.is_finite(), InfiniteErrorTested, false) {
        return false;
    }
    let origin: [Vec4; E] = std::array::from_fn(|end| x[0][end]);
    let (a, b) = (relative_to(x, &origin), relative_to(y, &origin));
    let edges = |t: &[[Vec3A; E]; 3]| [t[1][0] - t[0][0], t[2][0] - t[1][0], t[0][0] - t[2][0]];
    let (e, f) = (edges(&a), edges(&b));
    let (m, n) = (e[0].cross(e[1]), f[0].cross(f[1]));
    let between = (b[0][0] + b[1][0] + b[2][0]) - (a[0][0] + a[1][0] + a[2][0]);
    // The directions that separate most often come first.
    Directions::new([between, m, n, m.cross(n)]).separate(&a, &b, error)
        || Directions::new([e[0].cross(m), e[1].cross(m), e[2].cross(m), f[0].cross(n)])
            .separate(&a, &b, error)
        || Directions::new([f[1].cross(n), f[2].cross(n), e[0].cross(f[0]), e[1].cross(f[1])])
            .separate(&a, &b, error)
}

/// Returns the corners relative to an origin. It is a loop, because nested maps of arrays are not inlined.
#[inline(always)]
fn relative_to<const E: usize>(corners: &[[Vec4; E]; 3], origin: &[Vec4; E]) -> [[Vec3A; E]; 3] {
    let mut relative = [[Vec3A::ZERO; E]; 3];
    for (corner, at) in corners.iter().zip(&mut relative) {
        for end in 0..E {
            at[end] = Vec3A::from_vec4(corner[end] - origin[end]);
        }
    }
    relative
}

/// Four directions side by side.
struct Directions {
    axes: [Vec4; 3],
}

impl Directions {
    #[inline]
    fn new([p, q, r, s]: [Vec3A; 4]) -> Self {
        Self {
            axes: [
                Vec4::new(p.x, q.x, r.x, s.x),
                Vec4::new(p.y, q.y, r.y, s.y),
                Vec4::new(p.z, q.z, r.z, s.z),
            ],
        }
    }

    /// Whether one of the directions separates the triangles in every configuration, by more than the error of
    /// positions and sums. In units of the direction's 1-norm, positions contribute an error of 2 `error`, and differences,
    /// products and sums one of about 20 units of 2^-24 in [-1, 1], where `error` is at least 14 units. Coordinates beyond 1
    /// occur only where given positions are mapped: then the total error is at most 40 units, and the slack is at least 56.
    #[inline]
    fn separate<const E: usize>(&self, a: &[[Vec3A; E]; 3], b: &[[Vec3A; E]; 3], error: f32) -> bool {
        let [x, y, z] = self.axes;
        // Underflow is far less than the last term.
        let errors = with_mutant!(4.0, SeparatingAxisErrorHalved, 2.0) * error;
        let slack = (x.abs() + y.abs() + z.abs()) * errors + f32::MIN_POSITIVE;
        let along = |p: Vec3A| x * p.x + y * p.y + z * p.z;
        let mut separated = [u32::MAX; 2];
        for end in with_mutant!(0, SeparatedAtEnd, E - 1)..E {
            let a = [along(a[0][end]), along(a[1][end]), along(a[2][end])];
            let b = [along(b[0][end]), along(b[1][end]), along(b[2][end])];
            let lower = |t: &[Vec4; 3]| t[0].min(t[1]).min(t[2]);
            let upper = |t: &[Vec4; 3]| t[0].max(t[1]).max(t[2]);
            separated[0] &= (lower(&a) - upper(&b)).cmpgt(slack).bitmask();
            separated[1] &= (lower(&b) - upper(&a)).cmpgt(slack).bitmask();
        }
        separated[0] | separated[1] != 0
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::test_models::Random;
    use crate::{MovingTriangle, impact_triangle_triangle, intersect_triangle_triangle};

    /// If positions have errors of nearly the bound, triangles are separated only if the exact ones are. The exact triangles touch,
    /// or have a distance or an overlap of a few error bounds or more.
    #[test]
    fn only_separated_triangles_are_reported() {
        let random = &mut Random(5);
        let (mut apart, mut missed, mut met) = (0, 0, 0);
        for case in 0..200_000 {
            let size = 10.0_f64.powi(-(case % 7));
            let place = random.vector() * (0.9 - 0.5 * size);
            let margin = [1e-6, 1e-5, 1e-3][case as usize % 3];
            let mut a = [(); 3].map(|()| place + random.vector() * size * 0.3);
            let mut b = [(); 3].map(|()| place + random.vector() * size * 0.3);
            match case % 5 {
                // A common corner, or an edge and a corner on it.
                0 => b[0] = a[1],
                1 => b[0] = a[0] * 0.25 + a[1] * 0.75,
                // Triangles in one plane, side by side.
                2 => b = [a[1], a[2], a[1] + a[2] - a[0]],
                // Needles and points.
                3 => a[2] = a[0] + (a[1] - a[0]) * random.signed(),
                _ => {}
            }
            let gap = random.vector() * margin * [0.0, 3.0, 10.0, 1e3][case as usize / 3 % 4];
            b = b.map(|x| x + gap);
            let mut wrong = |t: [DVec3; 3]| {
                t.map(|x| {
                    let off = random.vector() * (margin - 1e-7);
                    [(x + off).as_vec3().extend(f32::NAN)]
                })
            };
            let said = are_separated(&wrong(a), &wrong(b), margin as f32);
            let meet = intersect_triangle_triangle(&a, &b);
            assert!(!(said && meet), "case {case}: {a:?} {b:?}");
            apart += usize::from(said);
            missed += usize::from(!said && !meet && margin < 1e-4 * size);
            met += usize::from(meet);
        }
        assert!(apart > 20_000 && missed < apart / 8 && met > 20_000, "{apart} {missed} {met}");
    }

    /// The triangles have a common corner. Each is moved away from the other by the whole error bound, along the normal
    /// that makes the error largest; sums are rounded as well.
    #[test]
    fn touching_triangles_with_errors_of_the_whole_bound_are_not_separated() {
        let random = &mut Random(9);
        // The positions, the margins and the moved positions are exact in single precision.
        let grid = |x: DVec3| (x * 2.0_f64.powi(20)).round() / 2.0_f64.powi(20);
        let mut used = 0;
        for case in 0..20_000 {
            let margin = 2.0_f64.powi([-20, -19, -16][case % 3]);
            let a = [(); 3].map(|()| grid(random.vector() * 0.4));
            let normal = (a[1] - a[0]).cross(a[2] - a[0]);
            let [b, c] = [(); 2].map(|()| grid(random.vector() * 0.4));
            if normal.dot(b - a[0]) <= 0.0 || normal.dot(c - a[0]) <= 0.0 {
                continue;
            }
            let b = [a[case / 3 % 3], b, c];
            assert!(intersect_triangle_triangle(&a, &b));
            let away = normal.signum() * margin;
            let moved = |t: [DVec3; 3], by: DVec3| t.map(|x| [(x + by).as_vec3().extend(f32::NAN)]);
            assert!(
                !are_separated(&moved(a, -away), &moved(b, away), margin as f32),
                "case {case}: {a:?} {b:?}"
            );
            used += 1;
        }
        assert!(used > 4000, "{used}");
    }

    /// Moving triangles are separated only if they do not collide during the motion.
    #[test]
    fn only_triangles_that_stay_separated_are_reported() {
        let random = &mut Random(6);
        let (mut apart, mut met) = (0, 0);
        for case in 0..20_000 {
            let size = [0.5, 0.1, 0.02][case % 3];
            let place = random.vector() * 0.4;
            let mut triangle = || {
                let [a, b] = [(); 2].map(|()| place + random.vector() * 0.3 * size);
                [a, b].map(|middle| [(); 3].map(|()| middle + random.vector() * 0.2 * size))
            };
            let [a, b] = [triangle(), triangle()];
            let mapped = |ends: &[[DVec3; 3]; 2]| {
                [0, 1, 2].map(|corner| [0, 1].map(|end| ends[end][corner].as_vec3().extend(f32::NAN)))
            };
            let said = are_separated(&mapped(&a), &mapped(&b), 1e-6);
            let [x, y] = [a, b].map(|[t0, t1]| MovingTriangle { t0, t1 });
            let meet = impact_triangle_triangle(&x, &y, 1e-12).is_some();
            assert!(!(said && meet), "case {case}: {a:?} {b:?}");
            apart += usize::from(said);
            met += usize::from(meet);
        }
        assert!(apart > 3000 && met > 3000, "{apart} {met}");
    }
}
