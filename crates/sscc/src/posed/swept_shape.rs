//! A shape that moves through the world, tested against others: continuous queries between objects.

use std::fmt;

use glam::DVec3;

use super::pose::{Pose, finite_or_empty};
use super::posed_motion::PosedMotion;
use super::posed_shape::PosedShape;
use crate::arithmetic::check_arithmetic;
use crate::detect::context::Context;
use crate::detect::narrow_phase::{NearHits, SweptHits};
use crate::detect::node_volumes::NodeVolumes;
use crate::detect::search::{Search, SearchState, Side};
use crate::geometry::Aabb;
use crate::{Detector, Error, Impact, Pair, ReducedModel};

/// A shape whose vertices move on straight lines between two configurations in the world, to be tested against others. At both
/// ends vertices have the positions of a [`PosedShape`], bit for bit. It owns its memory, so that repeated calls allocate
/// nothing; it shares the data that does not change with the posed shape.
#[derive(Clone)]
pub struct SweptShape {
    model: ReducedModel,
    context: Context,
    volumes: NodeVolumes<2>,
    motion: PosedMotion<2>,
    /// An AABB of the whole motion.
    whole: Aabb,
    /// Whether the volumes are those of this motion.
    is_current: bool,
    state: SearchState,
    hits: SweptHits,
    near: NearHits,
}

/// Shows the AABB of the motion only.
impl fmt::Debug for SweptShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SweptShape").field("whole", &self.whole).finish_non_exhaustive()
    }
}

impl SweptShape {
    /// Creates a shape that rests at q = 0 in its own axes.
    ///
    /// # Errors
    /// When the model is beyond the range of numbers, or this thread's arithmetic is not that of IEEE 754
    /// ([`Error::Arithmetic`]).
    pub fn new(shape: &PosedShape) -> Result<Self, Error> {
        let mut motion = PosedMotion::new(&shape.model)?;
        let rest = vec![0.0; shape.model.rank()];
        let layout = &shape.context.layout;
        // Error bounds hold only within a box that contains this one.
        let at_rest = motion.place(&shape.model, layout, [&rest; 2], [&Pose::default(); 2])?;
        let whole = with_mutant!(at_rest, SweptWholeUnknownAtRest, Aabb::EMPTY);
        Ok(Self {
            model: shape.model.clone(),
            context: shape.context.clone(),
            volumes: NodeVolumes::new(&shape.context.layout, true),
            motion,
            whole,
            is_current: false,
            state: SearchState::default(),
            hits: SweptHits::default(),
            near: NearHits::default(),
        })
    }

    /// Sets both ends of the motion, each a q and a pose. Returns an AABB of the whole motion in the world, at a cost of
    /// O(r).
    ///
    /// # Errors
    /// When a q has the wrong length or an entry is not finite, the shape leaves the range of numbers, or this thread's
    /// arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    pub fn place(&mut self, q: [&[f64]; 2], pose: [&Pose; 2]) -> Result<Aabb, Error> {
        self.is_current = false;
        self.whole = self.motion.place(&self.model, &self.volumes.layout, q, pose)?;
        Ok(self.whole)
    }

    /// Appends to `found` an impact for each pair (triangle of this shape, triangle of the other) that has a point in
    /// common during the motion, sorted by pair, with the guarantee of [`Query::continuous`](crate::Query::continuous).
    /// `around` is an AABB of all compared shapes. It affects speed only; while it stays the same, AABBs are computed
    /// once after each [`SweptShape::place`].
    ///
    /// # Errors
    /// As [`PosedShape::colliding`](crate::parts::PosedShape::colliding).
    pub fn impacts(&mut self, other: &mut Self, around: Aabb, found: &mut Vec<Impact>) -> Result<(), Error> {
        check_arithmetic()?;
        let first = found.len();
        // The error bound of positions in single precision holds within this AABB.
        let around = finite_or_empty(around).union(&self.whole).union(&other.whole);
        self.enter(around, 0.0);
        other.enter(around, 0.0);
        let sides = [
            Side { context: &self.context, volumes: &mut self.volumes, motion: &self.motion },
            Side { context: &other.context, volumes: &mut other.volumes, motion: &other.motion },
        ];
        // The contexts have no token that cancels.
        let _ = Search::between(sides, None, &mut self.state, &mut self.hits, Detector::MAX_PAIRS);
        Detector::check_limit(usize::MAX, self.hits.0.is_complete())?;
        found.extend_from_slice(&self.hits.0.list);
        found[first..].sort_unstable_by_key(|impact| impact.pair);
        Ok(())
    }

    /// Appends to `found` all pairs (triangle of this shape, triangle of the other) that come within the distance
    /// `margin` of each other during the motion, and some others, sorted. If they are more than `limit`, only that many
    /// are appended. `around` is that of [`SweptShape::impacts`].
    ///
    /// # Errors
    /// When the margin is negative or not finite, or this thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    /// Then nothing is appended.
    pub fn near(
        &mut self,
        other: &mut Self,
        around: Aabb,
        margin: f64,
        limit: usize,
        found: &mut Vec<Pair>,
    ) -> Result<(), Error> {
        check_arithmetic()?;
        if !(margin >= 0.0 && margin.is_finite()) {
            let wanted = "finite and at least 0";
            return Err(Error::Option { name: "the margin of near pairs", value: margin, wanted });
        }
        let first = found.len();
        let widened = |Aabb { lower, upper }: Aabb| Aabb { lower: lower - margin, upper: upper + margin };
        let around = finite_or_empty(around).union(&widened(self.whole)).union(&widened(other.whole));
        let each = with_mutant!(margin / 2.0, NearMarginHalved, margin / 4.0);
        self.enter(around, each);
        other.enter(around, each);
        let sides = [
            Side { context: &self.context, volumes: &mut self.volumes, motion: &self.motion },
            Side { context: &other.context, volumes: &mut other.volumes, motion: &other.motion },
        ];
        // The contexts have no token that cancels.
        let _ = Search::between(sides, None, &mut self.state, &mut self.near, limit);
        found.extend_from_slice(&self.near.0.list);
        found[first..].sort_unstable();
        Ok(())
    }

    /// Returns the corners of a triangle in the world at both ends.
    ///
    /// # Panics
    /// When the mesh has no such triangle.
    pub fn corners(&self, triangle: u32) -> [[DVec3; 3]; 2] {
        let face = self.model.mesh().faces()[triangle as usize];
        let PosedMotion { q, pose, .. } = &self.motion;
        std::array::from_fn(|end| face.map(|v| pose[end].apply(self.model.position(v, &q[end]))))
    }

    /// Starts a search in the frame of this box with this margin, unless the last one was the same.
    fn enter(&mut self, around: Aabb, margin: f64) {
        let is_margin_new = with_mutant!(self.motion.margin != margin, NearMarginKept, false);
        let is_motion_new = with_mutant!(!self.is_current, SweptVolumesKept, false);
        if is_motion_new || self.motion.around != around || is_margin_new {
            (self.motion.around, self.motion.margin) = (around, margin);
            self.is_current = true;
            self.volumes.begin(&self.context.hierarchy, &self.motion);
            self.volumes.update_node(0, &self.motion);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat};

    use super::*;
    use crate::{Certificates, CertifyOptions, Modes, MovingTriangle, TriMesh, impact_triangle_triangle};

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
    fn impacts_are_those_of_all_triangles() {
        let state = &mut 11;
        let models = [model(200, state), model(90, state)];
        let options = CertifyOptions::default().budget(0);
        let certificates =
            models.each_ref().map(|model| Certificates::compute(model, &options, &()).unwrap());
        let mut shapes: Vec<SweptShape> = models
            .iter()
            .zip(&certificates)
            .map(|(m, c)| SweptShape::new(&PosedShape::new(m, c).unwrap()).unwrap())
            .collect();
        let (mut found, mut between, mut close) = (0, 0, 0);
        for case in 0..12 {
            let far = if case % 3 == 0 { DVec3::new(1e4, -3.0, 2e3) } else { DVec3::ZERO };
            for shape in &mut shapes {
                let rotation = vector(state) * 3.0;
                let mut end = |turn: f64| {
                    let rotation = DMat3::from_quat(DQuat::from_scaled_axis(rotation * turn));
                    let translation = vector(state) * (0.3 * f64::from(case)) + far;
                    ([random(state), random(state)], Pose { rotation, translation })
                };
                let [(q, t0), (r, t1)] = [end(1.0), end(1.1)];
                let Aabb { lower, upper } = shape.place([&q, &r], [&t0, &t1]).unwrap();
                for t in 0..shape.model.mesh().faces().len() as u32 {
                    let corners = shape.corners(t);
                    assert!(
                        corners.as_flattened().iter().all(|x| x.cmpge(lower).all() && x.cmple(upper).all())
                    );
                }
            }
            let (left, right) = shapes.split_at_mut(1);
            let (x, y) = (&mut left[0], &mut right[0]);
            let mut expected = Vec::new();
            for i in 0..x.model.mesh().faces().len() as u32 {
                for j in 0..y.model.mesh().faces().len() as u32 {
                    let [a, b] = [x.corners(i), y.corners(j)].map(|[t0, t1]| MovingTriangle { t0, t1 });
                    if a.is_swept_aabb_overlapping(&b)
                        && let Some(time) = impact_triangle_triangle(&a, &b, Impact::TOLERANCE)
                    {
                        expected.push(Impact { pair: (i, j), time });
                    }
                }
            }
            // Any AABB is valid, also one that is too small.
            for around in [Aabb::default(), Aabb { lower: far - 9.0, upper: far + 9.0 }] {
                let mut impacts = Vec::new();
                x.impacts(y, around, &mut impacts).unwrap();
                assert_eq!(impacts, expected, "case {case}");
            }
            let margin = 0.1;
            let mut near = Vec::new();
            x.near(y, Aabb::default(), margin, usize::MAX, &mut near).unwrap();
            assert!(near.is_sorted() && expected.iter().all(|impact| near.contains(&impact.pair)));
            let is_within = |(i, j): &(u32, u32)| {
                let [a, b] = [x.corners(*i), y.corners(*j)];
                (0..2).any(|end| a[end].iter().any(|p| b[end].iter().any(|q| p.distance(*q) < margin)))
            };
            let triangles = |shape: &SweptShape| shape.model.mesh().faces().len() as u32;
            let all = (0..triangles(x)).flat_map(|i| (0..triangles(y)).map(move |j| (i, j)));
            let within: Vec<(u32, u32)> = all.filter(is_within).collect();
            assert!(within.iter().all(|pair| near.binary_search(pair).is_ok()), "case {case}");
            close += within.len();
            let mut some = Vec::new();
            x.near(y, Aabb::default(), margin, 3, &mut some).unwrap();
            assert!(some.len() == near.len().min(3) && some.iter().all(|pair| near.contains(pair)));
            found += expected.len();
            between += expected.iter().filter(|impact| impact.time > 0.0).count();
        }
        assert!(found > 200 && between > 100 && close > 100, "{found} {between} {close}");
    }

    /// One triangle above another one, at known heights.
    #[test]
    fn motions_and_margins_change_within_one_frame() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = TriMesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, corners).unwrap()).unwrap();
        let shape = PosedShape::without_certificates(&model).unwrap();
        let [mut x, mut y] = [(); 2].map(|()| SweptShape::new(&shape).unwrap());
        let around = Aabb { lower: DVec3::splat(-20.0), upper: DVec3::splat(20.0) };
        let at = |height: f64| Pose { translation: DVec3::Z * height, ..Pose::default() };
        x.place([&[0.0]; 2], [&at(0.0); 2]).unwrap();
        for (heights, margin, meets, is_near) in [
            ([1.0, 1.0], 0.5, false, false),
            ([1.0, 1.0], 1.05, false, true),
            ([1.0, 1.0], 0.9, false, false),
            ([9.0, 9.0], 0.9, false, false),
            ([9.0, 1.0], 1.05, false, true),
            ([9.0, -1.0], 0.1, true, true),
            ([9.0, 8.0], 0.1, false, false),
        ] {
            let [t0, t1] = heights.map(at);
            y.place([&[0.0]; 2], [&t0, &t1]).unwrap();
            let (mut impacts, mut near) = (Vec::new(), Vec::new());
            x.impacts(&mut y, around, &mut impacts).unwrap();
            x.near(&mut y, around, margin, 9, &mut near).unwrap();
            assert_eq!(
                (impacts.len(), near.len()),
                (usize::from(meets), usize::from(is_near)),
                "{heights:?}"
            );
            let mut again = Vec::new();
            x.near(&mut y, around, 30.0, 9, &mut again).unwrap();
            assert_eq!(again, [(0, 0)]);
            for wrong in [f64::NAN, f64::INFINITY, -1.0] {
                assert!(matches!(x.near(&mut y, around, wrong, 9, &mut again), Err(Error::Option { .. })));
                assert_eq!(again, [(0, 0)]);
            }
        }
        for (heights, meets) in [([9.0, 9.0], false), ([9.0, -1.0], true), ([9.0, 8.0], false)] {
            let [t0, t1] = heights.map(at);
            y.place([&[0.0]; 2], [&t0, &t1]).unwrap();
            let mut impacts = Vec::new();
            x.impacts(&mut y, around, &mut impacts).unwrap();
            assert_eq!(impacts.len(), usize::from(meets), "{heights:?}");
        }
    }

    /// The second shape and the frame change, but not the first shape, whose volumes must follow the frame.
    #[test]
    fn shapes_at_rest_follow_the_frame_of_others() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = TriMesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, corners).unwrap()).unwrap();
        let shape = PosedShape::without_certificates(&model).unwrap();
        let at =
            |shift: f64, height: f64| Pose { translation: DVec3::new(shift, 0.0, height), ..Pose::default() };
        for is_near in [false, true] {
            let [mut x, mut y] = [(); 2].map(|()| SweptShape::new(&shape).unwrap());
            x.place([&[0.0]; 2], [&at(0.0, 0.0); 2]).unwrap();
            for shift in [1000.0, 0.0, -50.0, 0.0, 7.0, 0.0] {
                y.place([&[0.0]; 2], [&at(shift, 9.0), &at(shift, -1.0)]).unwrap();
                let (mut impacts, mut near) = (Vec::new(), Vec::new());
                if is_near {
                    x.near(&mut y, Aabb::EMPTY, 0.1, 9, &mut near).unwrap();
                } else {
                    x.impacts(&mut y, Aabb::EMPTY, &mut impacts).unwrap();
                }
                assert_eq!(impacts.len() + near.len(), usize::from(shift == 0.0), "{shift} {is_near}");
            }
        }
    }

    /// Error bounds hold within the box of the frame, which must contain both motions and their margins.
    #[test]
    fn frames_of_near_pairs_contain_the_margin() {
        let state = &mut 14;
        let models = [model(5, state), model(4, state)];
        let [mut x, mut y] = models
            .each_ref()
            .map(|model| SweptShape::new(&PosedShape::without_certificates(model).unwrap()).unwrap());
        for case in 0..40 {
            let mut wholes = Aabb::EMPTY;
            for shape in [&mut x, &mut y] {
                let ends = [(); 2].map(|()| {
                    let rotation = DMat3::from_quat(DQuat::from_scaled_axis(vector(state)));
                    let translation = vector(state) * 3.0 + DVec3::new(20.0, -30.0, 5.0);
                    ([random(state), random(state)], Pose { rotation, translation })
                });
                let q = ends.each_ref().map(|(q, _)| &q[..]);
                wholes = wholes.union(&shape.place(q, ends.each_ref().map(|(_, pose)| pose)).unwrap());
                for (t, face) in shape.model.mesh().faces().iter().enumerate() {
                    let corners = shape.corners(t as u32);
                    for (end, (q, pose)) in ends.iter().enumerate() {
                        assert_eq!(corners[end], face.map(|v| pose.apply(shape.model.position(v, q))));
                    }
                }
            }
            let margin = [0.0, 1e-3, 0.5, 40.0][case % 4];
            let mut near = Vec::new();
            x.near(&mut y, Aabb::EMPTY, margin, usize::MAX, &mut near).unwrap();
            let widened = Aabb { lower: wholes.lower - margin, upper: wholes.upper + margin };
            for motion in [&x.motion, &y.motion] {
                assert_eq!((motion.around, motion.margin), (widened, margin / 2.0), "case {case}");
            }
            if margin == 40.0 {
                assert_eq!(near.len(), 20);
            }
        }
    }

    /// The shapes are far from the box that is given, and touch each other at corners.
    #[test]
    fn shapes_that_were_never_placed_rest() {
        let state = &mut 12;
        let mut found = 0;
        for _ in 0..40 {
            let middle = DVec3::splat(1000.0);
            let corners: Vec<DVec3> = (0..90).map(|_| middle + vector(state) * 0.1).collect();
            let faces: Vec<[u32; 3]> = (0..30).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            // Each triangle of the second shape has one corner on the first shape.
            let touching: Vec<DVec3> = (0..90)
                .map(|i| if i % 3 == 0 { corners[i + 1] } else { middle + vector(state) * 0.1 })
                .collect();
            let shapes = [&corners, &touching].map(|positions| {
                let mesh = TriMesh::new(positions.clone(), faces.clone()).unwrap();
                let modes = Modes::new(1, vec![DVec3::X; 90]).unwrap();
                PosedShape::without_certificates(&ReducedModel::new(mesh, modes).unwrap()).unwrap()
            });
            let [mut x, mut y] = shapes.each_ref().map(|shape| SweptShape::new(shape).unwrap());
            let mut impacts = Vec::new();
            let around = Aabb { lower: DVec3::ZERO, upper: DVec3::ONE };
            x.impacts(&mut y, around, &mut impacts).unwrap();
            let all = (0..30).flat_map(|i| (0..30).map(move |j| (i, j)));
            let meet = |(i, j): &Pair| {
                crate::intersect_triangle_triangle(&shapes[0].corners(*i), &shapes[1].corners(*j))
            };
            let expected: Vec<Pair> = all.filter(meet).collect();
            assert_eq!(impacts.iter().map(|impact| impact.pair).collect::<Vec<_>>(), expected);
            found += expected.len();
        }
        assert!(found > 1200, "{found}");
    }
}
