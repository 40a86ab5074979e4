//! Runs a scene of falling bodies for a time and checks it at each key frame: intersections between and within bodies,
//! energy, sleep.
//!
//! ```sh
//! cargo run --release -p sscc-sim --example rest -- bunny16 60
//! ```
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used, clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;
use sscc::Query;
use sscc::parts::{Aabb, PosedShape};
use sscc_dynamics::{Phase, Start, World};
use sscc_sim::{PreparedScene, read_scene};
use sscc_tasks::{Cache, models_folder};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let scene = read_scene(&PathBuf::from(&arguments[0])).unwrap();
    let seconds: f64 = arguments[1].parse().unwrap();
    let models = models_folder(None).unwrap();
    let cache = Cache::open(None).unwrap();
    let prepared = PreparedScene::get(&scene, models.as_deref(), &cache, &()).unwrap();
    let mut world = World::new(scene.options()).unwrap();
    for body in &scene.bodies {
        let model = &prepared.models[body.model];
        let start = Start {
            position: Some(body.place(DVec3::ZERO)),
            orientation: body.orientation * model.upright,
            velocity: body.velocity,
            spin: body.angular_velocity,
            v: body.shake.rates(model.shape.reach()).unwrap(),
            damping: scene.models[body.model].damping,
            detection: scene.detection,
            ..Start::default()
        };
        world.add(&model.shape, &start).unwrap();
    }
    world.check_start().unwrap();
    let mut queries: Vec<Query> = Vec::new();
    let mut posed: Vec<PosedShape> = Vec::new();
    for body in world.bodies() {
        let shape = body.shape();
        queries.push(Query::new(shape.model(), shape.certificates()).unwrap());
        posed.push(PosedShape::new(shape.model(), shape.certificates()).unwrap());
    }
    let first = world.energy();
    let steps = (seconds / scene.step).round() as u64;
    let frame = ((1.0 / scene.frames_per_second) / scene.step).round() as u64;
    let each = (1.0 / scene.step).round() as u64;
    let (mut worst, mut late) = ([0; 2], [0; 2]);
    let mut largest = first;
    let mut parts = [0.0; 5];
    let mut time = Instant::now();
    println!(
        "time energy/first between within awake contacts ground held ms/step self,inter,ground,penalty,dynamics"
    );
    let (mut contacts, mut ground, mut held) = (0, 0, 0);
    for step in 0..=steps {
        if step % frame == 0 {
            let checked = Instant::now();
            let boxes: Vec<Aabb> = posed
                .iter_mut()
                .zip(world.bodies())
                .map(|(shape, body)| shape.place(body.q(), &body.pose()).unwrap())
                .collect();
            let around = boxes.iter().copied().reduce(|a, b| a.union(&b)).unwrap();
            let mut pairs = Vec::new();
            for b in 0..posed.len() {
                for a in 0..b {
                    if !boxes[a].is_disjoint(&boxes[b]) {
                        let (left, right) = posed.split_at_mut(b);
                        left[a].colliding(&mut right[0], around, &mut pairs).unwrap();
                    }
                }
            }
            let of = |(query, body): (&mut Query, &sscc_dynamics::Body)| query.count(body.q()).unwrap();
            let within: usize = queries.iter_mut().zip(world.bodies()).map(of).sum();
            let found = [pairs.len(), within];
            for n in 0..2 {
                worst[n] = worst[n].max(found[n]);
                if step as f64 * scene.step >= 10.0 {
                    late[n] = late[n].max(found[n]);
                }
            }
            largest = largest.max(world.energy());
            time += checked.elapsed();
            if step % each < frame {
                let awake = world.bodies().iter().filter(|body| !body.is_asleep()).count();
                let ms = 1e3 * time.elapsed().as_secs_f64() / each as f64;
                let parts: Vec<String> =
                    parts.iter().map(|x: &f64| format!("{:.2}", 1e3 * x / each as f64)).collect();
                println!(
                    "{:6.2} {:.6} {} {} {awake} {contacts} {ground} {held} {ms:.2} {}",
                    step as f64 * scene.step,
                    world.energy() / first,
                    found[0],
                    found[1],
                    parts.join(",")
                );
                time = Instant::now();
            }
            if step % each < frame {
                parts.fill(0.0);
                held = 0;
            }
        }
        let mut last: Option<(Phase, Instant)> = None;
        let counts = world.advance(&mut |phase: Phase| {
            let now = Instant::now();
            if let Some((phase, since)) = last {
                parts[phase as usize] += (now - since).as_secs_f64();
            }
            last = Some((phase, now));
        });
        let counts = counts.unwrap();
        (contacts, ground) = (counts.contacts, counts.ground);
        held += world.shortened_bodies();
    }
    println!("largest energy / first {:.9}; most pairs {worst:?}, from 10 s on {late:?}", largest / first);
}
