//! Rolling friction.

use glam::DVec3;
use sscc_dynamics::{Ground, Start, World, WorldOptions};

use crate::common::rigid_block;

#[test]
fn rolling_friction_stops_a_spin_on_smooth_ground() {
    let (shape, spin) = (rigid_block([2, 1, 2], 0.2, 3.0), 1.0);
    let ground = Some(Ground { friction: 0.0, ..Ground::default() });
    let mut world = World::new(WorldOptions { ground, ..WorldOptions::default() }).unwrap();
    let position = Some(DVec3::Y * 0.1003);
    world.add(&shape, &Start { position, spin: DVec3::Y * spin, ..Start::default() }).unwrap();
    let first = world.energy();
    // The torque is 0.05 times the weight times the radius.
    let slowing = 0.05 * shape.radius() * 3.0 * 9.81 / shape.mass().inertia.y_axis.y;
    let half = (0.5 * spin / slowing / 1e-3) as usize;
    for step in 0..3 * half {
        world.advance(&mut ()).unwrap();
        assert!(world.energy() + world.dissipated() <= first * (1.0 + 1e-9));
        if step + 1 == half {
            let share = world.bodies()[0].rigid().angular_velocity().y / spin;
            assert!((share - 0.5).abs() < 0.05, "{share}");
        }
    }
    assert!(world.bodies()[0].rigid().angular_velocity().length() < 1e-3 * spin);
}
