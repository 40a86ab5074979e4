//! Queries self-collisions in every step of a simulation loop, until the first contact.
//!
//! The shape is the embedded spring, and each of its modes is a damped oscillator. A force of growing amplitude shakes
//! all of them at the frequency of one mode, until coils of the spring touch.
//!
//! `cargo run --release -p sscc-examples --example simulation_loop`
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use sscc::{CancelToken, Certificates, CertifyOptions, Query, ReducedModel};
use sscc_examples::exit_code;
use sscc_modes::{polynomial_modes, shapes};

/// Length of a step (seconds).
const STEP: f64 = 1.0 / 240.0;

/// Fraction of the critical damping.
const DAMPING: f64 = 0.01;

/// The polynomial mode that moves along z by the square of z: it squeezes one end and stretches the other.
/// (The linear modes alone flatten a shape before it can touch itself.)
const SQUEEZE: usize = 14;

fn main() -> ExitCode {
    exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let mesh = shapes::spring();
    let modes = polynomial_modes(&mesh)?;
    let model = ReducedModel::new(mesh, modes)?;
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    println!("{} triangles, {} modes, certified", model.mesh().faces().len(), model.rank());

    // The deadline cancels long searches. An answer by the root's radius takes nanoseconds, and does not check it.
    let deadline = Instant::now() + Duration::from_secs(300);
    let token = CancelToken::when(move || Instant::now() >= deadline);
    let mut query = Query::new(&model, &certificates)?.cancelled_by(token);
    let mut oscillators = Oscillators::new(model.metric().scales());
    // Numbers and query times of the steps that the root's certificate answers, and of the other steps.
    let (mut steps, mut spent) = ([0_u32; 2], [Duration::ZERO; 2]);
    let touching = loop {
        oscillators.advance();
        let start = Instant::now();
        let pairs = match query.discrete(&oscillators.q) {
            Err(sscc::Error::Cancelled) => return Err("no contact before the deadline".into()),
            pairs => pairs?.to_vec(),
        };
        let kind = usize::from(!query.statistics().root_certified);
        spent[kind] += start.elapsed();
        steps[kind] += 1;
        if !pairs.is_empty() {
            break pairs;
        }
    };

    let total = steps[0] + steps[1];
    println!("first contact in step {total}, after {:.3} s", f64::from(total) * STEP);
    println!("{} pairs of triangles, the first {:?}", touching.len(), touching[0]);
    // The fraction of this deformation that is proven free. A simulator can set the shape back to it.
    println!("{:.4} of this deformation is proven free", query.safe_scale(&oscillators.q)?);
    let microseconds = |kind: usize| 1e6 * spent[kind].as_secs_f64() / f64::from(steps[kind].max(1));
    println!("{} of {total} steps answered by one comparison, {:.2} us each", steps[0], microseconds(0));
    println!("the other {} took {:.0} us each", steps[1], microseconds(1));
    Ok(())
}

/// Damped oscillators, one for each mode: `q'' = force - w^2 q - 2 DAMPING w q'`.
struct Oscillators {
    time: f64,
    q: Vec<f64>,
    velocities: Vec<f64>,
    /// The displacement of the shape by a unit of each mode (metres).
    scales: Vec<f64>,
}

impl Oscillators {
    fn new(scales: Vec<f64>) -> Self {
        Self { time: 0.0, q: vec![0.0; scales.len()], velocities: vec![0.0; scales.len()], scales }
    }

    /// Returns the angular frequency of a mode (per second).
    fn frequency(k: usize) -> f64 {
        TAU * (1.0 + 0.2 * k as f64)
    }

    /// Advances by one step of symplectic Euler: velocities first, then positions by the new velocities.
    fn advance(&mut self) {
        let shaking = 4.0 * self.time * libm::sin(Self::frequency(SQUEEZE) * self.time); // m/s^2
        for (k, scale) in self.scales.iter().enumerate() {
            let w = Self::frequency(k);
            let damping = 2.0 * DAMPING * w * self.velocities[k];
            self.velocities[k] += STEP * (shaking / scale - w * w * self.q[k] - damping);
            self.q[k] += STEP * self.velocities[k];
        }
        self.time += STEP;
    }
}
