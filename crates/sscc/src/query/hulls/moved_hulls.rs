//! The hulls of one search, each moved at most once, and the test of two nodes.

use glam::{Mat3, Vec3, Vec4};

use super::hull_motion::HullMotion;
use super::node_hulls::NodeHulls;
use super::separation::{AffineMap, MovedPoints, PlaneTest, widest_gap};
use crate::detect::f32_frame::F32Frame;
use crate::detect::vertex_motion::VertexMotion;
use crate::model::rounding::larger_or_nan;
use crate::vectors::InstructionSet;

/// Pairs whose gap at the centre is at most this many times the sum of both radii are not tested: such gaps seldom stay
/// open.
const MIN_GAP: f32 = 2.0;

/// The hulls of one search. Each entry contains the number of the search for which it is current.
#[derive(Clone)]
pub(crate) struct MovedHulls<const E: usize> {
    motion: HullMotion<E>,
    instructions: InstructionSet,
    /// Whether the motion of this search is set: the first test sets it.
    has_begun: bool,
    /// Whether a test may succeed in this search.
    is_useful: bool,
    search: u32,
    searches: Vec<u32>,
    pub(super) hulls: Vec<MovedHull<E>>,
}

#[derive(Clone)]
pub(super) struct MovedHull<const E: usize> {
    /// Moves the core points.
    maps: [AffineMap; E],
    pub(super) radius: f32,
    /// Maps a direction at rest to one at the first configuration.
    cofactors: Mat3,
}

impl<const E: usize> MovedHulls<E> {
    pub(crate) fn new(hulls: &NodeHulls) -> Self {
        let empty = MovedHull { maps: [[Vec4::ZERO; 3]; E], radius: 0.0, cofactors: Mat3::ZERO };
        Self {
            motion: HullMotion::default(),
            instructions: InstructionSet::default(),
            has_begun: false,
            is_useful: false,
            search: 0,
            searches: vec![0; hulls.count()],
            hulls: vec![empty; hulls.count()],
        }
    }

    /// Starts a new search. Nothing is computed before the first test.
    #[inline]
    pub(crate) fn begin(&mut self) {
        self.search = self.search.wrapping_add(1);
        if self.search == 0 {
            self.searches.fill(0);
            self.search = 1;
        }
        (self.is_useful, self.has_begun) = (true, false);
    }

    /// Sets the motion of this search.
    fn begin_motion<M: VertexMotion<E>>(&mut self, hulls: &NodeHulls, frame: &F32Frame, motion: &M) {
        self.has_begun = true;
        let coordinates = motion.coarse_coordinates();
        self.is_useful = coordinates.is_some_and(|q| self.motion.begin(hulls, q, frame, motion.rounding()));
    }

    /// Whether a test may succeed in this search. Where many triangles collide most tests fail, but those that succeed save
    /// more (docs/notes/traversal.md#growth-with-triangles).
    #[inline]
    pub(crate) fn is_useful(&self) -> bool {
        self.is_useful
    }

    /// Whether the hulls of two nodes prove that no triangle of one has a point in common with one of the other.
    /// `at_rest`: a direction that separates them at the configuration of the hulls.
    pub(crate) fn are_apart<M: VertexMotion<E>>(
        &mut self,
        hulls: &NodeHulls,
        (n, m): (u32, u32),
        at_rest: Vec3,
        frame: &F32Frame,
        motion: &M,
    ) -> bool {
        if !self.has_begun {
            self.begin_motion(hulls, frame, motion);
            if !self.is_useful {
                return false;
            }
        }
        let [Some(i), Some(j)] = [n, m].map(|n| hulls.index_of(n)) else { return false };
        self.update(hulls, i, n, motion);
        self.update(hulls, j, m, motion);
        let [a, b] = [i, j].map(|i| &self.hulls[i]);
        let normal = (a.cofactors + b.cofactors) * at_rest;
        let points = [i, j].map(|i| self.points(hulls, i));
        let distance = with_mutant!(a.radius + b.radius, LargerHullRadius, a.radius.max(b.radius));
        self.instructions.run(PlaneTest { points, distance, normal })
    }

    /// Moves all hulls.
    pub(crate) fn update_all<M: VertexMotion<E>>(&mut self, hulls: &NodeHulls, frame: &F32Frame, motion: &M) {
        self.begin();
        self.begin_motion(hulls, frame, motion);
        for (node, index) in hulls.all() {
            self.update(hulls, index, node, motion);
        }
    }

    /// Returns the core points of a current hull, with the maps that move them.
    #[inline]
    pub(super) fn points<'t>(&'t self, hulls: &'t NodeHulls, index: usize) -> MovedPoints<'t, E> {
        MovedPoints { points: &hulls.shape(index).core, maps: &self.hulls[index].maps }
    }

    /// Moves a hull, unless it is current.
    fn update<M: VertexMotion<E>>(&mut self, hulls: &NodeHulls, index: usize, node: u32, motion: &M) {
        if self.searches[index] == self.search {
            return;
        }
        self.searches[index] = self.search;
        let HullMotion { factors, shift, error, relative, .. } = &self.motion;
        // Rows of F and c, with the products of the residual in the fourth vector.
        let mut rows = [[Vec4::ZERO; 3]; E];
        let (mut sums, mut squares) = ([Vec4::ZERO; E], [0.0_f32; E]);
        for (rate, factors) in hulls.frame(index).iter().zip(factors) {
            for end in 0..E {
                let factor = factors[end];
                let signed = Vec4::splat(factor.y);
                (0..3).for_each(|axis| rows[end][axis] += rate[axis] * signed);
                let products = rate[3] * factor;
                sums[end] += products;
                squares[end] += products.x * products.x;
            }
        }
        let shape = hulls.shape(index);
        let hull = &mut self.hulls[index];
        hull.radius = 0.0;
        for end in 0..E {
            let columns = Mat3::from_cols(
                Vec3::from_array(rows[end].map(|row| row.x)),
                Vec3::from_array(rows[end].map(|row| row.y)),
                Vec3::from_array(rows[end].map(|row| row.z)),
            );
            (0..3).for_each(|axis| hull.maps[end][axis] = rows[end][axis] + Vec4::W * shift[axis]);
            let sum = sums[end].x * (1.0 + relative);
            let along =
                (0..3).map(|j| shape.along[j] * (sums[end][j + 1].abs() + relative * sum)).sum::<f32>();
            let split = (with_mutant!(along, HullVectorsForgotten, 0.0)
                + shape.remainder * squares[end].sqrt())
                * (1.0 + 2.0 * relative);
            let residual = with_mutant!(sum.min(split), HullResidualForgotten, 0.0);
            let stretch = with_mutant!(norm_bound(&columns), HullNotStretched, 1.0);
            let radius = (shape.distance * stretch + residual) * (1.0 + 1e-6);
            let radius = radius_or_infinity(&hull.maps[end], radius);
            hull.radius = with_mutant!(hull.radius.max(radius), HullRadiusAtEnd, radius);
            if end == 0 {
                let [x, y, z] = [columns.x_axis, columns.y_axis, columns.z_axis];
                let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
                let size = cofactors.x_axis.abs().max(cofactors.y_axis.abs()).max(cofactors.z_axis.abs());
                let scale = 1.0 / size.max_element().max(f32::MIN_POSITIVE);
                hull.cofactors = cofactors * scale;
            }
        }
        let slack = motion.coarse_slack(node).map_or(0.0, |slack| self.motion.distance(slack));
        hull.radius += error + with_mutant!(slack, HullCapsuleNotWidened, 0.0);
        hull.radius *= 1.0 + 1e-6;
    }
}

impl MovedHulls<1> {
    /// Returns the normal of the plane with the widest gap between two current hulls, from the first to the second. `None` if
    /// the gap is narrow, or a node has no hull.
    pub(crate) fn separating_direction(&self, hulls: &NodeHulls, (n, m): (u32, u32)) -> Option<Vec3> {
        let [Some(i), Some(j)] = [n, m].map(|n| hulls.index_of(n)) else { return None };
        let [a, b] = [i, j].map(|i| &self.hulls[i]);
        let [x, y] = [i, j].map(|i| self.points(hulls, i));
        let (normal, gap) = widest_gap(&x, &y)?;
        (gap > MIN_GAP * (a.radius + b.radius)).then_some(normal)
    }
}

/// Returns an upper bound of the norm of F: the root of the largest absolute row sum of F'F.
///
/// The error of an entry of F'F is at most 5 u times the largest one of the diagonal, also where its terms cancel. So the relative
/// error of the largest row sum, which is at least as large as that entry, is less than 20 u, and that of its root less than 1e-6.
/// Underflow is part of [`HullMotion::error`].
fn norm_bound(columns: &Mat3) -> f32 {
    let gram = columns.transpose() * *columns;
    let sum = |column: Vec3| {
        with_mutant!(column.abs().element_sum(), HullStretchLargestEntry, column.abs().max_element())
    };
    let [x, y, z] = [gram.x_axis, gram.y_axis, gram.z_axis].map(sum);
    larger_or_nan(larger_or_nan(x, y), z).sqrt() * (1.0 + 1e-5)
}

/// Returns the radius of a hull whose core points this map moves; infinite where a number is not finite.
///
/// The maximum of numbers ignores NaN, and so does the extent of points along a direction. So hulls with NaN would seem
/// separated; one of infinite radius proves nothing.
#[inline]
fn radius_or_infinity(map: &AffineMap, radius: f32) -> f32 {
    let is_finite = radius.is_finite() && map.iter().all(|row| row.is_finite());
    with_mutant!(if is_finite { radius } else { f32::INFINITY }, HullNanIgnored, radius)
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::certificates::Scope;
    use crate::detect::layout::{Layout, Needs};
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::filter::PairFilter;
    use crate::hierarchy::Hierarchy;
    use crate::query::widened_motion::WidenedMotion;
    use crate::test_models::Random;
    use crate::{ContactFilter, Modes, ReducedModel, TriMesh};

    /// No unit vector that F moves becomes longer than the bound. The matrices stretch mostly along a diagonal, where the
    /// entries of F'F are alike.
    #[test]
    fn no_vector_is_stretched_by_more_than_the_bound() {
        let random = &mut Random(17);
        let signs = [[1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, 0.0]];
        for case in 0..500 {
            let along = DVec3::from_array(signs[case % 5]);
            let noise = [0.0, 1e-3, 1.0][case % 3];
            let columns = [along.x, along.y, along.z].map(|x| along * x + random.vector() * noise);
            let size = 10.0_f64.powi(case as i32 % 7 - 3);
            let [x, y, z] = columns.map(|column| (column * size).as_vec3());
            let bound = f64::from(norm_bound(&Mat3::from_cols(x, y, z)));
            let exact = DMat3::from_cols(x.as_dvec3(), y.as_dvec3(), z.as_dvec3());
            let mut longest = 0.0_f64;
            for dir in std::iter::once(along).chain((0..20).map(|_| random.vector())) {
                // Powers of F'F rotate a vector to the direction in which F stretches most.
                let dir = exact.transpose() * (exact * dir.normalize() / size) / size;
                longest = longest.max((exact * dir.normalize_or(DVec3::X)).length());
            }
            assert!(longest <= bound && bound <= 1.7321 * longest * 1.3, "case {case}: {longest} {bound}");
        }
    }

    /// Returns the hulls of two triangles, one above the other, that two modes move as a whole.
    fn hulls_of_two_triangles() -> NodeHulls {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let positions = [0.0, 9.0].map(|z| corners.map(|x| x + DVec3::Z * z)).concat();
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::new(2, [DVec3::Z, DVec3::X].repeat(6)).unwrap();
        let model = ReducedModel::new(mesh, modes).unwrap();
        let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
        NodeHulls::new(&model, &hierarchy, &[(0, 0)], &[0.0; 2]).unwrap()
    }

    /// Where a number is infinite or NaN at either end of a motion, no plane separates the hull from any other one.
    #[test]
    fn hulls_with_infinite_or_nan_factors_prove_nothing() {
        let hulls = hulls_of_two_triangles();
        let motion = DeformedMotion::new([&[0.0; 2][..]; 2], 9.0);
        for wrong in [f32::INFINITY, f32::NAN] {
            for (mode, end) in [(0, 0), (0, 1), (1, 0), (2, 1)] {
                let mut moved = MovedHulls::<2>::new(&hulls);
                let one = Vec4::splat(0.5);
                (moved.motion.factors, moved.motion.error, moved.motion.scale) =
                    (vec![[one; 2]; 3], 1e-6, 1.0);
                moved.motion.factors[mode][end] = Vec4::splat(wrong);
                moved.begin();
                moved.update(&hulls, 0, 0, &motion);
                let radius = moved.hulls[0].radius;
                assert!(radius > 1e30, "{wrong} for mode {mode} at end {end}: {radius}");
            }
        }
    }

    /// Cofactors only turn directions. Their size must not depend on that of the hull: normals that are too short are not tested.
    #[test]
    fn the_largest_cofactor_is_1() {
        let hulls = hulls_of_two_triangles();
        let motion = DeformedMotion::new([&[0.0; 2][..]], 9.0);
        for factor in [1e-3_f32, 0.1, 1.0, 100.0] {
            let mut moved = MovedHulls::<1>::new(&hulls);
            (moved.motion.factors, moved.motion.error, moved.motion.scale) =
                (vec![[Vec4::splat(factor)]; 3], 1e-6, 1.0);
            moved.begin();
            moved.update(&hulls, 0, 0, &motion);
            let cofactors = moved.hulls[0].cofactors.to_cols_array();
            let largest = cofactors.into_iter().fold(0.0_f32, |most, x| most.max(x.abs()));
            assert!((0.999..1.001).contains(&largest), "{factor}: {largest}");
        }
    }

    /// Returns the radius of the first hull without the error of a motion and without slack, by the formulas, in
    /// double precision.
    fn radius_of<const E: usize>(hulls: &NodeHulls, motion: &HullMotion<E>) -> f64 {
        let (shape, relative) = (hulls.shape(0), f64::from(motion.relative));
        let of_end = |end: usize| {
            // The transposed matrix of F.
            let mut transposed = DMat3::ZERO;
            let (mut sum, mut squares, mut along) = (0.0_f64, 0.0_f64, DVec3::ZERO);
            for (rate, factors) in hulls.frame(0).iter().zip(&motion.factors) {
                let factor = f64::from(factors[end].y);
                let [x, y, z, residual] = rate.map(|row| row.as_dvec4() * factor);
                transposed += DMat3::from_cols(x.truncate(), y.truncate(), z.truncate());
                sum += residual.x.abs();
                squares += residual.x * residual.x;
                along += DVec3::new(residual.y, residual.z, residual.w);
            }
            let most = sum * (1.0 + relative);
            let of_vector = |j: usize| f64::from(shape.along[j]) * (along[j].abs() + relative * most);
            let split = (0..3).map(of_vector).sum::<f64>() + f64::from(shape.remainder) * squares.sqrt();
            let residual = most.min(split * (1.0 + 2.0 * relative));
            let gram = transposed * transposed.transpose();
            let sums = [gram.x_axis, gram.y_axis, gram.z_axis].map(|column| column.abs().element_sum());
            f64::from(shape.distance) * sums.into_iter().fold(0.0, f64::max).sqrt() + residual
        };
        (0..E).map(of_end).fold(0.0, f64::max)
    }

    /// Sets random factors up to a size, and large numbers in place of the small ones that cover rounding.
    fn set<const E: usize>(motion: &mut HullMotion<E>, rank: usize, size: f64, random: &mut Random) {
        let factor = |x: f32| Vec4::new(x.abs(), x, x, x);
        motion.factors = vec![[factor(1.0); E]];
        for _ in 0..rank {
            motion.factors.push(std::array::from_fn(|_| factor((size * random.signed()) as f32)));
        }
        (motion.error, motion.relative, motion.scale) = (0.25, 0.05, 2.0);
    }

    /// Each term of a radius has its part in it, at one configuration with slack and at the ends of a motion.
    #[test]
    fn radii_are_those_of_the_formulas() {
        let random = &mut Random(23);
        for case in 0..12 {
            let rank = [1, 4, 12][case % 3];
            let positions: Vec<DVec3> = (0..60).map(|_| random.vector()).collect();
            // Residuals are multiples of one vector over the modes, and noise.
            let rates: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            let mut rows = Vec::new();
            for _ in 0..60 {
                let along = random.vector();
                rows.extend(rates.iter().map(|rate| along * *rate + random.vector() * 0.1));
            }
            let faces = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let modes = Modes::new(rank, rows).unwrap();
            let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap();
            let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
            let q = vec![0.0; rank];
            let hulls = NodeHulls::new(&model, &hierarchy, &[(0, 0)], &q).unwrap();
            let filter = PairFilter::new(&model, &ContactFilter::default());
            let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
            let widened = WidenedMotion::new(DeformedMotion::new([&q[..]], 9.0), &layout, 0.1);
            let slack = 2.0 * widened.coarse_slack(0).unwrap().length();
            assert!(slack > 0.1, "{slack}");
            for size in [0.5, 0.5, 3.0, 3.0] {
                let mut moved = MovedHulls::<1>::new(&hulls);
                set(&mut moved.motion, rank, size, random);
                moved.begin();
                moved.update(&hulls, 0, 0, &widened);
                let exact = radius_of(&hulls, &moved.motion) + 0.25 + slack;
                let share = f64::from(moved.hulls[0].radius) / exact;
                assert!((1.0 - 1e-5..1.0 + 1e-4).contains(&share), "case {case}, {size}: {share}");

                let mut moved = MovedHulls::<2>::new(&hulls);
                set(&mut moved.motion, rank, size, random);
                moved.begin();
                moved.update(&hulls, 0, 0, &DeformedMotion::new([&q[..]; 2], 9.0));
                let exact = radius_of(&hulls, &moved.motion) + 0.25;
                let share = f64::from(moved.hulls[0].radius) / exact;
                assert!((1.0 - 1e-5..1.0 + 1e-4).contains(&share), "case {case}, {size}, ends: {share}");
            }
        }
    }

    /// Both factors that cover the rounding of a radius increase it: here all else is a residual of 1, up to its last
    /// bit.
    #[test]
    fn radii_cover_their_own_rounding() {
        // The corners of a square move up and down alternately. No affine map describes that.
        let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let mesh = TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let modes = Modes::new(1, [DVec3::Z, DVec3::NEG_Z].repeat(2)).unwrap();
        let model = ReducedModel::new(mesh, modes).unwrap();
        let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
        let hulls = NodeHulls::new(&model, &hierarchy, &[(0, 0)], &[0.0]).unwrap();
        let mut moved = MovedHulls::<1>::new(&hulls);
        moved.motion.factors = vec![[Vec4::ZERO], [Vec4::ONE]];
        (moved.motion.error, moved.motion.relative, moved.motion.scale) = (0.0, 0.0, 1.0);
        moved.begin();
        moved.update(&hulls, 0, 0, &DeformedMotion::new([&[0.0][..]], 9.0));
        let radius = f64::from(moved.hulls[0].radius);
        assert!((1.0 + 1.5e-6..1.0 + 2.5e-6).contains(&radius), "{radius}");
    }

    /// A number that is not finite makes a radius infinite, whether it is the radius or only in the map.
    #[test]
    fn radii_of_numbers_that_are_not_finite_are_infinite() {
        let map = [Vec4::X, Vec4::Y, Vec4::Z];
        assert_eq!(radius_or_infinity(&map, 2.0), 2.0);
        for wrong in [f32::NAN, f32::INFINITY] {
            assert_eq!(radius_or_infinity(&map, wrong), f32::INFINITY);
            for axis in 0..3 {
                let mut map = map;
                map[axis].w = wrong;
                assert_eq!(radius_or_infinity(&map, 2.0), f32::INFINITY);
            }
        }
    }

    /// After the last number of a search the count begins anew, and no hull of an earlier search is current.
    #[test]
    fn no_hull_is_current_when_the_count_of_searches_begins_anew() {
        let mut moved = MovedHulls::<1> {
            motion: HullMotion::default(),
            instructions: InstructionSet::default(),
            has_begun: true,
            is_useful: false,
            search: u32::MAX,
            searches: vec![0, 1, u32::MAX],
            hulls: Vec::new(),
        };
        moved.begin();
        assert!(moved.searches.iter().all(|search| *search != moved.search), "{:?}", moved.searches);
        assert!(moved.is_useful() && !moved.has_begun);
    }
}
