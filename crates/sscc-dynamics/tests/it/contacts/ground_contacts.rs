//! Contacts with the ground.

use glam::{DQuat, DVec3};
use sscc_dynamics::{Ground, Start, World, WorldOptions};

use crate::common::worlds::shapes;

#[test]
fn ground_contacts_equal_brute_force() {
    let shapes = shapes();
    for normal in [DVec3::Y, DVec3::new(0.6, 0.8, 0.0)] {
        let ground = Some(Ground { normal, height: -0.1, friction: 0.1 });
        let mut world = World::new(WorldOptions { ground, ..WorldOptions::default() }).unwrap();
        for (n, shape) in shapes.iter().enumerate() {
            let start = Start {
                position: Some(normal * 0.6 + DVec3::Z * n as f64),
                orientation: DQuat::from_rotation_x(0.4 + n as f64),
                spin: DVec3::new(2.0, 1.0, 3.0),
                v: vec![0.3; 6],
                ..Start::default()
            };
            world.add(shape, &start).unwrap();
        }
        let skin = world.skin();
        let (mut touching, mut above) = (0, 0);
        for step in 0..2000 {
            let mut expected = 0;
            for body in world.bodies() {
                let positions: Vec<DVec3> = body.shape().model().positions(body.q()).unwrap();
                let gap = |x: DVec3| normal.dot(body.pose().apply(x)) + 0.1;
                expected += positions.into_iter().filter(|x| gap(*x) < skin).count();
            }
            let found = world.advance(&mut ()).unwrap().ground;
            assert_eq!(found, expected, "step {step}");
            touching += usize::from(found > 0);
            above += usize::from(found == 0);
        }
        assert!(touching > 100 && above > 100, "{touching} {above}");
    }
}
