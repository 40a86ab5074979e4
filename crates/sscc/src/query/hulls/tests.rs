//! Checks that every vertex of every node, at its computed position, is within the radius of the hull, in adverse cases.

use std::f64::consts::PI;

use glam::{DVec3, Vec3, Vec4};

use super::core_points::CORE_POINTS;
use super::separation::{AffineMap, MovedPoints, PlaneTest, Points, widest_gap};
use super::{MovedHulls, NodeHulls};
use crate::certificates::Scope;
use crate::detect::f32_frame::F32Frame;
use crate::detect::layout::{Layout, Needs};
use crate::detect::vertex_motion::{DeformedMotion, VertexMotion};
use crate::filter::PairFilter;
use crate::geometry::nearest_to_origin;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::ScaledModel;
use crate::query::capsule_motion::{CapsuleMotion, CapsuleRates};
use crate::test_models::Random;
use crate::vectors::{Baseline, InstructionSet};
use crate::{ContactFilter, Modes, ReducedModel, TriMesh, intersect_triangle_triangle};

/// A model with its hierarchy, layout and hulls.
struct Case {
    model: ReducedModel,
    hierarchy: Hierarchy,
    layout: Layout,
    hulls: NodeHulls,
}

impl Case {
    fn new(model: ReducedModel, configuration: &[f64]) -> Self {
        let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
        let within = hierarchy.nodes_within_buckets();
        let nodes = (0..within.len() as u32).filter(|n| !within[*n as usize]);
        let all: Vec<NodePair> = nodes.map(|n| (n, n)).collect();
        let hulls = NodeHulls::new(&model, &hierarchy, &all, configuration).unwrap();
        Self { model, hierarchy, layout, hulls }
    }

    /// Checks that all vertices at each q are in the hulls of one motion. Returns the largest quotient of a distance and its
    /// radius, and the smallest radius; `None` if the error bound is too large for hulls.
    fn check<const E: usize>(
        &self,
        motion: &impl VertexMotion<E>,
        ends: [&[f64]; E],
        label: &str,
    ) -> Option<(f64, f64)> {
        let frame = F32Frame::around(motion.overall_aabb(&self.layout));
        let mut moved = MovedHulls::<E>::new(&self.hulls);
        moved.update_all(&self.hulls, &frame, motion);
        if !moved.is_useful() {
            return None;
        }
        let (mut share, mut smallest) = (0.0_f64, f64::INFINITY);
        for (node, index) in self.hulls.all() {
            let points = moved.points(&self.hulls, index);
            let radius = f64::from(moved.hulls[index].radius);
            smallest = smallest.min(radius);
            let of_node = &self.hierarchy.nodes()[node as usize];
            for v in self.hierarchy.vertices(of_node, self.model.mesh().faces()) {
                for (end, q) in ends.iter().enumerate() {
                    let x = frame.linear(self.model.position(v, q));
                    let maps = &[points.maps[end]];
                    let at_end = MovedPoints { points: points.points, maps };
                    let core: [DVec3; CORE_POINTS] = std::array::from_fn(|i| at_end.point(i).as_dvec3() - x);
                    let distance = nearest_to_origin(&core).point.length();
                    assert!(distance <= radius, "{label}, node {node}: {distance} {radius}");
                    share = share.max(distance / radius);
                }
            }
        }
        Some((share, smallest))
    }

    /// Checks that all vertices at q are within the radius of the hulls of both ends of a motion together, along several
    /// directions. False where the error bound is too large for hulls.
    fn check_extents(&self, motion: &impl VertexMotion<2>, q: &[f64]) -> bool {
        let frame = F32Frame::around(motion.overall_aabb(&self.layout));
        let mut moved = MovedHulls::<2>::new(&self.hulls);
        moved.update_all(&self.hulls, &frame, motion);
        for (node, index) in self.hulls.all().filter(|_| moved.is_useful()) {
            let points = moved.points(&self.hulls, index);
            let radius = f64::from(moved.hulls[index].radius);
            let of_node = &self.hierarchy.nodes()[node as usize];
            for v in self.hierarchy.vertices(of_node, self.model.mesh().faces()) {
                let x = frame.linear(self.model.position(v, q));
                for dir in [Vec3::X, Vec3::Y, Vec3::NEG_Z, x.as_vec3().normalize_or(Vec3::NEG_X)] {
                    let along = x.dot(dir.as_dvec3()) / dir.as_dvec3().length();
                    let extent = f64::from(points.extent(Baseline, dir)) / dir.as_dvec3().length();
                    assert!(along <= extent + radius, "node {node}: {along} {extent} {radius}");
                }
            }
        }
        moved.is_useful()
    }

    fn check_at(&self, q: &[f64], label: &str) -> Option<(f64, f64)> {
        let Ok(reach) = self.model.check_coordinates(q) else { return None };
        self.check(&DeformedMotion::new([q], reach), [q], label)
    }
}

/// Returns a rolled sheet of `2 (side - 1)^2` triangles. `place`: the position of each vertex, from its coordinates on the unit
/// sheet and on the rolled one. `modes`: its displacements, from its coordinates on the unit sheet and its position.
fn sheet(
    side: u32,
    size: f64,
    place: impl Fn([f64; 2], DVec3) -> DVec3,
    mut modes: impl FnMut([f64; 2], DVec3) -> Vec<DVec3>,
) -> ReducedModel {
    let (mut positions, mut rows, mut rank) = (Vec::new(), Vec::new(), 0);
    for i in 0..side * side {
        let [u, v] = [i % side, i / side].map(|i| f64::from(i) / f64::from(side - 1));
        let angle = 1.5 * PI * u;
        let x = place([u, v], DVec3::new(angle.cos(), angle.sin(), 2.0 * v) * size);
        let of_vertex = modes([u, v], x);
        rank = of_vertex.len();
        rows.extend(of_vertex);
        positions.push(x);
    }
    let face = |i: u32| {
        let j = i + i / (side - 1);
        [[j, j + 1, j + side], [j + 1, j + side + 1, j + side]]
    };
    let faces = (0..(side - 1) * (side - 1)).flat_map(face).collect();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(rank, rows).unwrap()).unwrap()
}

/// Returns a rolled sheet, a plane curve, a line, or a sheet of which a part is a point, with smooth, affine, rigid, planar and
/// noisy modes of any size.
fn random_sheet(random: &mut Random, case: usize) -> ReducedModel {
    let rank = [1, 2, 3, 7, 20][case % 5];
    let size = [1.0, 1e-60, 1e40, 1e-165][case / 5 % 4];
    let ways: Vec<[DVec3; 4]> = (0..rank).map(|_| std::array::from_fn(|_| random.vector())).collect();
    let mut noise = Random(case as u64 + 1);
    let place = |[u, _]: [f64; 2], x: DVec3| match case / 20 % 4 {
        0 => x,
        1 => DVec3::new(x.x, x.y, 0.0),
        2 => DVec3::new(0.3 * x.x, x.x, -0.2 * x.x),
        _ => {
            if u < 0.6 {
                DVec3::splat(size)
            } else {
                x
            }
        }
    };
    sheet([4, 9, 14][case % 3], size, place, |[u, v], x| {
        let x = x / size;
        let mode = |(k, [a, b, c, d]): (usize, &[DVec3; 4])| {
            let k_f64 = k as f64;
            let shape = match (k + case / 5) % 6 {
                0 => *a * (3.0 * u + k_f64).sin() + *b * v * v,
                1 => *a * x.dot(*b) + *c * x.dot(*d),
                2 => *a,
                3 => a.cross(x),
                4 => DVec3::Z * (u - v) * u,
                _ => *a * (4.0 * v).cos() * u + noise.vector() * 0.3,
            };
            // Modes of very different length.
            shape * size * 10.0_f64.powi((k as i32 * 7) % 9 - 4)
        };
        ways.iter().enumerate().map(mode).collect()
    })
}

#[test]
fn vertices_are_within_the_radius_of_their_hull() {
    let random = &mut Random(5);
    let (mut checked, mut tight) = (0, 0);
    for case in 0..80 {
        let model = random_sheet(random, case);
        let rank = model.rank();
        let sizes: Vec<f64> = (0..rank).map(|k| model.mode_displacement_bound(k, 1.0)).collect();
        let size = model.mesh().rest_positions().iter().map(|x| x.length()).fold(0.0, f64::max);
        // Directions in q, in units of the modes' sizes, along which two random vertices separate fastest along an axis; the
        // largest coordinate is 1.
        let apart: Vec<Vec<f64>> = (0..12)
            .map(|i| {
                let axis = i % 3;
                let mut any = || {
                    let count = model.mesh().rest_positions().len() as f64;
                    (count * 0.999 * random.signed().abs()) as u32
                };
                let [v, w] = [any(), any()].map(|v| model.modes().of_vertex(v));
                let along = |k: usize| (v[k] - w[k])[axis] / sizes[k].max(f64::MIN_POSITIVE);
                let most = (0..rank).map(|k| along(k).abs()).fold(f64::MIN_POSITIVE, f64::max);
                (0..rank).map(|k| along(k) / most).collect()
            })
            .collect();
        // Each mode moves the shape by up to about `most` times its size.
        let mut q = |most: f64| -> Vec<f64> {
            sizes.iter().map(|s| random.signed() * most * size / s.max(f64::MIN_POSITIVE)).collect()
        };
        let configuration = if case % 2 == 0 { vec![0.0; rank] } else { q(0.7) };
        let case_of = Case::new(model, &configuration);
        for i in 0..28 {
            let most = [1e-9, 0.02, 0.3, 2.0][i % 4];
            let mut at = q(most);
            if i >= 16 {
                let factors = apart[i - 16].iter().zip(&sizes);
                let far = factors.map(|(x, s)| x * most * size / s.max(f64::MIN_POSITIVE));
                at = far.collect();
            } else if i % 3 == 0 {
                // Only one mode moves the shape.
                let only = i % rank;
                at.iter_mut().enumerate().filter(|(k, _)| *k != only).for_each(|(_, x)| *x = 0.0);
            }
            at.iter_mut().zip(&configuration).for_each(|(x, c)| *x += c);
            if let Some((share, _)) = case_of.check_at(&at, &format!("case {case}, {i}")) {
                checked += 1;
                tight += usize::from(share > 0.7);
            }
        }
    }
    assert!(checked > 1400 && tight > 400, "{checked} {tight}");
}

/// The model has residuals that no affine map describes and that cancel over the modes, down to the rounding of their factors to
/// single precision.
#[test]
fn radii_cover_sums_that_cancel() {
    let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    // Corners of a square move up and down alternately. There are four modes, so that the vector of the residuals is exact.
    let rows =
        (0..4).flat_map(|v| (0..4).map(move |k| if (v + k) % 2 == 0 { DVec3::Z } else { DVec3::NEG_Z }));
    let mesh = TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(4, rows.collect()).unwrap()).unwrap();
    let case = Case::new(model, &[0.0; 4]);
    let (random, mut farthest) = (&mut Random(21), 0.0_f64);
    for i in 0..200 {
        let q: Vec<f64> = (0..4).map(|_| 1e4 * (1.0 + 1e-7 * random.signed())).collect();
        let (share, _) = case.check_at(&q, &format!("cancelling residuals, {i}")).unwrap();
        farthest = farthest.max(share);
    }
    assert!(farthest > 0.01, "{farthest}");
}

/// All modes move the corners of a square up and down alternately, so far that the shape at rest is negligible beside it: vertices
/// are as far from the hull as the sum of all residuals, and of the error bounds only that of sums is left.
#[test]
fn radii_cover_sums_of_many_modes() {
    let rank = 64;
    let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let rows = (0..4).flat_map(|v| vec![if v % 2 == 0 { DVec3::Z } else { DVec3::NEG_Z }; rank]);
    let mesh = TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(rank, rows.collect()).unwrap()).unwrap();
    let case = Case::new(model, &vec![0.0; rank]);
    let (share, _) = case.check_at(&vec![1e4; rank], "equal residuals").unwrap();
    assert!(share > 0.999, "{share}");
}

/// With as many core points as vertices and affine modes, radii consist of rounding alone. Modes that cancel make it large.
#[test]
fn radii_cover_single_precision() {
    let (mut farthest, mut checked) = (0.0_f64, 0);
    for case in 0..40 {
        let random = &mut Random(case + 1);
        let [a, b, c, d] = std::array::from_fn(|_| random.vector());
        // Two modes that are nearly opposite.
        let model =
            sheet(4, 1.0, |_, x| x, |_, x| vec![a + b * x.dot(c), -a - b * x.dot(c) + d * x.x * 1e-3]);
        let case_of = Case::new(model, &[0.0; 2]);
        for size in [1.0, 30.0, 500.0] {
            let q = size * random.signed();
            if let Some((share, _)) = case_of.check_at(&[q, q], "cancelling modes") {
                (farthest, checked) = (farthest.max(share), checked + 1);
            }
        }
    }
    assert!(checked > 60 && farthest > 0.005, "{checked} {farthest}");
}

/// Far from the origin the computed shape itself is rounded.
#[test]
fn radii_cover_the_rounding_of_the_shape() {
    let mut farthest = 0.0_f64;
    for case in 0..20 {
        let random = &mut Random(case + 1);
        let far = DVec3::splat(1e11 * (1.0 + random.signed().abs()));
        let model = sheet(4, 1.0, |_, x| x, |_, x| vec![DVec3::ONE, x.cross(DVec3::Z)]);
        let positions: Vec<DVec3> = model.mesh().rest_positions().iter().map(|x| *x + far).collect();
        let mesh = TriMesh::new(positions, model.mesh().faces().to_vec()).unwrap();
        let model = ReducedModel::new(mesh, model.modes().clone()).unwrap();
        let case_of = Case::new(model, &[0.0; 2]);
        for _ in 0..10 {
            let q = [random.signed(), random.signed()];
            let (share, _) = case_of.check_at(&q, "far from the origin").unwrap();
            farthest = farthest.max(share);
        }
    }
    assert!(farthest > 0.001, "{farthest}");
}

/// Vertices are in the hulls at both ends of a motion, and anywhere in a capsule.
#[test]
fn motions_and_capsules_are_covered() {
    let (mut balls, mut capsules, mut farthest) = (0, 0, 0.0_f64);
    for case in 0..20 {
        let random = &mut Random(case as u64 + 40);
        let model = random_sheet(random, case);
        let (rank, scope) = (model.rank(), Scope::of(&model));
        let sizes: Vec<f64> = (0..rank).map(|k| model.mode_displacement_bound(k, 1.0)).collect();
        let size = model.mesh().rest_positions()[0].length();
        let scaled = ScaledModel::new(&model, &scope.metric, &scope.center);
        let case_of = Case::new(model, &vec![0.0; rank]);
        let rates = CapsuleRates::new(&scaled, &case_of.hierarchy, &case_of.layout);
        let mut q = || -> Vec<f64> { sizes.iter().map(|s| random.signed() * 0.3 * size / s).collect() };
        let (t0, t1) = (q(), q());
        let ends = [&t0[..], &t1[..]];
        let reach = ends.map(|q| case_of.model.check_coordinates(q).unwrap()).into_iter().fold(0.0, f64::max);
        assert!(case_of.check(&DeformedMotion::new(ends, reach), ends, "two ends").is_some());
        let radius = 0.1 * scope.metric.length(&t0);
        let ball = CapsuleMotion::new(&rates, [&t0, &t0], radius, 2.0 * reach);
        let capsule = CapsuleMotion::new(&rates, ends, radius, 2.0 * reach);
        for v in (0..case_of.model.mesh().rest_positions().len() as u32).step_by(7) {
            let mut rows = vec![DVec3::ZERO; rank];
            scope.metric.scaled_modes(case_of.model.modes().of_vertex(v), &mut rows);
            let axis = v as usize % 3;
            let length = rows.iter().map(|a| a[axis] * a[axis]).sum::<f64>().sqrt();
            let z: Vec<f64> = rows.iter().map(|a| a[axis] / length * radius * 0.999).collect();
            let d = scope.metric.unscale(&z);
            if d.iter().any(|x| !x.is_finite()) {
                continue;
            }
            let there: Vec<f64> = t0.iter().zip(&d).map(|(q, d)| q + d).collect();
            if let Some((share, _)) = case_of.check(&ball, [&there, &there], "in a ball") {
                (balls, farthest) = (balls + 1, farthest.max(share));
            }
            let share = f64::from(v % 11) / 10.0;
            let there: Vec<f64> = (0..rank).map(|k| t0[k] + share * (t1[k] - t0[k]) + d[k]).collect();
            capsules += usize::from(case_of.check_extents(&capsule, &there));
        }
    }
    assert!(balls > 100 && capsules > 100 && farthest > 0.5, "{balls} {capsules} {farthest}");
}

/// Coordinates along a direction are those of the moved points, within their error bound.
#[test]
fn extents_are_those_of_the_moved_points() {
    let random = &mut Random(9);
    let mut number = || random.signed() as f32;
    for _ in 0..500 {
        let points = std::array::from_fn(|_| std::array::from_fn(|_| number()));
        let maps =
            std::array::from_fn(|_| [(); 3].map(|()| Vec4::from_array(std::array::from_fn(|_| number()))));
        let dir = Vec3::from_array(std::array::from_fn(|_| number())).normalize();
        let moved = MovedPoints::<2> { points: &points, maps: &maps };
        let along = |map: &AffineMap, i: usize| {
            let point = DVec3::from_array([0, 1, 2].map(|axis| f64::from(points[axis][i]))).extend(1.0);
            DVec3::from_array(map.map(|row| row.as_dvec4().dot(point))).dot(dir.as_dvec3())
        };
        let of_map = |map: &AffineMap| (0..CORE_POINTS).map(|i| along(map, i)).fold(f64::MIN, f64::max);
        let most = maps.iter().map(of_map).fold(f64::MIN, f64::max);
        // All terms of a coordinate are below 4 together.
        let error = 7.0 * 4.0 * 1.7321 * f64::from(f32::EPSILON) / 2.0;
        assert!((f64::from(moved.extent(Baseline, dir)) - most).abs() <= error);
    }
}

#[test]
fn only_gaps_wider_than_the_radii_separate() {
    let mut points = [[0.0; CORE_POINTS]; 3];
    (0..CORE_POINTS).for_each(|i| (points[0][i], points[1][i]) = (i as f32 * 0.1, (i % 3) as f32));
    let at = |z: f32| [Vec4::X, Vec4::Y, Vec4::new(0.0, 0.0, 1.0, z)];
    let (low, high, higher) = (at(0.0), at(1.0), at(1.5));
    fn test<const E: usize>(
        points: &Points,
        a: [AffineMap; E],
        b: [AffineMap; E],
        distance: f32,
        normal: Vec3,
    ) -> bool {
        let points = [&a, &b].map(|maps| MovedPoints { points, maps });
        let test = || PlaneTest { points: points.each_ref().map(|p| MovedPoints { ..*p }), distance, normal };
        let is_apart = InstructionSet::default().run(test());
        assert_eq!(is_apart, InstructionSet::Baseline.run(test()));
        is_apart
    }
    assert!(test(&points, [low], [high], 0.9, Vec3::Z));
    assert!(!test(&points, [low], [high], 1.0, Vec3::Z));
    assert!(!test(&points, [high], [low], 0.9, Vec3::Z));
    assert!(!test(&points, [low], [high], 0.9, Vec3::X));
    assert!(!test(&points, [low], [high], 0.9, Vec3::ZERO) && !test(&points, [low], [high], 0.9, Vec3::NAN));
    assert!(
        !test(&points, [low], [high], f32::INFINITY, Vec3::Z)
            && !test(&points, [low], [high], f32::NAN, Vec3::Z)
    );
    for length in [2e-3, 0.1, 3e4, 9e8] {
        assert!(test(&points, [low], [high], 0.9, Vec3::Z * length), "{length}");
        assert!(!test(&points, [low], [high], 1.0, Vec3::Z * length), "{length}");
    }
    assert!([5e-4, 2e9].iter().all(|length| !test(&points, [low], [high], 0.9, Vec3::Z * *length)));
    // The plane must separate the points at both configurations.
    assert!(test(&points, [low, low], [high, higher], 0.9, Vec3::Z));
    assert!(!test(&points, [low, high], [high, high], 0.9, Vec3::Z));
    assert!(!test(&points, [low, low], [higher, low], 0.9, Vec3::Z));
}

/// Two flat sheets are one above the other, and their vertices move up and down alternately. No affine map describes that, so
/// each hull is the sheet at rest and a radius. Half of the gap is one radius, and the sheets meet where vertices of both
/// move by half of the gap.
#[test]
fn hulls_are_apart_only_where_their_triangles_are() {
    let (side, gap) = (9_u32, 2.5);
    let (mut positions, mut faces, mut modes) = (Vec::new(), Vec::new(), Vec::new());
    for height in [0.0, gap] {
        let first = positions.len() as u32;
        for i in 0..side * side {
            let (x, y) = (i % side, i / side);
            positions.push(DVec3::new(f64::from(x), f64::from(y), height));
            // Vertices of both sheets that are one above the other move towards or away from each other.
            let is_up = (x + y) % 2 == 0;
            modes.push(if is_up == (height == 0.0) { DVec3::Z } else { DVec3::NEG_Z });
        }
        for i in 0..(side - 1) * (side - 1) {
            let j = first + i + i / (side - 1);
            faces.extend([[j, j + 1, j + side], [j + 1, j + side + 1, j + side]]);
        }
    }
    let is_lower = |v: u32| v < side * side;
    let mesh = TriMesh::new(positions, faces).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
    let Case { model, hierarchy, layout, .. } = Case::new(model, &[0.0]);
    let vertices = |n: u32| hierarchy.vertices(&hierarchy.nodes()[n as usize], model.mesh().faces());
    let nodes = 0..hierarchy.nodes().len() as u32;
    let lower: Vec<u32> = nodes.clone().filter(|n| vertices(*n).into_iter().all(is_lower)).collect();
    let upper: Vec<u32> = nodes.filter(|n| !vertices(*n).into_iter().any(is_lower)).collect();
    let pairs: Vec<NodePair> = lower.iter().flat_map(|n| upper.iter().map(|m| (*n, *m))).collect();
    let hulls = NodeHulls::new(&model, &hierarchy, &pairs, &[0.0]).unwrap();
    let (mut apart, mut met) = (0, 0);
    for share in [0.3, 0.9, 1.0, 1.01, 1.3, 1.8] {
        let q = [share * gap / 2.0];
        let motion = DeformedMotion::new([&q[..]], model.check_coordinates(&q).unwrap());
        let frame = F32Frame::around(motion.overall_aabb(&layout));
        let mut moved = MovedHulls::<1>::new(&hulls);
        moved.begin();
        let corners = |t: &u32| model.mesh().faces()[*t as usize].map(|v| model.position(v, &q));
        for &(n, m) in &pairs {
            let [a, b] = [n, m].map(|n| hierarchy.triangles(&hierarchy.nodes()[n as usize]));
            let meet =
                a.iter().any(|t| b.iter().any(|s| intersect_triangle_triangle(&corners(t), &corners(s))));
            let said = moved.are_apart(&hulls, (n, m), Vec3::Z, &frame, &motion);
            assert!(!(said && meet), "nodes {n} and {m}, {share}");
            apart += usize::from(said && share == 0.9);
            met += usize::from(meet);
        }
    }
    // At 0.9 of the way to contact the radii fill nine tenths of the gap.
    assert!(apart > 20 && met > 100, "{apart} of {}, {met}", pairs.len());
}

/// The distance of the points is exact up to rounding; normals have any length.
#[test]
fn gaps_are_rounded_down() {
    let coordinates = [[0.0; CORE_POINTS]; 3];
    let at = |x: f32| [[Vec4::new(1.0, 0.0, 0.0, x), Vec4::Y, Vec4::Z]];
    let (low, high) = (at(0.0), at(1.0));
    let random = &mut Random(31);
    for case in 0..20_000 {
        let length = 10.0_f64.powi(case % 44 - 28);
        let normal = DVec3::new(1.0 + random.signed(), random.signed(), random.signed()) * length;
        let normal = normal.as_vec3();
        if normal.x <= 0.0 {
            continue;
        }
        let normal_f64 = normal.as_dvec3();
        let distance = ((normal_f64.x / normal_f64.length()) as f32).next_up();
        let points = [&low, &high].map(|maps| MovedPoints::<1> { points: &coordinates, maps });
        assert!(!InstructionSet::Baseline.run(PlaneTest { points, distance, normal }), "{normal} {distance}");
        if (1e-2..1e8).contains(&normal.length()) {
            let points = [&low, &high].map(|maps| MovedPoints::<1> { points: &coordinates, maps });
            let nearer = PlaneTest { points, distance: distance * (1.0 - 1e-5), normal };
            assert!(InstructionSet::Baseline.run(nearer), "{normal} {distance}");
        }
    }
}

/// Returns the distance of the hulls of two sets of points, each moved by its map.
fn distance_of(a: &MovedPoints<'_, 1>, b: &MovedPoints<'_, 1>) -> f64 {
    let between = |i: usize| b.point(i / CORE_POINTS).as_dvec3() - a.point(i % CORE_POINTS).as_dvec3();
    let differences: [DVec3; CORE_POINTS * CORE_POINTS] = std::array::from_fn(between);
    nearest_to_origin(&differences).point.length()
}

/// The gap that a search finds is nearly the distance of the hulls, and it is the gap along the normal. Where hulls
/// intersect there is none.
#[test]
fn searches_find_nearly_the_widest_gap() {
    let random = &mut Random(77);
    let (mut apart, mut met) = (0, 0);
    for case in 0..60 {
        let shift = (random.vector().normalize() * [0.25, 1.0, 2.0, 5.0][case % 4]).as_vec3();
        let mut number = || random.signed() as f32;
        let points: [Points; 2] =
            std::array::from_fn(|_| std::array::from_fn(|_| std::array::from_fn(|_| number())));
        let mut map_to = |shift: Vec3| shift.to_array().map(|x| Vec4::new(number(), number(), number(), x));
        let maps: [[AffineMap; 1]; 2] = [[map_to(-shift)], [map_to(shift)]];
        let [a, b] = [0, 1].map(|i| MovedPoints { points: &points[i], maps: &maps[i] });
        let distance = distance_of(&a, &b);
        let mut found = 0.0;
        if let Some((normal, gap)) = widest_gap(&a, &b) {
            assert!((normal.length() - 1.0).abs() < 1e-5, "case {case}: {normal}");
            assert_eq!(gap, -b.extent(Baseline, -normal) - a.extent(Baseline, normal));
            found = f64::from(gap);
        }
        assert!(found <= distance * (1.0 + 1e-4) + 1e-5, "case {case}: {found} {distance}");
        if distance > 0.05 {
            apart += 1;
            assert!(found > 0.99 * distance, "case {case}: {found} {distance}");
        } else {
            met += 1;
        }
    }
    assert!(apart > 20 && met > 5, "{apart} {met}");
}

/// Returns two sheets of 16 triangles in one plane, at the left and at the right of the origin, and all pairs of a node of
/// the left one and a node of the right one, which have hulls. Modes turn both about the origin, shrink them, and turn
/// them back.
fn two_sheets() -> (Case, Vec<NodePair>) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for side in [-1.0, 1.0] {
        let first = positions.len() as u32;
        for i in 0..15_u32 {
            let (x, y) = (1.0 + 0.5 * f64::from(i % 3), 0.25 * f64::from(i / 3) - 0.5);
            positions.push(DVec3::new(side * x, y, 0.0));
        }
        for i in 0..8 {
            let j = first + i + i / 2;
            faces.extend([[j, j + 1, j + 3], [j + 1, j + 4, j + 3]]);
        }
    }
    let turned = |p: &DVec3| DVec3::new(-p.y, p.x, 0.0);
    let modes = positions.iter().flat_map(|p| [turned(p), -*p, -turned(p)]).collect();
    let mesh = TriMesh::new(positions, faces).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(3, modes).unwrap()).unwrap();
    let Case { model, hierarchy, layout, .. } = Case::new(model, &[0.0; 3]);
    let vertices = |n: &u32| hierarchy.vertices(&hierarchy.nodes()[*n as usize], model.mesh().faces());
    let nodes = 0..hierarchy.nodes().len() as u32;
    let left: Vec<u32> = nodes.clone().filter(|n| vertices(n).iter().all(|v| *v < 15)).collect();
    let right: Vec<u32> = nodes.filter(|n| vertices(n).iter().all(|v| *v >= 15)).collect();
    let pairs: Vec<NodePair> = left.iter().flat_map(|n| right.iter().map(|m| (*n, *m))).collect();
    assert!(!pairs.is_empty());
    let hulls = NodeHulls::new(&model, &hierarchy, &pairs, &[0.0; 3]).unwrap();
    (Case { model, hierarchy, layout, hulls }, pairs)
}

/// Returns the motion to one configuration.
fn motion_to<'q>(model: &ReducedModel, q: &'q [f64]) -> DeformedMotion<'q, 1> {
    DeformedMotion::new([q], model.check_coordinates(q).unwrap())
}

/// A direction that separates two nodes at rest turns with them, and already the first test of a search uses it. A
/// search whose error bound is too large tests no hulls.
#[test]
fn directions_turn_with_the_nodes() {
    let (Case { model, layout, hulls, .. }, pairs) = two_sheets();
    let mut moved = MovedHulls::<1>::new(&hulls);
    // At rest, and turned by 90, 180 and 270 degrees.
    for q in [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 1.0, 1.0]] {
        let motion = motion_to(&model, &q);
        let frame = F32Frame::around(motion.overall_aabb(&layout));
        for pair in &pairs {
            for (dir, is_between) in [(Vec3::X, true), (Vec3::NEG_X, false)] {
                moved.begin();
                let is_apart = moved.are_apart(&hulls, *pair, dir, &frame, &motion);
                assert_eq!((is_apart, moved.is_useful()), (is_between, true), "{q:?}, {pair:?}, {dir}");
            }
        }
    }
    // The sum of large displacements is 0, so the shape is the one at rest.
    let frame = F32Frame::around(motion_to(&model, &[0.0; 3]).overall_aabb(&layout));
    moved.begin();
    let motion = motion_to(&model, &[1e4, 0.0, 1e4]);
    let is_apart = moved.are_apart(&hulls, pairs[0], Vec3::X, &frame, &motion);
    assert_eq!((is_apart, moved.is_useful()), (false, false));
}

/// The direction between two nodes is that of the widest gap. There is none unless the gap is wider than twice the sum of
/// both radii.
#[test]
fn only_wide_gaps_have_a_direction() {
    let (Case { model, layout, hulls, .. }, pairs) = two_sheets();
    let motion = motion_to(&model, &[0.0; 3]);
    let frame = F32Frame::around(motion.overall_aabb(&layout));
    let mut moved = MovedHulls::<1>::new(&hulls);
    moved.update_all(&hulls, &frame, &motion);
    for (n, m) in pairs {
        let indices = [n, m].map(|n| hulls.index_of(n).unwrap());
        let [a, b] = indices.map(|i| moved.points(&hulls, i));
        let distance = distance_of(&a, &b) as f32;
        for (share, has_direction) in [(0.24, true), (0.26, false)] {
            indices.iter().for_each(|i| moved.hulls[*i].radius = share * distance);
            let dir = moved.separating_direction(&hulls, (n, m));
            assert_eq!(dir.is_some(), has_direction, "{n} {m}, {share}");
            let [a, b] = indices.map(|i| moved.points(&hulls, i));
            let gap = dir.map(|dir| -b.extent(Baseline, -dir) - a.extent(Baseline, dir));
            assert!(gap.is_none_or(|gap| gap > 0.99 * distance), "{n} {m}: {gap:?} {distance}");
        }
    }
}
