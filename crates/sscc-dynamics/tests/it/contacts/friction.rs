//! Friction, also at points that fewer than three modes move, or that modes in one plane move.

use glam::{DMat3, DVec3};
use sscc::{Certificates, CertifyOptions, Metric, Modes, ReducedModel, TriMesh};
use sscc_dynamics::{Ground, Shape, Start, World, WorldOptions};
use sscc_solid::{Elasticity, MassProperties, Material, Stiffness};

use crate::common::{block, rigid};

/// Returns a shape of two parallel plates in one mesh; modes move the upper plate as a whole.
fn plates(normal: DVec3, modes: &[DVec3], gap: f64) -> Shape {
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (height, size, aside) in [(0.0, 1.0, 0.0), (gap, 0.7, 0.03)] {
        let first = positions.len() as u32;
        let place = |i: i32| size * (f64::from(i) / 4.0 - 0.5) + aside;
        positions.extend((0..25).map(|i| x * place(i / 5) + y * place(i % 5) + normal * height));
        faces.extend((0..16).flat_map(|i| {
            let a = first + i / 4 * 5 + i % 4;
            [[a, a + 1, a + 6], [a, a + 6, a + 5]]
        }));
    }
    let rank = modes.len();
    let rows = (0..50 * rank).map(|i| if i < 25 * rank { DVec3::ZERO } else { modes[i % rank] });
    let modes_of_all = Modes::new(rank, rows.collect()).unwrap();
    let mesh = TriMesh::new(positions, faces).unwrap();
    let model = ReducedModel::with_metric(mesh, modes_of_all, Metric::identity(rank)).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let inertia = DMat3::from_diagonal(DVec3::new(0.1, 0.2, 0.25));
    let mass = MassProperties { mass: 1.0, center: DVec3::ZERO, inertia };
    let stiffness = Stiffness::from_diagonal(&[4.0, 9.0, 16.0][..rank]).unwrap();
    let shape = Shape::new(model, certificates, Elasticity::Linear(stiffness), mass).unwrap();
    shape.with_moments(modes.iter().map(|u| *u * 0.5).collect()).unwrap()
}

/// No impulse stops such points from sliding perpendicular to their modes, where rounding makes them slide.
#[test]
fn points_that_few_modes_move_have_friction() {
    let lists = [
        vec![DVec3::Z * 2.5],
        vec![DVec3::Z, DVec3::X],
        vec![DVec3::new(0.2, 0.0, 1.0), DVec3::new(1.0, 0.0, -0.3), DVec3::new(0.5, 0.0, 0.8)],
        vec![DVec3::Z, DVec3::X, DVec3::Y],
    ];
    let tilted = [DVec3::new(0.0, 3.0, 4.0) / 5.0, DVec3::new(1.0, 2.0, 2.0) / 3.0];
    let cases = lists
        .into_iter()
        .map(|modes| (DVec3::Z, modes))
        .chain(tilted.into_iter().map(|normal| (normal, vec![normal * 2.5])));
    for (case, (normal, modes)) in cases.enumerate() {
        let shape = plates(normal, &modes, 0.1);
        // Contacts within the body alone, and contacts with the ground.
        let below = Ground { normal, height: -1.0, ..Ground::default() };
        for ground in [None, Some(Ground { height: 0.05, ..below })] {
            for is_free in [false, true] {
                let options = WorldOptions { gravity: normal * -9.81, ground, ..WorldOptions::default() };
                let mut world = World::new(options).unwrap();
                let v = [-0.5, 0.3, 0.2][..modes.len()].to_vec();
                let position = ground.filter(|_| is_free).map(|_| normal * 0.3);
                world.add(&shape, &Start { is_free, v, position, ..Start::default() }).unwrap();
                let mut contacts = 0;
                for _ in 0..800 {
                    world.advance(&mut ()).unwrap();
                    contacts += world.impulses().len();
                }
                assert!(contacts > 0, "case {case}, free: {is_free}, {ground:?}");
                assert!(world.bodies()[0].q().iter().all(|q| q.is_finite()));
            }
        }
    }
}

#[test]
fn the_sliding_distance_follows_from_friction() {
    let shape = rigid(block([1, 1, 1], 0.4, Material::default()).boundary().unwrap().mesh, 3.0);
    let (speed, friction) = (2.0, 0.4);
    let ground = Some(Ground { friction, ..Ground::default() });
    for (step, velocity) in [(1e-3, DVec3::X), (1e-4, DVec3::new(0.6, 0.0, -0.8)), (4e-3, DVec3::Z)] {
        let mut world = World::new(WorldOptions { step, ground, ..WorldOptions::default() }).unwrap();
        let from = DVec3::new(0.0, 0.2 + world.options().contact.skin.unwrap_or(3e-4), 0.0);
        world
            .add(&shape, &Start { position: Some(from), velocity: velocity * speed, ..Start::default() })
            .unwrap();
        for _ in 0..(1.5 / step) as usize {
            world.advance(&mut ()).unwrap();
        }
        let rigid = world.bodies()[0].rigid();
        let distance = (rigid.position - from).dot(velocity);
        let expected = speed * speed / (2.0 * friction * 9.81);
        assert!((distance / expected - 1.0).abs() < 0.02, "step {step}: {distance}, not {expected}");
        assert!(rigid.momentum.length() < 0.05 * step / 1e-3 && rigid.position.y > 0.2, "{rigid:?}");
    }
}
