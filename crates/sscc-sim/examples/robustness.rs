//! Runs scenes of random stiffness, damping, steps, orientation, speed and shape, and reports for each whether it ran to its
//! end, and its largest energy over the first one.
//!
//! Two bodies fall beside two others, which move towards them. Scenes that `sscc simulate` refuses, because half a period of
//! the first mode is shorter than a step, are drawn again. The models are those of scenes; with `SSCC_MODELS` they are the
//! real ones.
//!
//! ```sh
//! cargo run --release -p sscc-sim --example robustness -- 40 1
//! ```
//!
//! The arguments are the number of scenes and the seed. The exit code is 1 if a scene did not run to its end.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used, clippy::print_stdout)]

#[path = "../../sscc-dynamics/tests/it/common/random_scene.rs"]
mod random_scene;

use std::path::Path;
use std::process::ExitCode;

use glam::{DQuat, DVec3};
use random_scene::{Random, RandomScene};
use sscc_dynamics::{Damping, Shape, Start, World};
use sscc_sim::{PreparedModel, PreparedScene, Scene};
use sscc_solid::{Elasticity, ReducedForces, Stiffness};
use sscc_tasks::{Cache, models_folder};

/// Simulated time of each scene (s).
const DURATION: f64 = 0.6;

/// Young's modulus of the models of all scenes (Pa).
const YOUNGS: f64 = 1e6;

/// Models of all scenes.
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

/// A random scene of one model.
struct Trial<'m> {
    model: &'m PreparedModel,
    name: &'m str,
    speed: f64,
    scene: RandomScene,
}

impl<'m> Trial<'m> {
    fn draw(random: &mut Random, models: &'m [PreparedModel], names: &'m [String]) -> Self {
        loop {
            let n = (random.unit() * models.len() as f64) as usize;
            let scene = RandomScene::draw(random);
            let trial = Self { model: &models[n], name: &names[n], speed: 6.0 * random.unit(), scene };
            if trial.scene.resolves(&trial.elasticity()) {
                return trial;
            }
        }
    }

    fn elasticity(&self) -> Elasticity {
        stiffened(&self.model.certified.elasticity, self.scene.youngs / YOUNGS)
    }

    fn shape(&self) -> Shape {
        let certified = &self.model.certified;
        let (model, certificates) = (certified.model.clone(), certified.full.certificates.clone());
        Shape::new(model, certificates, self.elasticity(), certified.mass.properties).unwrap()
    }

    /// Runs the scene. Returns its largest energy over the first one, the number of steps and of shortened bodies, and the
    /// error if it did not run to its end.
    fn run(&self, random: &mut Random) -> (f64, usize, usize, Option<String>) {
        let shape = self.shape();
        let RandomScene { damping, options, .. } = self.scene;
        let mut world = World::new(options).unwrap();
        let radius = shape.radius();
        for n in 0..4 {
            let (column, row) = (f64::from(n / 2), f64::from(n % 2));
            let place = DVec3::new(2.1 * column, 1.1 + (2.1 + random.unit()) * row, 0.2 * column);
            let towards = DVec3::X * (0.5 - column) * self.speed;
            let start = Start {
                position: Some(place * radius),
                orientation: DQuat::from_scaled_axis(random.vector() * std::f64::consts::PI),
                velocity: towards + random.vector() * self.speed * 0.5 - DVec3::Y * self.speed,
                spin: random.vector() * 10.0,
                damping,
                ..Start::default()
            };
            world.add(&shape, &start).unwrap();
        }
        world.check_start().unwrap();
        let first = world.energy();
        let (mut largest, mut shortened) = (first, 0);
        let steps = (DURATION / options.step).round() as usize;
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
        let Trial { name, speed, scene: RandomScene { youngs, damping, options }, .. } = &trial;
        let (Damping { mass, stiffness }, rate) = (damping, 1.0 / options.step);
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
