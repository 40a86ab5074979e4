//! Tests of the approximate normal cones (`normal_cones_approx`) against exact methods.

use std::f64::consts::TAU;

use glam::DVec3;
use sscc::{Certificates, CertifyOptions, Method, Modes, Query, ReducedModel, TriMesh};
use sscc_modes::shapes::spring_of;

use crate::random::Random;

/// Returns a grid of squares; `at` maps (u, v) in the unit square to positions.
fn sheet((m, n): (u32, u32), at: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let place = |i: u32, j: u32| at(f64::from(i) / f64::from(m), f64::from(j) / f64::from(n));
    let positions = (0..=m).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| place(i, j)).collect();
    let square = |i: u32, j: u32| {
        let a = i * (n + 1) + j;
        [[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]
    };
    let faces = (0..m).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect();
    TriMesh::new(positions, faces).unwrap()
}

fn certify(model: &ReducedModel) -> Certificates {
    let options = CertifyOptions::default().budget(0).local_budget(0);
    Certificates::compute(model, &options, &()).unwrap()
}

/// Returns a spring that bends in random waves.
fn spring(random: &mut Random) -> ReducedModel {
    let mesh = spring_of(60, 8);
    let waves: Vec<[DVec3; 2]> = (0..4)
        .map(|_| [0, 1].map(|_| DVec3::new(random.normal(), random.normal(), random.normal())))
        .collect();
    let p = mesh.rest_positions();
    let size = p.iter().fold(0.0_f64, |m, x| m.max(x.length()));
    let bend = |x: &DVec3| {
        waves.iter().map(|[dir, wave]| *dir * (3.0 * x.dot(*wave) / size).sin()).collect::<Vec<_>>()
    };
    let modes = Modes::new(waves.len(), p.iter().flat_map(bend).collect()).unwrap();
    ReducedModel::new(mesh, modes).unwrap()
}

#[test]
fn approximate_cones_list_only_colliding_pairs_and_miss_few() {
    let random = &mut Random(5);
    let (mut listed, mut missed) = (0, 0);
    for _ in 0..2 {
        let model = spring(random);
        let certificates = certify(&model);
        let mut cones = Query::with_approximate_cones(&model, &certificates).unwrap();
        let mut exact = Query::with_method(&model, &certificates, Method::Traditional).unwrap();
        for size in [0.0, 0.05, 0.2, 0.5] {
            let size = size * model.mesh().rest_positions()[0].length();
            let q: Vec<f64> = (0..model.rank()).map(|_| random.normal() * size).collect();
            let expected = exact.discrete(&q).unwrap();
            let pairs = cones.discrete(&q).unwrap();
            assert!(pairs.is_sorted() && pairs.iter().all(|pair| expected.binary_search(pair).is_ok()));
            listed += pairs.len();
            missed += expected.len() - pairs.len();
        }
    }
    assert!(listed > 500 && missed < listed / 4, "{listed} {missed}");
}

/// All normals of a spiral ramp point up, also where one winding passes through the other.
#[test]
fn approximate_cones_miss_a_ramp_that_passes_through_itself() {
    let mesh = sheet((60, 3), |u, v| {
        let (sin, cos) = (2.0 * TAU * u).sin_cos();
        DVec3::new(cos * (1.0 + v), sin * (1.0 + v), u)
    });
    // A bump on the first winding.
    let bump = |at: usize| {
        let u = (at / 4) as f64 / 60.0;
        if u < 0.5 { DVec3::Z * (TAU * u).sin().powi(2) } else { DVec3::ZERO }
    };
    let modes = Modes::new(1, (0..mesh.rest_positions().len()).map(bump).collect()).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let certificates = certify(&model);
    let mut cones = Query::with_approximate_cones(&model, &certificates).unwrap();
    let mut exact = Query::with_method(&model, &certificates, Method::NormalCones).unwrap();
    assert!(exact.discrete(&[0.7]).unwrap().len() > 10);
    assert_eq!(cones.discrete(&[0.7]).unwrap(), []);
    // Continuous queries are exact with every method.
    let expected = exact.continuous(&[0.0], &[0.7]).unwrap();
    assert!(expected.len() > 10);
    assert_eq!(cones.continuous(&[0.0], &[0.7]).unwrap(), expected);
}

/// Two sheets face each other, and one of them is pushed through the other while it tilts by less than 45 degrees: no
/// direction is on the positive side of the normals of both.
#[test]
fn sheets_with_opposite_normals_are_not_culled() {
    let lower = sheet((20, 20), |u, v| DVec3::new(u, v, 0.0));
    let count = lower.rest_positions().len();
    let positions =
        lower.rest_positions().iter().copied().chain(lower.rest_positions().iter().map(|p| *p + DVec3::Z));
    let turned = lower.faces().iter().map(|[a, b, c]| [a, c, b].map(|v| v + count as u32));
    let faces = lower.faces().iter().copied().chain(turned).collect();
    let mesh = TriMesh::new(positions.collect(), faces).unwrap();
    let lift = |v: usize| {
        let up = 0.6 + 0.5 * mesh.rest_positions()[v].x;
        if v < count { DVec3::Z * up } else { DVec3::ZERO }
    };
    let modes = Modes::new(1, (0..2 * count).map(lift).collect()).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let certificates = certify(&model);
    let mut cones = Query::with_approximate_cones(&model, &certificates).unwrap();
    let mut exact = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    for q in [0.0, 0.9, 1.3, 1.6] {
        let expected = exact.discrete(&[q]).unwrap();
        assert_eq!(cones.discrete(&[q]).unwrap(), expected);
        assert_eq!(expected.is_empty(), q < 1.0);
    }
    assert!(cones.discrete(&[f64::NAN]).is_err() && cones.discrete(&[]).is_err());
}
