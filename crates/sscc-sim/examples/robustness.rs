//! Runs scenes of random stiffness, damping, steps, orientation, speed and shape, and reports for each whether it ran to its
//! end, and its largest energy over the first one.
//!
//! Two bodies fall beside two others, which come towards them. Scenes that `sscc simulate` refuses, because half a period of
//! the first mode is shorter than a step, are drawn again. The models are those of scenes: with `SSCC_MODELS` the real ones.
//!
//! ```sh
//! cargo run --release -p sscc-sim --example robustness -- 40 1
//! ```
//!
//! The arguments are the number of scenes and the seed. The exit code is 1 if a scene did not run to its end.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::Path;
use std::process::ExitCode;

use glam::{DQuat, DVec3};
use sscc_dynamics::{ContactOptions, Damping, Ground, Shape, Start, World, WorldOptions};
use sscc_modes::natural_frequencies;
use sscc_sim::{Cache, PreparedModel, PreparedScene, Scene, models_folder};
use sscc_solid::{Elasticity, ReducedForces, Stiffness};

/// Simulated time of each scene (s).
const DURATION: f64 = 0.6;

/// Models of all scenes, at this stiffness (Pa).
const YOUNGS: f64 = 1e6;
const MODELS: &str = r#"
steps_per_second = 1000
duration = 1
[models.bunny]
shape = "bunny"
size = 0.2
kind = "nonlinear"
rank = 30
material = { youngs = 1e6, poisson = 0.4, density = 1000 }
[models.spring]
shape = "spring-4k"
size = 0.2
kind = "nonlinear"
rank = 16
material = { youngs = 1e6, poisson = 0.3, density = 1200 }
[models.linear]
shape = "bunny"
size = 0.1
kind = "linear"
rank = 20
material = { youngs = 1e6, poisson = 0.4, density = 1000 }
[[bodies]]
model = "bunny"
[[bodies]]
model = "spring"
[[bodies]]
model = "linear"
"#;

/// Numbers that are the same on every machine (SplitMix64).
struct Random(u64);

impl Random {
    /// Returns a number from 0 to 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a number whose logarithm is uniform.
    fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    /// Returns a vector in the unit ball.
    fn vector(&mut self) -> DVec3 {
        loop {
            let x = DVec3::from_array([(); 3].map(|()| self.between(-1.0, 1.0)));
            if x.length() <= 1.0 {
                return x;
            }
        }
    }
}

/// A random scene.
struct Trial<'m> {
    model: &'m PreparedModel,
    name: &'m str,
    youngs: f64,
    damping: Damping,
    speed: f64,
    options: WorldOptions,
}

impl<'m> Trial<'m> {
    fn draw(random: &mut Random, models: &'m [PreparedModel], names: &'m [String]) -> Self {
        loop {
            let n = (random.unit() * models.len() as f64) as usize;
            let (youngs, steps) = (random.log(1e4, 1e9), random.log(500.0, 4000.0));
            let frequency = random.log(10.0, 200.0).min(steps / 4.0);
            let contact = ContactOptions {
                frequency,
                damping: random.between(0.0, 1.0),
                friction: random.unit(),
                ..ContactOptions::default()
            };
            let mut some = |low, high| if random.unit() < 0.25 { 0.0 } else { random.log(low, high) };
            let damping = Damping { mass: some(1e-2, 3.0), stiffness: some(1e-6, 1e-3) };
            let ground = Some(Ground { normal: DVec3::Z, friction: random.unit(), ..Ground::default() });
            let gravity = DVec3::NEG_Z * 9.81;
            let options =
                WorldOptions { step: 1.0 / steps, gravity, contact, ground, ..WorldOptions::default() };
            let model = &models[n];
            let trial =
                Self { model, name: &names[n], youngs, damping, speed: random.between(0.0, 6.0), options };
            let lowest = natural_frequencies(trial.shape().elasticity().stiffness()).unwrap()[0];
            if 2.0 * trial.options.step * lowest < 1.0 {
                return trial;
            }
        }
    }

    fn shape(&self) -> Shape {
        let certified = &self.model.certified;
        let elasticity = stiffened(&certified.elasticity, self.youngs / YOUNGS);
        let (model, certificates) = (certified.model.clone(), certified.full.certificates.clone());
        Shape::new(model, certificates, elasticity, certified.mass.properties).unwrap()
    }

    /// Runs the scene. Returns its largest energy over the first one, the number of steps and of shortened bodies, and the
    /// error if it did not run to its end.
    fn run(&self, random: &mut Random) -> (f64, usize, usize, Option<String>) {
        let shape = self.shape();
        let mut world = World::new(self.options).unwrap();
        let radius = shape.radius();
        for n in 0..4 {
            let (column, row) = (f64::from(n / 2), f64::from(n % 2));
            let place = DVec3::new(2.1 * column, 0.2 * column, 1.1 + (2.1 + random.unit()) * row);
            let towards = DVec3::X * (0.5 - column) * self.speed;
            let start = Start {
                position: Some(place * radius),
                orientation: DQuat::from_scaled_axis(random.vector() * std::f64::consts::PI),
                velocity: towards + random.vector() * self.speed * 0.5 - DVec3::Z * self.speed,
                spin: random.vector() * 10.0,
                damping: self.damping,
                ..Start::default()
            };
            world.add(&shape, &start).unwrap();
        }
        world.check_start().unwrap();
        let first = world.energy();
        let (mut largest, mut shortened) = (first, 0);
        let steps = (DURATION / self.options.step).round() as usize;
        for step in 0..steps {
            if let Err(error) = world.advance(&mut ()) {
                return (largest / first, step, shortened, Some(error.to_string()));
            }
            largest = largest.max(world.energy());
            shortened += world.shortened_bodies();
        }
        (largest / first, steps, shortened, None)
    }
}

/// Returns the forces of a material of the same density that is stiffer by a factor.
fn stiffened(elasticity: &Elasticity, factor: f64) -> Elasticity {
    let times = |x: &[f64]| -> Vec<f64> { x.iter().map(|x| x * factor).collect() };
    let stiffness = Stiffness::new(elasticity.rank(), times(elasticity.stiffness().entries())).unwrap();
    match elasticity {
        Elasticity::Linear(_) => Elasticity::Linear(stiffness),
        Elasticity::Nonlinear(forces) => Elasticity::Nonlinear(
            ReducedForces::new(stiffness, times(forces.quadratic()), times(forces.cubic())).unwrap(),
        ),
    }
}

fn main() -> ExitCode {
    let arguments: Vec<u64> = std::env::args().skip(1).map(|text| text.parse().unwrap()).collect();
    let count = arguments.first().copied().unwrap_or(40);
    let seed = arguments.get(1).copied().unwrap_or(1);
    let scene = Scene::parse(Path::new("models.toml"), MODELS).unwrap();
    let cache = Cache::open(None).unwrap();
    let prepared = PreparedScene::get(&scene, models_folder(None).unwrap().as_deref(), &cache, &()).unwrap();
    let names: Vec<String> = scene.models.iter().map(|model| model.recipe.name.clone()).collect();
    let (mut failed, mut worst) = (0, 0.0_f64);
    println!("scene model youngs damping steps/s speed | steps shortened largest/first");
    for n in 0..count {
        let mut random = Random(seed.wrapping_mul(1_000_003).wrapping_add(n));
        let trial = Trial::draw(&mut random, &prepared.models, &names);
        let (largest, steps, shortened, error) = trial.run(&mut random);
        let Trial { name, youngs, damping: Damping { mass, stiffness }, speed, options, .. } = &trial;
        let rate = 1.0 / options.step;
        println!(
            "{n} {name} {youngs:.1e} {mass:.1e},{stiffness:.1e} {rate:.0} {speed:.1} | {steps} {shortened} \
             {largest:.6} {}",
            error.as_deref().unwrap_or("ran to its end")
        );
        worst = worst.max(largest);
        failed += u64::from(error.is_some());
    }
    println!(
        "{} of {count} scenes ran to their end; largest energy over the first {worst:.6}",
        count - failed
    );
    ExitCode::from(u8::from(failed > 0))
}
