//! A separating-axis test in single precision, which rejects most triangle pairs whose boxes overlap: eight pairs side by side.

use glam::Vec4;

use crate::vectors::{InstructionSet, Kernel, LANES, Vectors};

/// Up to eight pairs of triangles, by their corners in the frame. Coordinates are within [-2, 2], up to their error.
#[derive(Clone, Copy)]
pub(crate) struct TrianglePairs<'p, const E: usize> {
    /// The positions of the vertices of the first and of the second triangles, at each configuration; their fourth components
    /// are unused.
    pub(crate) positions: [&'p [[Vec4; E]]; 2],
    /// The places of the corners of the first and of the second triangles in these. Those of unused lanes are read, too.
    pub(crate) corners: &'p [[[u32; 3]; LANES]; 2],
    /// The number of pairs.
    pub(crate) count: usize,
    /// An upper bound of the error of coordinates along each axis.
    pub(crate) error: f32,
}

impl<const E: usize> TrianglePairs<'_, E> {
    /// Returns which pairs certainly have no point in common, at the start, at the end, and on the straight lines between: one
    /// direction separates them at both ends. Bit i is for pair i.
    #[inline]
    pub(crate) fn separated(self, instructions: InstructionSet) -> u32 {
        // This check only saves time: an error that is infinite or NaN makes the slack infinite or NaN, too, and no gap is larger.
        if with_mutant!(!self.error.is_finite(), InfiniteErrorTested, false) {
            return 0;
        }
        instructions.run(self)
    }

    /// Returns one corner of all triangles of one side, in one configuration.
    #[inline(always)]
    fn corner<V: Vectors>(&self, v: V, side: usize, corner: usize, end: usize) -> Vec3s<V> {
        let (positions, places) = (self.positions[side], &self.corners[side]);
        v.coordinates([
            positions[places[0][corner] as usize][end],
            positions[places[1][corner] as usize][end],
            positions[places[2][corner] as usize][end],
            positions[places[3][corner] as usize][end],
            positions[places[4][corner] as usize][end],
            positions[places[5][corner] as usize][end],
            positions[places[6][corner] as usize][end],
            positions[places[7][corner] as usize][end],
        ])
    }
}

impl<const E: usize> Kernel for TrianglePairs<'_, E> {
    type Output = u32;

    #[inline(always)]
    fn run<V: Vectors>(self, v: V) -> u32 {
        let lanes = (1 << self.count) - 1;
        let pairs = RelativePairs::new(v, &self);
        let ([e0, e1, e2], [f0, f1, f2]) = (pairs.a[0].edges(v), pairs.b[0].edges(v));
        let (m, n) = (cross(v, e0, e1), cross(v, f0, f1));
        let between = subtract(v, pairs.b[0].sum(v), pairs.a[0].sum(v));
        // The directions that separate most often come first.
        let mut separated = pairs.separate(v, [between, m, n, cross(v, m, n)]);
        if separated & lanes != lanes {
            separated |=
                pairs.separate(v, [cross(v, e0, m), cross(v, e1, m), cross(v, e2, m), cross(v, f0, n)]);
        }
        if separated & lanes != lanes {
            separated |=
                pairs.separate(v, [cross(v, f1, n), cross(v, f2, n), cross(v, e0, f0), cross(v, e1, f1)]);
        }
        separated & lanes
    }
}

/// Eight vectors, by coordinate.
type Vec3s<V> = [<V as Vectors>::F32s; 3];

/// The corners of eight triangles.
#[derive(Clone, Copy)]
struct Corners<V: Vectors>([Vec3s<V>; 3]);

impl<V: Vectors> Corners<V> {
    #[inline(always)]
    fn edges(&self, v: V) -> [Vec3s<V>; 3] {
        let [a, b, c] = self.0;
        [subtract(v, b, a), subtract(v, c, b), subtract(v, a, c)]
    }

    #[inline(always)]
    fn sum(&self, v: V) -> Vec3s<V> {
        let [a, b, c] = self.0;
        [v.add(v.add(a[0], b[0]), c[0]), v.add(v.add(a[1], b[1]), c[1]), v.add(v.add(a[2], b[2]), c[2])]
    }

    /// Returns the smallest and the largest coordinate of the corners along a direction.
    #[inline(always)]
    fn interval(&self, v: V, dir: Vec3s<V>) -> [V::F32s; 2] {
        let [a, b, c] = self.0;
        let (a, b, c) = (dot(v, dir, a), dot(v, dir, b), dot(v, dir, c));
        [v.min(v.min(a, b), c), v.max(v.max(a, b), c)]
    }
}

/// Eight pairs of triangles at each configuration, relative to the first corner of the first triangle.
struct RelativePairs<V: Vectors, const E: usize> {
    a: [Corners<V>; E],
    b: [Corners<V>; E],
    error: f32,
}

impl<V: Vectors, const E: usize> RelativePairs<V, E> {
    #[inline(always)]
    fn new(v: V, pairs: &TrianglePairs<'_, E>) -> Self {
        let zero = [v.splat(0.0); 3];
        let (mut a, mut b) = ([Corners([zero; 3]); E], [Corners([zero; 3]); E]);
        // These are loops and functions, because maps of arrays and closures are not inlined.
        for end in 0..E {
            let origin = pairs.corner(v, 0, 0, end);
            // The first corner of the first triangle remains 0.
            a[end].0[1] = subtract(v, pairs.corner(v, 0, 1, end), origin);
            a[end].0[2] = subtract(v, pairs.corner(v, 0, 2, end), origin);
            b[end].0[0] = subtract(v, pairs.corner(v, 1, 0, end), origin);
            b[end].0[1] = subtract(v, pairs.corner(v, 1, 1, end), origin);
            b[end].0[2] = subtract(v, pairs.corner(v, 1, 2, end), origin);
        }
        Self { a, b, error: pairs.error }
    }

    /// Returns the pairs that one of four directions separates in every configuration, by more than the error of
    /// positions and sums. In units of the direction's 1-norm, positions contribute an error of 2 `error`, and differences,
    /// products and sums one of about 20 units of 2^-24 in [-1, 1], where `error` is at least 14 units. Coordinates beyond 1
    /// occur only where given positions are mapped: then the total error is at most 40 units, and the slack is at least 56.
    #[inline(always)]
    fn separate(&self, v: V, directions: [Vec3s<V>; 4]) -> u32 {
        let errors = v.splat(with_mutant!(4.0, SeparatingAxisErrorHalved, 2.0) * self.error);
        let mut separated = 0;
        for dir in directions {
            let [x, y, z] = dir;
            // Underflow is far less than the last term.
            let norm = v.add(v.add(v.abs(x), v.abs(y)), v.abs(z));
            let slack = v.multiply_add(norm, errors, v.splat(f32::MIN_POSITIVE));
            let (mut below, mut above) = (u32::MAX, u32::MAX);
            for end in with_mutant!(0, SeparatedAtEnd, E - 1)..E {
                let (a, b) = (self.a[end].interval(v, dir), self.b[end].interval(v, dir));
                let is_below = v.bits(v.greater(v.subtract(b[0], a[1]), slack));
                let is_above = v.bits(v.greater(v.subtract(a[0], b[1]), slack));
                below &= with_mutant!(is_below, SidesOfEndsDiffer, is_below | is_above);
                above &= is_above;
            }
            separated |= below | above;
        }
        separated
    }
}

#[inline(always)]
fn subtract<V: Vectors>(v: V, a: Vec3s<V>, b: Vec3s<V>) -> Vec3s<V> {
    [v.subtract(a[0], b[0]), v.subtract(a[1], b[1]), v.subtract(a[2], b[2])]
}

#[inline(always)]
fn cross<V: Vectors>(v: V, a: Vec3s<V>, b: Vec3s<V>) -> Vec3s<V> {
    [
        v.subtract(v.multiply(a[1], b[2]), v.multiply(a[2], b[1])),
        v.subtract(v.multiply(a[2], b[0]), v.multiply(a[0], b[2])),
        v.subtract(v.multiply(a[0], b[1]), v.multiply(a[1], b[0])),
    ]
}

#[inline(always)]
fn dot<V: Vectors>(v: V, a: Vec3s<V>, b: Vec3s<V>) -> V::F32s {
    v.multiply_add(a[2], b[2], v.multiply_add(a[1], b[1], v.multiply(a[0], b[0])))
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3A};

    use super::*;
    use crate::test_models::Random;
    use crate::{MovingTriangle, impact_triangle_triangle, intersect_triangle_triangle};

    /// Corners of two triangles in the frame.
    type Pair<const E: usize> = [[[Vec4; E]; 3]; 2];

    /// Returns which of at most eight pairs are separated. Both instruction sets agree, and unused lanes have no effect.
    fn separated<const E: usize>(pairs: &[Pair<E>], error: f32) -> Vec<bool> {
        let mut positions = [(); 2].map(|()| vec![[Vec4::splat(0.25); E]]);
        let mut corners = [[[0; 3]; LANES]; 2];
        for (lane, pair) in pairs.iter().enumerate() {
            for (side, triangle) in pair.iter().enumerate() {
                let first = positions[side].len() as u32;
                corners[side][lane] = [first, first + 1, first + 2];
                positions[side].extend(triangle);
            }
        }
        let positions = [&positions[0][..], &positions[1][..]];
        let pairs = TrianglePairs { positions, corners: &corners, count: pairs.len(), error };
        let [one, other] =
            [InstructionSet::default(), InstructionSet::Baseline].map(|set| pairs.separated(set));
        assert_eq!(one, other);
        assert_eq!(one >> pairs.count, 0);
        (0..pairs.count).map(|lane| one >> lane & 1 != 0).collect()
    }

    /// Returns whether one pair is separated, in the last of several lanes.
    fn are_separated<const E: usize>(x: &[[Vec4; E]; 3], y: &[[Vec4; E]; 3], error: f32) -> bool {
        let swapped = [*y, *x];
        let found = separated(&[swapped, [*x, *x], [*x, *y]], error);
        assert!(!found[1]);
        found[2]
    }

    /// Eight pairs side by side give the answers of the test of one pair, for each number of pairs.
    #[test]
    fn eight_pairs_have_the_answers_of_single_pairs() {
        let random = &mut Random(17);
        let mut counts = [0; 2];
        for case in 0..20_000 {
            let size = [0.5_f64, 0.1, 0.02][case % 3];
            let error = [1e-6_f32, 1e-4, 1e-2, f32::INFINITY, f32::NAN][case / 3 % 5];
            let pairs: Vec<Pair<2>> = (0..=case % LANES)
                .map(|_| {
                    let place = random.vector() * 0.4;
                    [(); 2].map(|()| {
                        let middle = place + random.vector() * 0.6 * size;
                        [(); 3].map(|()| {
                            [(); 2]
                                .map(|()| (middle + random.vector() * 0.3 * size).as_vec3().extend(f32::NAN))
                        })
                    })
                })
                .collect();
            let at_start: Vec<Pair<1>> = pairs.iter().map(|p| p.map(|t| t.map(|c| [c[0]]))).collect();
            let swept: Vec<bool> = pairs.iter().map(|[x, y]| oracle(x, y, error)).collect();
            assert_eq!(separated(&pairs, error), swept, "case {case}");
            let expected: Vec<bool> = at_start.iter().map(|[x, y]| oracle(x, y, error)).collect();
            assert_eq!(separated(&at_start, error), expected, "case {case}");
            swept.iter().for_each(|found| counts[usize::from(*found)] += 1);
        }
        assert!(counts[0] > 20_000 && counts[1] > 10_000, "{counts:?}");
    }

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

    /// The oracle: tests one pair, four directions side by side.
    fn oracle<const E: usize>(x: &[[Vec4; E]; 3], y: &[[Vec4; E]; 3], error: f32) -> bool {
        if !error.is_finite() {
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

    /// Returns the corners relative to an origin.
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
        fn new([p, q, r, s]: [Vec3A; 4]) -> Self {
            Self {
                axes: [
                    Vec4::new(p.x, q.x, r.x, s.x),
                    Vec4::new(p.y, q.y, r.y, s.y),
                    Vec4::new(p.z, q.z, r.z, s.z),
                ],
            }
        }

        /// Whether one of the directions separates the triangles in every configuration.
        fn separate<const E: usize>(&self, a: &[[Vec3A; E]; 3], b: &[[Vec3A; E]; 3], error: f32) -> bool {
            let [x, y, z] = self.axes;
            // Underflow is far less than the last term.
            let errors = 4.0 * error;
            let slack = (x.abs() + y.abs() + z.abs()) * errors + f32::MIN_POSITIVE;
            let along = |p: Vec3A| x * p.x + y * p.y + z * p.z;
            let mut separated = [u32::MAX; 2];
            for end in 0..E {
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
}
