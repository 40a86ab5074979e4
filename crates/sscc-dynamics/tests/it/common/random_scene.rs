//! Random numbers and scenes of the test `step::energy`, and of its long form, the example `robustness` of `sscc-sim`.
#![allow(
    dead_code,
    missing_docs,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::unwrap_used
)]

use glam::DVec3;
use sscc_dynamics::{ContactOptions, Damping, Ground, WorldOptions};
use sscc_modes::natural_frequencies;
use sscc_solid::Elasticity;

/// Generator of the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    /// Returns a number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        sscc::parts::next_uniform(&mut self.0)
    }

    /// Returns a number whose logarithm is uniform.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.unit())
    }

    /// Returns a vector in the unit ball.
    pub fn vector(&mut self) -> DVec3 {
        loop {
            let x = DVec3::from_array([(); 3].map(|()| 2.0 * self.unit() - 1.0));
            if x.length() <= 1.0 {
                return x;
            }
        }
    }
}

/// Random options of a scene, apart from its shapes and how they start.
pub struct RandomScene {
    /// Young's modulus (Pa).
    pub youngs: f64,
    pub damping: Damping,
    pub options: WorldOptions,
}

impl RandomScene {
    pub fn draw(random: &mut Random) -> Self {
        let (youngs, steps) = (random.log(1e4, 1e9), random.log(500.0, 4000.0));
        let contact = ContactOptions {
            frequency: random.log(10.0, 200.0).min(steps / 4.0),
            damping: random.unit(),
            friction: random.unit(),
            ..ContactOptions::default()
        };
        let mut some = |low, high| if random.unit() < 0.25 { 0.0 } else { random.log(low, high) };
        let damping = Damping { mass: some(1e-2, 3.0), stiffness: some(1e-6, 1e-3) };
        let ground = Some(Ground { friction: random.unit(), ..Ground::default() });
        let options = WorldOptions { step: 1.0 / steps, contact, ground, ..WorldOptions::default() };
        Self { youngs, damping, options }
    }

    /// Whether a step is shorter than half a period of the first mode; `sscc simulate` refuses longer ones.
    pub fn resolves(&self, elasticity: &Elasticity) -> bool {
        2.0 * self.options.step * natural_frequencies(elasticity.stiffness()).unwrap()[0] < 1.0
    }
}
