//! Polynomial modes are orthonormal, complete and reproducible, without rigid motions.

use crate::common::{Random, bumpy, cube, moved, plane, sphere};
use glam::DVec3;
use sscc::parts::vertex_areas;
use sscc::{Error, Modes, TriMesh};
use sscc_modes::{ModesError, polynomial_modes, shapes::spring};

/// `sum_v area_v f(v) . g(v)`
fn dot(areas: &[f64], f: impl Fn(usize) -> DVec3, g: impl Fn(usize) -> DVec3) -> f64 {
    areas.iter().enumerate().map(|(v, area)| area * f(v).dot(g(v))).sum()
}

/// Checks the properties for every surface; returns the number of modes.
fn check(name: &str, mesh: &TriMesh) -> usize {
    let modes = polynomial_modes(mesh).unwrap_or_else(|e| panic!("{name}: {e}"));
    let areas = vertex_areas(mesh);
    let total: f64 = areas.iter().sum();
    let p = mesh.rest_positions();
    let centre = p.iter().zip(&areas).map(|(p, a)| *p * (*a / total)).sum::<DVec3>();
    let mode = |k: usize| {
        let modes = &modes;
        move |v: usize| modes.of_vertex(v as u32)[k]
    };
    for i in 0..modes.rank() {
        for j in 0..=i {
            let wanted = if i == j { 1.0 } else { 0.0 };
            let found = dot(&areas, mode(i), mode(j));
            assert!((found - wanted).abs() < 1e-12, "{name}: modes {i} and {j}: {found}");
        }
        for axis in DVec3::AXES {
            let rotation = |v: usize| axis.cross(p[v] - centre);
            let size = dot(&areas, rotation, rotation).sqrt();
            let rotated = dot(&areas, mode(i), rotation) / size;
            let shifted = dot(&areas, mode(i), |_| axis) / total.sqrt();
            assert!(rotated.abs() < 1e-11 && shifted.abs() < 1e-12, "{name}: {i}: {rotated:e} {shifted:e}");
        }
    }
    check_complete(name, mesh, &modes, centre);
    modes.rank()
}

/// Checks that every quadratic field is a sum of rigid motions and modes.
fn check_complete(name: &str, mesh: &TriMesh, modes: &Modes, centre: DVec3) {
    let areas = vertex_areas(mesh);
    let p: Vec<DVec3> = mesh.rest_positions().iter().map(|p| *p - centre).collect();
    let size = p.iter().fold(0.0, |m: f64, p| m.max(p.length()));
    let mut random = Random(7);
    for _ in 0..4 {
        let c: [DVec3; 10] = std::array::from_fn(|_| random.vector());
        let field: Vec<DVec3> = p
            .iter()
            .map(|p| *p / size)
            .map(|p| [1.0, p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.y * p.z, p.z * p.x, p.x * p.y])
            .map(|m| m.iter().zip(&c).map(|(m, c)| *c * *m).sum())
            .collect();
        let mut rest = field.clone();
        let norm = dot(&areas, |v| field[v], |v| field[v]).sqrt();
        // Many sweeps of projections are needed, because the rigid motions are not orthogonal to each other.
        for _ in 0..200 {
            for k in 0..6 + modes.rank() {
                let basis = |v: usize| match k {
                    0..3 => DVec3::AXES[k],
                    3..6 => DVec3::AXES[k - 3].cross(p[v]),
                    _ => modes.of_vertex(v as u32)[k - 6],
                };
                let along = dot(&areas, |v| rest[v], basis) / dot(&areas, basis, basis).max(1e-300);
                rest.iter_mut().enumerate().for_each(|(v, r)| *r -= basis(v) * along);
            }
        }
        let left = dot(&areas, |v| rest[v], |v| rest[v]).sqrt() / norm;
        assert!(left < 1e-9, "{name}: {left:e} of a quadratic field is missing");
    }
}

#[test]
fn general_surfaces_have_24_modes() {
    for seed in 0..4 {
        assert_eq!(check("bumpy", &bumpy(seed)), 24);
    }
    assert_eq!(polynomial_modes(&spring()).unwrap().rank(), 24);
    let thin = moved(&bumpy(1), |p| p * DVec3::new(1.0, 1.0, 1e-4));
    assert_eq!(check("thin plate", &thin), 24);
    let needle = moved(&bumpy(2), |p| p * DVec3::new(1.0, 1e-3, 1e-3));
    assert_eq!(check("needle", &needle), 24);
}

#[test]
fn special_surfaces_have_fewer_modes() {
    let tilt = |p: DVec3| DVec3::new(0.6 * p.x - 0.3 * p.y, 0.8 * p.y + 0.1 * p.x, 0.7 * p.x + 0.2 * p.y);
    assert_eq!(check("plane", &plane()), 12);
    assert_eq!(check("tilted plane", &moved(&plane(), tilt)), 12);
    let far = moved(&plane(), |p| tilt(p) + DVec3::new(1e6, -2e6, 3e6));
    assert_eq!(polynomial_modes(&far).unwrap().rank(), 12);
    // xx + yy + zz is constant on the sphere, which removes three fields.
    assert_eq!(check("sphere", &sphere()), 21);
    let corners = vec![DVec3::new(0.3, 0.1, 2.0), DVec3::new(1.0, 0.2, 1.0), DVec3::new(-0.4, 1.5, 0.0)];
    assert_eq!(check("triangle", &TriMesh::new(corners, vec![[0, 1, 2]]).unwrap()), 3);
}

#[test]
fn stretch_and_shear_come_first() {
    let mesh = cube(6);
    let modes = polynomial_modes(&mesh).unwrap();
    let p = mesh.rest_positions();
    let linear: [fn(DVec3) -> DVec3; 6] = [
        |p| DVec3::X * p.x,
        |p| DVec3::Y * p.y,
        |p| DVec3::Z * p.z,
        |p| DVec3::new(0.0, p.z, p.y),
        |p| DVec3::new(p.z, 0.0, p.x),
        |p| DVec3::new(p.y, p.x, 0.0),
    ];
    // On a cube the six fields are orthogonal to each other and to rotations, so they are the modes up to scale.
    let at = p.iter().position(|p| *p == DVec3::ONE).unwrap();
    for (k, field) in linear.into_iter().enumerate() {
        let factor = modes.of_vertex(at as u32)[k].length() / field(DVec3::ONE).length();
        for (v, p) in p.iter().enumerate() {
            assert!((modes.of_vertex(v as u32)[k] - field(*p) * factor).length() < 1e-13, "mode {k}");
        }
    }
}

#[test]
fn moving_and_scaling_the_surface_changes_little() {
    let mesh = bumpy(3);
    let modes = polynomial_modes(&mesh).unwrap();
    let compare = |map: &dyn Fn(DVec3) -> DVec3, unit: f64, tolerance: f64| {
        let other = polynomial_modes(&moved(&mesh, map)).unwrap();
        assert_eq!(other.rank(), modes.rank());
        for (a, b) in modes.displacements().iter().zip(other.displacements()) {
            assert!((*a - *b * unit).length() < tolerance, "{a} {b}");
        }
    };
    compare(&|p| p + DVec3::new(1e6, -1e6, 1e6), 1.0, 1e-7);
    compare(&|p| p * 1e40, 1e40, 1e-12);
    compare(&|p| p * 1e-40, 1e-40, 1e-12);
}

#[test]
fn unused_vertices_follow_the_polynomial() {
    let mesh = bumpy(5);
    let modes = polynomial_modes(&mesh).unwrap();
    let mut positions = mesh.rest_positions().to_vec();
    positions.extend([mesh.rest_positions()[3], DVec3::splat(1e9)]);
    let more = polynomial_modes(&TriMesh::new(positions.clone(), mesh.faces().to_vec()).unwrap()).unwrap();
    let used = mesh.rest_positions().len();
    assert_eq!(more.displacements()[..used * 24], *modes.displacements());
    assert_eq!(more.of_vertex(used as u32), modes.of_vertex(3));

    // A vertex so far away that its displacement is out of range gives an error with its number.
    positions[used + 1] = DVec3::splat(1e60);
    let refused = polynomial_modes(&TriMesh::new(positions, mesh.faces().to_vec()).unwrap());
    assert!(matches!(refused, Err(ModesError::Core(Error::ModeEntry { vertex, .. })) if vertex == used + 1));
}

#[test]
fn surfaces_without_area_or_too_far_from_the_origin_are_rejected() {
    let flat = |p: DVec3| DVec3::new(p.x, 0.0, 0.0);
    assert_eq!(polynomial_modes(&moved(&bumpy(1), flat)), Err(ModesError::NoArea));
    assert_eq!(polynomial_modes(&moved(&bumpy(1), |_| DVec3::ONE)), Err(ModesError::NoArea));
    let far = polynomial_modes(&moved(&bumpy(1), |p| p + DVec3::splat(1e15)));
    assert!(matches!(far, Err(ModesError::TooFarFromOrigin { .. })), "{far:?}");
    // A surface with all triangles nearly on one line still has modes without NaN.
    let line = polynomial_modes(&moved(&bumpy(1), |p| DVec3::new(p.x, p.x * 0.7 + 1e-14 * p.y, p.x * 0.1)));
    assert!(line.unwrap().rank() >= 1);
}

#[test]
fn modes_have_the_same_bits_on_every_machine() {
    let mesh = spring();
    let modes = polynomial_modes(&mesh).unwrap();
    assert_eq!(modes, polynomial_modes(&mesh).unwrap());
    let bits = modes.displacements().iter().flat_map(|u| u.to_array()).map(f64::to_bits);
    let hash = bits.fold(0xcbf2_9ce4_8422_2325_u64, |h, x| (h ^ x).wrapping_mul(0x100_0000_01b3));
    assert_eq!(hash, 0xcda6_a1d4_0cba_e0db, "{hash:#018x}");
}
