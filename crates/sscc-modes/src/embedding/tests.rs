//! Surfaces embedded in tetrahedra and in cubes.

use glam::DVec3;
use sscc_solid::Material;

use super::element_tree::corners;
use super::*;

/// A grid of cubes with sides of about 1, slightly distorted, as cubes or as five tetrahedra each.
fn grid(size: [u32; 3], as_tets: bool, distortion: f64) -> Solid {
    let [nx, ny, nz] = size.map(|n| n + 1);
    let at = |i: u32, j: u32, k: u32| i + nx * (j + ny * k);
    let vertex = |n: u32| {
        let p = DVec3::new(f64::from(n % nx), f64::from(n / nx % ny), f64::from(n / (nx * ny)));
        p + distortion * DVec3::new((7.0 * p.y + p.z).sin(), (5.0 * p.z + p.x).sin(), (3.0 * p.x + p.y).sin())
    };
    let vertices = (0..nx * ny * nz).map(vertex).collect();
    let (mut tets, mut cubes) = (Vec::new(), Vec::new());
    for (i, j, k) in
        (0..size[0]).flat_map(|i| (0..size[1]).flat_map(move |j| (0..size[2]).map(move |k| (i, j, k))))
    {
        let c = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .map(|[x, y, z]| at(i + x, j + y, k + z));
        if !as_tets {
            cubes.push(c);
        } else if (i + j + k) % 2 == 0 {
            tets.extend(
                [[0, 1, 2, 5], [0, 2, 3, 7], [0, 5, 7, 4], [2, 7, 5, 6], [0, 2, 7, 5]]
                    .map(|t| t.map(|v| c[v])),
            );
        } else {
            tets.extend(
                [[1, 2, 3, 6], [1, 3, 0, 4], [1, 6, 4, 5], [3, 4, 6, 7], [1, 3, 4, 6]]
                    .map(|t| t.map(|v| c[v])),
            );
        }
    }
    Solid::uniform(vertices, tets, cubes, Material::default()).unwrap()
}

/// Triangles with corners at these points; the last vertex belongs to no triangle.
fn surface(points: impl Iterator<Item = DVec3>) -> TriMesh {
    let mut points: Vec<DVec3> = points.collect();
    let faces = (0..points.len() as u32 - 2).map(|n| [n, n + 1, n + 2]).collect();
    points.push(DVec3::splat(100.0));
    TriMesh::new(points, faces).unwrap()
}

/// Returns pseudo-random points in the box from `low` to `high`.
fn points(low: f64, high: DVec3) -> impl Iterator<Item = DVec3> {
    let mut state = 5_u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..300).map(move |_| DVec3::from_array([next(), next(), next()]) * (high - low) + low)
}

#[test]
fn linear_fields_are_reproduced_inside_and_outside() {
    let linear = |p: &DVec3| DVec3::new(1.0 + p.x - 2.0 * p.z, 0.5 * p.y, p.x - p.y + p.z);
    for (as_tets, low, distortion) in
        [(true, 0.1, 0.04), (false, 0.1, 0.04), (true, -0.15, 0.04), (false, -0.15, 0.0)]
    {
        let solid = grid([3, 2, 2], as_tets, distortion);
        let surface = surface(points(low, DVec3::new(3.0, 2.0, 2.0) - low));
        let (interpolation, outside) = embed(&solid, &surface, &()).unwrap();
        let field = interpolation.apply(&solid.vertices().iter().map(linear).collect::<Vec<_>>());
        for v in surface.used_vertices() {
            let p = surface.rest_positions()[v as usize];
            assert!((field[v as usize] - linear(&p)).length() < 1e-9, "{as_tets} {low}: {p}");
        }
        assert_eq!(field.last(), Some(&DVec3::ZERO), "a vertex without faces does not move");
        assert_eq!((outside.count > 0, outside.of), (low < 0.0, 300));
        let inside = interpolation.vertices.iter().flatten().all(|(_, weight)| *weight >= -1e-12);
        assert_eq!(inside, low > 0.0, "{as_tets} {low}");
    }
}

#[test]
fn the_nearest_element_is_that_of_all() {
    for as_tets in [true, false] {
        let solid = grid([3, 3, 1], as_tets, if as_tets { 0.05 } else { 0.0 });
        let tree = ElementTree::new(&solid);
        for p in points(-1.0, DVec3::new(4.0, 4.0, 2.0)) {
            let of = |element: usize| match solid.tets().get(element) {
                Some(tet) => simplex::nearest_point_tetrahedron(p, corners(&solid, tet)).distance(p),
                None => cube::near_point(p, &corners(&solid, &solid.cubes()[element])).distance(p),
            };
            let all = (0..solid.element_count()).map(of).fold(f64::INFINITY, f64::min);
            assert!((tree.candidates(p, 0.0).distance - all).abs() < 1e-12);
            if !as_tets {
                let in_box = p.clamp(DVec3::ZERO, DVec3::new(3.0, 3.0, 1.0)).distance(p);
                assert!((all - in_box).abs() < 1e-9, "{all} {in_box}");
            }
        }
    }
}

/// The nearest point of a tetrahedron, compared with the nearest of many points in it.
#[test]
fn nearest_points_of_tetrahedra() {
    let corners =
        [DVec3::ZERO, DVec3::new(1.0, 0.1, 0.0), DVec3::new(0.3, 1.2, 0.1), DVec3::new(0.2, 0.3, 0.9)];
    let steps = 20;
    let mut inside = Vec::new();
    for (i, j, k) in (0..=steps)
        .flat_map(|i| (0..=steps - i).flat_map(move |j| (0..=steps - i - j).map(move |k| (i, j, k))))
    {
        let w = [i, j, k, steps - i - j - k].map(|w| f64::from(w) / f64::from(steps));
        inside.push(corners.iter().zip(w).map(|(p, w)| *p * w).sum::<DVec3>());
    }
    for p in points(-1.0, DVec3::splat(2.0)) {
        let near = simplex::nearest_point_tetrahedron(p, corners);
        assert!(simplex::barycentric(near, corners).iter().all(|w| *w >= -1e-12), "{near} is outside");
        let sampled = inside.iter().map(|x| x.distance(p)).fold(f64::INFINITY, f64::min);
        assert!(near.distance(p) <= sampled + 1e-12 && sampled - near.distance(p) < 0.06);
    }
}

#[test]
fn a_surface_far_outside_is_refused() {
    let solid = grid([4, 1, 1], true, 0.0);
    let at = |x: f64| {
        surface([[x, 0.5, 0.5], [1.0, 0.2, 0.2], [1.0, 0.7, 0.2]].map(DVec3::from_array).into_iter())
    };
    let (_, near) = embed(&solid, &at(4.39), &()).unwrap();
    assert_eq!((near.count, near.of, near.vertex, near.size), (1, 3, 0, 4.0));
    assert!((near.distance - 0.39).abs() < 1e-12 && near.element >= 15);
    let shown = near.to_string();
    assert!(
        shown.starts_with(
            "1 of 3 vertices of the surface are outside the solid; the farthest, vertex 0, is 3.900e-1"
        ),
        "{shown}"
    );
    let Err(ModesError::OutsideSolid(far)) = embed(&solid, &at(4.41), &()) else { panic!("not refused") };
    assert!((far.distance - 0.41).abs() < 1e-12);
    let message = ModesError::OutsideSolid(far).to_string();
    assert!(message.contains("a tenth of its size") && !message.contains('\n'), "{message}");
}

/// Two bars that cross, joined nowhere: a vertex in both moves with the bar of its neighbours.
#[test]
fn parts_that_overlap_stay_separate() {
    let [first, second] = [grid([8, 1, 1], true, 0.0), grid([8, 1, 1], true, 0.0)];
    let turned = second.vertices().iter().map(|p| DVec3::new(4.3 - p.y, p.x - 3.4, p.z));
    let vertices: Vec<DVec3> = first.vertices().iter().copied().chain(turned).collect();
    let count = first.vertices().len() as u32;
    let tets =
        first.tets().iter().copied().chain(second.tets().iter().map(|t| t.map(|v| v + count))).collect();
    let both = Solid::uniform(vertices, tets, vec![], Material::default()).unwrap();
    let surface = both.boundary().unwrap().mesh;
    let (interpolation, outside) = embed(&both, &surface, &()).unwrap();
    assert_eq!(outside.count, 0);
    for (v, weights) in interpolation.vertices.iter().enumerate() {
        let is_second = |vertex: u32| vertex >= count;
        let own = surface.rest_positions()[v];
        let moved_by: Vec<u32> =
            weights.iter().filter(|(_, w)| w.abs() > 1e-12).map(|(vertex, _)| *vertex).collect();
        assert!(
            moved_by.iter().all(|vertex| is_second(*vertex) == is_second(v as u32)),
            "{v} at {own}: {moved_by:?}"
        );
    }
}

/// Each of 30 vertices lies in all 20 elements.
#[test]
fn elements_that_overlap_too_much_are_refused() {
    let corners = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]].map(DVec3::from_array);
    let vertices = (0..20).flat_map(|_| corners).collect();
    let tets = (0..20).map(|n| [4 * n, 4 * n + 1, 4 * n + 2, 4 * n + 3]).collect();
    let solid = Solid::uniform(vertices, tets, vec![], Material::default()).unwrap();
    let tree = ElementTree::new(&solid);
    let points: Vec<DVec3> = points(0.5, DVec3::ONE).take(30).collect();
    let found = find_candidates(&tree, &points, 600, &()).unwrap();
    assert!(found.len() == 30 && found.iter().all(|one| one.elements.len() == 20));
    let error = find_candidates(&tree, &points, 599, &()).unwrap_err();
    assert_eq!(error, ModesError::OverlappingElements { max: 599 });
    assert!(!error.to_string().contains('\n'), "{error}");
    let token = sscc::CancelToken::new();
    token.cancel();
    let cancelled = find_candidates(&tree, &points, 600, &token).unwrap_err();
    assert_eq!(cancelled, ModesError::Core(sscc::Error::Cancelled));
}
