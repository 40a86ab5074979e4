//! A shape in the world, tested against others. The AABBs of BD-trees are computed in the axes of each model, then rotated and
//! translated.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::pose::{Pose, finite_or_empty};
use super::posed_motion::PosedMotion;
use crate::arithmetic::check_arithmetic;
use crate::detect::context::Context;
use crate::detect::layout::Needs;
use crate::detect::narrow_phase::DiscreteHits;
use crate::detect::node_volumes::NodeVolumes;
use crate::detect::search::{Search, SearchState, Side};
use crate::detect::vertex_motion::rounding_bound;
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::{Certificates, ContactFilter, Detector, Error, Pair, ReducedModel};

/// A shape at some q and pose in the world, to be tested against others. Colliding pairs are exact for the f64
/// positions [`Pose::apply`] of [`deformed_position`](crate::deformed_position). It owns its memory, so that repeated
/// calls allocate nothing; clones share the data that does not change.
#[derive(Clone)]
pub struct PosedShape {
    pub(super) model: ReducedModel,
    pub(super) context: Context,
    pub(super) volumes: NodeVolumes<1>,
    pub(super) motion: PosedMotion<1>,
    /// An AABB of the shape.
    pub(super) whole: Aabb,
    /// Whether the volumes are those of this motion.
    is_current: bool,
    state: SearchState,
    /// Nodes still to be visited by searches of half-spaces.
    pub(super) below: Vec<u32>,
    hits: DiscreteHits,
}

/// Shows the AABB of the shape only.
impl fmt::Debug for PosedShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PosedShape").field("whole", &self.whole).finish_non_exhaustive()
    }
}

impl PosedShape {
    /// Creates a shape at q = 0 in its own axes. It uses only the hierarchy of the certificates.
    ///
    /// # Errors
    /// When the certificates were computed for another model; as [`PosedShape::without_certificates`].
    pub fn new(model: &ReducedModel, certificates: &Certificates) -> Result<Self, Error> {
        certificates.check_model(model)?;
        Self::with_hierarchy(model, Arc::clone(&certificates.parts().hierarchy))
    }

    /// Creates a shape without certificates, which builds its own hierarchy. Its answers are the same.
    ///
    /// # Errors
    /// When the model is beyond the range of numbers, or this thread's arithmetic is not that of IEEE 754
    /// ([`Error::Arithmetic`]).
    pub fn without_certificates(model: &ReducedModel) -> Result<Self, Error> {
        Self::with_hierarchy(model, Arc::new(Hierarchy::build(model, model.metric())))
    }

    fn with_hierarchy(model: &ReducedModel, hierarchy: Arc<Hierarchy>) -> Result<Self, Error> {
        // No contact filter applies between shapes.
        let context = Context::new(model, hierarchy, &ContactFilter::default(), &[], Some(Needs::LAZY));
        let volumes = NodeVolumes::new(&context.layout, true);
        let mut motion = PosedMotion::new(model)?;
        let whole = motion.place(model, &context.layout, [&vec![0.0; model.rank()]], [&Pose::default()])?;
        Ok(Self {
            model: model.clone(),
            context,
            volumes,
            motion,
            whole,
            is_current: false,
            state: SearchState::default(),
            below: Vec::new(),
            hits: DiscreteHits::default(),
        })
    }

    /// Deforms and moves the shape, and returns an AABB of it in the world, at a cost of O(r).
    ///
    /// # Errors
    /// When q has the wrong length or an entry is not finite, the shape leaves the range of numbers, or this thread's
    /// arithmetic is not that of IEEE 754.
    pub fn place(&mut self, q: &[f64], pose: &Pose) -> Result<Aabb, Error> {
        check_arithmetic()?;
        let is_same_pose = with_mutant!(self.motion.pose[0] == *pose, PlacedByCoordinatesAlone, true);
        if self.motion.q[0] == q && is_same_pose {
            return Ok(self.whole);
        }
        self.is_current = false;
        self.whole = self.motion.place(&self.model, &self.volumes.layout, [q], [pose])?;
        Ok(self.whole)
    }

    /// Appends to `found` all pairs (triangle of this shape, triangle of the other) with a point in common, sorted.
    /// Touching counts. `around` is an approximate AABB of all compared shapes. It affects speed only; while it stays the
    /// same, AABBs are computed once after each [`PosedShape::place`].
    ///
    /// # Errors
    /// When this thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]), or there are more than
    /// [`Detector::MAX_PAIRS`](crate::Detector::MAX_PAIRS) pairs. Then nothing is appended.
    pub fn colliding(&mut self, other: &mut Self, around: Aabb, found: &mut Vec<Pair>) -> Result<(), Error> {
        check_arithmetic()?;
        let first = found.len();
        // The error bounds of positions in single precision hold within this AABB.
        let around = finite_or_empty(around).union(&self.whole).union(&other.whole);
        self.enter(around);
        other.enter(around);
        let Self { context, volumes, motion, state, hits, .. } = self;
        let sides = [
            Side { context, volumes, motion },
            Side { context: &other.context, volumes: &mut other.volumes, motion: &other.motion },
        ];
        // The contexts have no token that cancels.
        let _ = Search::between(sides, None, state, hits, Detector::MAX_PAIRS);
        Detector::check_limit(usize::MAX, hits.0.is_complete())?;
        found.extend_from_slice(&hits.0.list);
        found[first..].sort_unstable();
        Ok(())
    }

    /// Returns an upper bound of the length of the displacement `sum_k U_k q_k` of every used vertex, rounding included; NaN if q
    /// is not finite. It costs O(r) for each 64 triangles.
    ///
    /// # Errors
    /// When the length of q is not the number of modes, or this thread's arithmetic is not that of IEEE 754
    /// ([`Error::Arithmetic`]).
    pub fn displacement_bound(&self, q: &[f64]) -> Result<f64, Error> {
        check_arithmetic()?;
        self.model.metric().check_len(q)?;
        let layout = &self.context.layout;
        let bound = layout.bd_tree.displacement_bound(layout.buckets.nodes(), q);
        // Sums of means may cancel: each coordinate errs by a bound that is relative to the sum of the magnitudes of its terms. The
        // root of three is for a vector.
        let rounding = 1.7321 * rounding_bound(self.model.displacement_bound(q), q.len());
        Ok((bound + with_mutant!(rounding, DisplacementsExact, 0.0)) * (1.0 + 1e-9))
    }

    /// Returns the corners of a triangle in the world, bit for bit those to which all answers refer.
    ///
    /// # Panics
    /// When the mesh has no such triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let face = self.model.mesh().faces()[triangle as usize];
        face.map(|v| self.motion.pose[0].apply(self.model.position(v, &self.motion.q[0])))
    }

    /// Starts a search in the frame of this box, unless the last one was the same.
    pub(super) fn enter(&mut self, around: Aabb) {
        if with_mutant!(!self.is_current, PosedVolumesKept, false) || self.motion.around != around {
            self.motion.around = around;
            self.is_current = true;
            self.volumes.begin(&self.context.hierarchy, &self.motion);
            self.volumes.update_node(0, &self.motion);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat3;
    use sscc_testing::Dyadic;

    use super::*;
    use crate::{CertifyOptions, Modes, TriMesh, intersect_triangle_triangle};

    /// Returns the next of fixed pseudo-random numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / 2.0_f64.powi(30) - 1.0
    }

    fn vector(state: &mut u64) -> DVec3 {
        DVec3::new(random(state), random(state), random(state))
    }

    /// Returns a crumpled ball of loose triangles, with modes.
    fn model(triangles: usize, state: &mut u64) -> ReducedModel {
        let positions: Vec<DVec3> = (0..triangles)
            .flat_map(|_| {
                let center = vector(state);
                [(); 3].map(|()| center + vector(state) * 0.1)
            })
            .collect();
        let faces = (0..triangles as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let modes = positions.iter().flat_map(|p| [*p * 0.3, DVec3::new(p.y, -p.z, p.x * p.x)]).collect();
        ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(2, modes).unwrap()).unwrap()
    }

    #[test]
    fn pairs_are_those_of_all_triangles() {
        let state = &mut 7;
        let models = [model(400, state), model(150, state), model(40, state), model(9, state)];
        let certificates = models
            .each_ref()
            .map(|model| Certificates::compute(model, &CertifyOptions::default().budget(0), &()).unwrap());
        let mut shapes: Vec<PosedShape> =
            models.iter().zip(&certificates).map(|(m, c)| PosedShape::new(m, c).unwrap()).collect();
        let (mut found, mut empty) = (0, 0);
        for case in 0..60 {
            // The shapes coincide, overlap or are separate; in some cases they are far from the origin.
            let far = if case % 3 == 0 { DVec3::new(1e6, -3.0, 2e3) } else { DVec3::ZERO };
            for shape in &mut shapes {
                let rotation = DMat3::from_quat(glam::DQuat::from_scaled_axis(vector(state) * 3.0));
                let translation = vector(state) * (0.05 * f64::from(case)) + far;
                let q = [random(state), random(state)];
                let pose = Pose { rotation, translation };
                let Aabb { lower, upper } = shape.place(&q, &pose).unwrap();
                for t in 0..shape.model.mesh().faces().len() as u32 {
                    let corners = shape.corners(t);
                    assert!(corners.iter().all(|x| x.cmpge(lower).all() && x.cmple(upper).all()));
                }
                // About half of the shape is below the plane.
                let normal = vector(state).normalize();
                let height = normal.dot(translation) + random(state);
                let mut below = Vec::new();
                shape.vertices_below(normal, height, &mut below).unwrap();
                let vertices = 0..shape.model.mesh().rest_positions().len() as u32;
                let is_below = |v: &u32| normal.dot(pose.apply(shape.model.position(*v, &q))) < height;
                assert_eq!(below, vertices.filter(is_below).collect::<Vec<u32>>());
            }
            // Any AABB is valid, also one with lower and upper corner exchanged.
            let [a, b] = if case % 2 == 0 { [far - 2.0, far + 2.0] } else { [far + 2.0, far - 2.0] };
            let around = Aabb { lower: a, upper: b };
            for a in 0..shapes.len() {
                for b in 0..a {
                    let (left, right) = shapes.split_at_mut(a);
                    let (x, y) = (&mut left[b], &mut right[0]);
                    let mut pairs = Vec::new();
                    x.colliding(y, around, &mut pairs).unwrap();
                    let mut expected = Vec::new();
                    for i in 0..x.model.mesh().faces().len() as u32 {
                        for j in 0..y.model.mesh().faces().len() as u32 {
                            if intersect_triangle_triangle(&x.corners(i), &y.corners(j)) {
                                expected.push((i, j));
                            }
                        }
                    }
                    assert_eq!(pairs, expected);
                    found += pairs.len();
                    empty += usize::from(pairs.is_empty());
                    // The same query from the other shape, with other AABBs.
                    let mut turned = vec![(0, 0)];
                    y.colliding(x, Aabb { lower: far - 1e3, upper: far + 1.0 }, &mut turned).unwrap();
                    let mut turned: Vec<Pair> = turned.drain(1..).map(|(j, i)| (i, j)).collect();
                    turned.sort_unstable();
                    assert_eq!(turned, expected);
                }
            }
        }
        assert!(found > 200 && empty > 200, "{found} {empty}");
    }

    /// The shape is small in the world and far from its origin, where sums with the translation are rounded.
    #[test]
    fn aabbs_contain_positions_that_the_world_rounds() {
        let state = &mut 5;
        let model = model(30, state);
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let [mut x, mut y] = [(); 2].map(|()| PosedShape::new(&model, &certificates).unwrap());
        let mut found = 0;
        for case in 0..300 {
            let size = 10.0_f64.powi(-(case % 18));
            let mut place = |shape: &mut PosedShape, translation: DVec3| {
                let rotation = DMat3::from_quat(glam::DQuat::from_scaled_axis(vector(state) * 3.0)) * size;
                let q = [random(state), random(state)];
                let Aabb { lower, upper } = shape.place(&q, &Pose { rotation, translation }).unwrap();
                for t in 0..model.mesh().faces().len() as u32 {
                    for x in shape.corners(t) {
                        assert!(
                            x.cmpge(lower).all() && x.cmple(upper).all(),
                            "case {case}: {x} {lower} {upper}"
                        );
                    }
                }
                translation + (shape.corners(3)[0] - shape.corners(9)[1])
            };
            let next = place(&mut x, DVec3::new(1.0, -3.0, 0.7));
            place(&mut y, next);
            let triangles = 0..model.mesh().faces().len() as u32;
            let all = triangles.clone().flat_map(|i| triangles.clone().map(move |j| (i, j)));
            let meet = |(i, j): &Pair| intersect_triangle_triangle(&x.corners(*i), &y.corners(*j));
            let expected: Vec<Pair> = all.filter(meet).collect();
            let mut pairs = Vec::new();
            x.colliding(&mut y, Aabb::default(), &mut pairs).unwrap();
            assert_eq!(pairs, expected, "case {case}");
            found += pairs.len();
        }
        assert!(found > 1000, "{found}");
    }

    #[test]
    fn shapes_without_certificates_give_the_same_answers() {
        let state = &mut 21;
        let models = [model(300, state), model(120, state)];
        let mut alone = models.each_ref().map(|model| PosedShape::without_certificates(model).unwrap());
        let mut shapes = models.each_ref().map(|model| {
            let options = CertifyOptions::default().budget(0);
            PosedShape::new(model, &Certificates::compute(model, &options, &()).unwrap()).unwrap()
        });
        let mut found = 0;
        for _ in 0..60 {
            let pose = Pose { translation: vector(state) * 0.5, ..Pose::default() };
            let q = [random(state), random(state)];
            let answers = [&mut alone, &mut shapes].map(|shapes| {
                let [x, y] = shapes;
                x.place(&q, &pose).unwrap();
                let mut pairs = Vec::new();
                x.colliding(y, Aabb::default(), &mut pairs).unwrap();
                pairs
            });
            assert_eq!(answers[0], answers[1]);
            found += answers[0].len();
        }
        assert!(found > 100, "{found}");
    }

    #[test]
    fn displacements_are_within_their_bound() {
        let state = &mut 9;
        for triangles in [3, 40, 300] {
            let model = model(triangles, state);
            let options = CertifyOptions::default().budget(0);
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            let shape = PosedShape::new(&model, &certificates).unwrap();
            for _ in 0..20 {
                let q = [random(state), random(state)];
                let bound = shape.displacement_bound(&q).unwrap();
                let displacement = |v: u32| {
                    let rest = model.mesh().rest_positions()[v as usize];
                    (model.position(v, &q) - rest).length()
                };
                let most = (0..3 * triangles as u32).map(displacement).fold(0.0, f64::max);
                assert!(most <= bound && bound < 3.0 * most, "{most} {bound}");
            }
            assert!(shape.displacement_bound(&[f64::NAN, 0.0]).unwrap().is_nan());
        }
    }

    /// All vertices move alike, so that nothing but rounding is between the bound and the exact length.
    #[test]
    fn bounds_of_equal_displacements_are_their_lengths_rounded_up() {
        let state = &mut 13;
        for case in 0..50 {
            let ways = [vector(state), vector(state)];
            let modes = [ways; 3].as_flattened().to_vec();
            let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
            let model = ReducedModel::new(mesh, Modes::new(2, modes).unwrap()).unwrap();
            let shape = PosedShape::without_certificates(&model).unwrap();
            let q = [random(state) * 10.0_f64.powi(case % 7 - 3), 1e-3 * random(state)];
            let bound = shape.displacement_bound(&q).unwrap();
            let exact = Dyadic::new;
            let along = |axis: usize| (0..2).map(|k| exact(ways[k][axis]) * exact(q[k])).sum::<Dyadic>();
            let square: Dyadic = (0..3).map(along).map(|x| &x * &x).sum();
            assert!(exact(bound) * exact(bound) >= square, "case {case}: {bound}");
            let length = (ways[0] * q[0] + ways[1] * q[1]).length();
            assert!(bound <= length * (1.0 + 1e-7), "case {case}: {bound} {length}");
        }
    }

    /// `3 fl(1/3)` rounds to 1, but is less by 2^-54: in f64 the two displacements cancel.
    #[test]
    fn displacements_that_cancel_are_within_their_bound() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let modes = (0..3).flat_map(|_| [DVec3::X / 3.0, DVec3::X]).collect();
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(2, modes).unwrap()).unwrap();
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let bound = PosedShape::new(&model, &certificates).unwrap().displacement_bound(&[3.0, -1.0]).unwrap();
        assert!((2.0_f64.powi(-54)..1e-12).contains(&bound), "{bound}");
    }

    #[test]
    fn invalid_poses_are_refused() {
        let model = model(20, &mut 3);
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let mut shape = PosedShape::new(&model, &certificates).unwrap();
        let is_refused = |placed: Result<Aabb, Error>| {
            placed.is_err_and(|error| {
                error.to_string().starts_with("the largest coordinate of the posed shape is ")
            })
        };
        for wrong in [f64::NAN, f64::INFINITY, 1e61] {
            for axis in 0..3 {
                let mut moved = Pose::default();
                moved.translation[axis] = wrong;
                assert!(is_refused(shape.place(&[0.0; 2], &moved)), "{wrong}");
            }
            let turned = Pose { rotation: DMat3::IDENTITY * wrong, ..Pose::default() };
            assert!(is_refused(shape.place(&[0.0; 2], &turned)), "{wrong}");
        }
        assert!(matches!(shape.place(&[0.0], &Pose::default()), Err(Error::CoordinatesLength { .. })));
    }

    /// Loose triangles of a size, which modes move by as much.
    fn sized(size: f64, triangles: u32, state: &mut u64) -> ReducedModel {
        let positions: Vec<DVec3> = (0..3 * triangles).map(|_| vector(state) * size).collect();
        let faces = (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let modes = (0..6 * triangles).map(|_| vector(state) * size).collect();
        ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(2, modes).unwrap()).unwrap()
    }

    /// A corner of a small shape is at a corner of a large shape, whose coarse positions have a far larger error.
    #[test]
    fn each_shape_has_its_own_error() {
        let state = &mut 33;
        let models = [sized(1e-4, 20, state), sized(1.0, 20, state)];
        let [mut x, mut y] = models.each_ref().map(|model| PosedShape::without_certificates(model).unwrap());
        let mut found = 0;
        for case in 0..2000 {
            let q = [(); 2].map(|()| [random(state), random(state)]);
            y.place(&q[1], &Pose::default()).unwrap();
            x.place(&q[0], &Pose::default()).unwrap();
            let translation = y.corners(case % 20)[0] - x.corners(case % 7)[1];
            x.place(&q[0], &Pose { translation, ..Pose::default() }).unwrap();
            let all = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
            let expected: Vec<Pair> =
                all.filter(|(i, j)| intersect_triangle_triangle(&x.corners(*i), &y.corners(*j))).collect();
            let mut pairs = Vec::new();
            match case % 2 {
                0 => x.colliding(&mut y, Aabb::default(), &mut pairs).unwrap(),
                _ => {
                    y.colliding(&mut x, Aabb::default(), &mut pairs).unwrap();
                    pairs.iter_mut().for_each(|(i, j)| (*i, *j) = (*j, *i));
                    pairs.sort_unstable();
                }
            }
            assert_eq!(pairs, expected, "case {case}");
            found += pairs.len();
        }
        assert!(found > 1000, "{found}");
    }

    #[test]
    fn shapes_move_within_one_frame() {
        let state = &mut 5;
        let models = [model(60, state), model(60, state)];
        let [mut x, mut y] = models.each_ref().map(|model| PosedShape::without_certificates(model).unwrap());
        let around = Aabb { lower: DVec3::splat(-100.0), upper: DVec3::splat(100.0) };
        let (mut colliding, mut free) = (0, 0);
        for case in 0..20 {
            let q = [random(state), random(state)];
            let translation = vector(state) * [0.3, 30.0][case % 2];
            x.place(&q, &Pose { translation, ..Pose::default() }).unwrap();
            let all = (0..60).flat_map(|i| (0..60).map(move |j| (i, j)));
            let expected: Vec<Pair> =
                all.filter(|(i, j)| intersect_triangle_triangle(&x.corners(*i), &y.corners(*j))).collect();
            let mut pairs = Vec::new();
            x.colliding(&mut y, around, &mut pairs).unwrap();
            assert_eq!(pairs, expected, "case {case}");
            *(if pairs.is_empty() { &mut free } else { &mut colliding }) += 1;
        }
        assert!(colliding > 5 && free > 5, "{colliding} {free}");
    }

    #[test]
    fn infinite_boxes_change_no_answer() {
        let state = &mut 6;
        let models = [sized(1.0, 20, state), sized(1.0, 20, state)];
        let [mut x, mut y] = models.each_ref().map(|model| PosedShape::without_certificates(model).unwrap());
        let infinite = Aabb { lower: DVec3::NEG_INFINITY, upper: DVec3::INFINITY };
        let nan = Aabb { lower: DVec3::NAN, upper: DVec3::NAN };
        let half = Aabb { lower: DVec3::ZERO, upper: DVec3::new(1.0, f64::INFINITY, 1.0) };
        let mut found = 0;
        for _ in 0..8 {
            x.place(&[random(state), random(state)], &Pose::default()).unwrap();
            let all = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
            let expected: Vec<Pair> =
                all.filter(|(i, j)| intersect_triangle_triangle(&x.corners(*i), &y.corners(*j))).collect();
            for around in [infinite, nan, half] {
                let [mut pairs, mut turned] = [Vec::new(), Vec::new()];
                x.colliding(&mut y, around, &mut pairs).unwrap();
                assert_eq!(pairs, expected, "{around:?}");
                y.colliding(&mut x, around, &mut turned).unwrap();
                turned.iter_mut().for_each(|(i, j)| (*i, *j) = (*j, *i));
                turned.sort_unstable();
                assert_eq!(turned, expected, "{around:?}");
            }
            found += expected.len();
        }
        assert!(found > 100, "{found}");
    }
}
